// Histogram, times, sweeps: plots by Chart.js.
"use strict";

function style(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

function plotOptions(xTitle, yTitle, { xType = "category", yType = "linear", legend = false } = {}) {
  const axis = (title, type) => ({
    type,
    title: { display: title !== "", text: title, color: style("--soft") },
    ticks: { color: style("--soft"), maxRotation: 0, autoSkipPadding: 12 },
    grid: { color: style("--line") },
  });
  return {
    responsive: true, maintainAspectRatio: false, animation: false,
    interaction: { mode: "nearest", intersect: false },
    plugins: { legend: { display: legend, labels: { color: style("--ink"), boxWidth: 12 } } },
    scales: { x: axis(xTitle, xType), y: axis(yTitle, yType) },
  };
}

const modeColors = { rgb: "#c8553d", rgb3: "#d9a441", spectral: "#3f7cac" };

function drawHistogram() {
  const histogram = report.histogram;
  const options = plotOptions("ΔE2000 against spectral", "share of the pixels, %",
    { yType: "logarithmic", legend: true });
  new Chart(byId("histogram"), {
    type: "bar",
    data: {
      labels: histogram.edges.map((edge, i) => (
        i + 1 === histogram.edges.length ? `≥ ${edge}` : `${edge}–${histogram.edges[i + 1]}`)),
      datasets: Object.entries(histogram.modes).map(([mode, shares]) => ({
        label: mode, data: shares.map((s) => (s > 0 ? 100 * s : null)), backgroundColor: modeColors[mode] })),
    },
    options,
  });
}

function drawTimes() {
  const modes = Object.keys(report.modes);
  const options = plotOptions("seconds", "", { xType: "linear", yType: "category" });
  options.indexAxis = "y";
  options.scales.x.beginAtZero = true;
  options.scales.y.ticks.autoSkip = false;
  new Chart(byId("times"), {
    type: "bar",
    data: { labels: modes, datasets: [{ data: modes.map((m) => report.modes[m].seconds),
      backgroundColor: modes.map((m) => modeColors[m]) }] },
    options,
  });
}

function drawSweep(sweep) {
  const canvas = element("canvas", { "data-sweep": sweep.parameter });
  const table = element("table", {}, element("thead", {}, element("tr", {},
    ...[sweep.parameter, "ΔE2000 mean", "95 %", "max", "RMSE", "seconds"].map((t) => element("th", {}, t)))));
  const body = element("tbody");
  for (const run of sweep.runs) {
    body.append(row(String(run.value), digits(run.delta_e2000.mean, 3), digits(run.delta_e2000.p95, 3),
      digits(run.delta_e2000.max, 2), run.rmse.toExponential(2), digits(run.seconds, 1)));
  }
  table.append(body);
  const note = element("p", { class: "note" },
    `Error against the finest run, ${sweep.parameter} ${sweep.finest}. A line that falls by a factor of `
    + "two where the parameter doubles is convergence of first order.");
  byId("sweep-list").append(note, element("div", { class: "sweep" },
    element("div", { class: "plot tall" }, canvas), table));
  const options = plotOptions(sweep.parameter, "error",
    { xType: "logarithmic", yType: "logarithmic", legend: true });
  options.scales.x.ticks.callback = (value) => (
    sweep.runs.some((run) => run.value === value) ? String(value) : "");
  const points = (pick) => sweep.runs.map((run) => ({ x: run.value, y: pick(run) })).filter((p) => p.y > 0);
  new Chart(canvas, {
    type: "line",
    data: { datasets: [
      { label: "ΔE2000 mean", data: points((r) => r.delta_e2000.mean), borderColor: "#3f7cac",
        backgroundColor: "#3f7cac" },
      { label: "RMSE", data: points((r) => r.rmse), borderColor: "#c8553d", backgroundColor: "#c8553d" },
    ] },
    options,
  });
}

function drawCharts() {
  drawHistogram();
  drawTimes();
  if (report.sweeps.length > 0) byId("sweeps").hidden = false;
  report.sweeps.forEach(drawSweep);
}
