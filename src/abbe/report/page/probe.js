// One pixel: its spectrum, its colour in each mode, its differences, its rays.
"use strict";

let spectrumChart = null;
let numbers = null;  // Linear colours and spectra on the grid of report.probe.

async function loadProbe() {
  const probe = report.probe;
  numbers = {
    colors: await unpackedNumbers(probe.colors),
    spectra: await unpackedSpectra(probe.spectra, report.bands.length),
  };
}

// The colours of the spectrum under the curve.
function spectralFill(context) {
  const { ctx, chartArea, scales } = context.chart;
  if (!chartArea) return "transparent";
  const gradient = ctx.createLinearGradient(chartArea.left, 0, chartArea.right, 0);
  for (const band of report.bands) {
    const at = (scales.x.getPixelForValue(band.nm) - chartArea.left) / chartArea.width;
    if (at >= 0 && at <= 1) gradient.addColorStop(at, band.color);
  }
  return gradient;
}

function startProbe() {
  const ink = getComputedStyle(document.body).getPropertyValue("--ink");
  spectrumChart = new Chart(byId("spectrum"), {
    type: "line",
    data: { datasets: [{ data: [], borderColor: ink, borderWidth: 1.2, pointRadius: 0, fill: "origin",
      backgroundColor: spectralFill }] },
    options: plotOptions("nm", "W·m⁻²·sr⁻¹·nm⁻¹", { xType: "linear" }),
  });
  spectrumChart.options.scales.y.beginAtZero = true;
  spectrumChart.options.scales.y.ticks.callback = (value) => (value === 0 ? "0" : value.toExponential(1));
  view.listeners.push(showProbe);
}

function showSpectrum(cell) {
  const bands = report.bands;
  const largest = numbers.spectra.largest[cell];
  spectrumChart.data.datasets[0].data = bands.map((band, i) => (
    { x: band.nm, y: (largest * numbers.spectra.codes[cell * bands.length + i]) / 255 }));
  spectrumChart.options.scales.x.min = bands[0].nm;
  spectrumChart.options.scales.x.max = bands[bands.length - 1].nm;
  spectrumChart.update();
}

function encoded(linear) {
  const light = Math.min(Math.max(linear * 2 ** report.exposure_ev, 0), 1);
  return Math.round(255 * (light <= 0.0031308 ? 12.92 * light : 1.055 * light ** (1 / 2.4) - 0.055));
}

function showColors(cell) {
  const modes = Object.keys(report.images);
  byId("values").tBodies[0].replaceChildren(...modes.map((mode, m) => {
    const rgb = [0, 1, 2].map((c) => numbers.colors[(cell * modes.length + m) * 3 + c]);
    const chip = element("span", { class: "chip", style: `background:rgb(${rgb.map(encoded).join(" ")})` });
    return row(mode, ...rgb.map((v) => digits(v, 4)), chip);
  }));
}

async function valueAt(id, x, y) {
  const map = await mapNamed(id);
  const column = Math.floor((x * map.width) / report.size[0]);
  return map.values[Math.floor((y * map.height) / report.size[1]) * map.width + column];
}

async function showDifferences(x, y) {
  const rows = [];
  for (const map of report.maps.filter((m) => m.id !== "dominant")) {
    rows.push(row(map.label, digits(await valueAt(map.id, x, y))));
  }
  const dominant = report.maps.some((m) => m.id === "dominant") ? await valueAt("dominant", x, y) : -1;
  rows.unshift(row("dominant cause", dominant < 0 ? "none" : report.causes[Math.round(dominant)].name));
  if (view.x === x && view.y === y) byId("differences").tBodies[0].replaceChildren(...rows);
}

// Pixels of a crop keep the numbers that they have in the whole image.
function named(x, y) {
  return `${x + report.origin[0]},${y + report.origin[1]}`;
}

function showTree(x, y) {
  const distance = (t) => (t.x - x) ** 2 + (t.y - y) ** 2;
  const trees = report.trees;
  if (trees.length === 0) return;
  const nearest = trees.reduce((best, t) => (distance(t) < distance(best) ? t : best));
  byId("tree-place").textContent = nearest.x === x && nearest.y === y
    ? `of ${named(x, y)}` : `of ${named(nearest.x, nearest.y)}, the nearest of ${trees.length} kept here; `
      + `for this pixel: abbe probe SCENE --size ${report.full_size.join("x")} --pixel ${named(x, y)}`;
  byId("tree").textContent = nearest.text;
}

function showProbe(x, y) {
  const probe = report.probe;
  const cell = Math.floor(y / probe.block) * probe.width + Math.floor(x / probe.block);
  byId("place").textContent = probe.block === 1 ? named(x, y)
    : `${named(x, y)} (spectrum and colours: mean of its ${probe.block}×${probe.block} pixels)`;
  if (report.bands.length > 0) showSpectrum(cell);
  showColors(cell);
  showTree(x, y);
  showDifferences(x, y);
}
