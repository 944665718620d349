// Puts the page together.
"use strict";

function fillCauses() {
  byId("method").textContent = report.attribution.text;
  const largest = Math.max(...report.causes.map((c) => Math.abs(c.share)), Math.abs(report.interaction.share), 1e-9);
  const body = byId("cause-table").tBodies[0];
  const bar = (share, color) => element("td", { class: "track" },
    element("div", { style: `width:${(100 * Math.abs(share)) / largest}%;background:${color}` }));
  for (const cause of report.causes) {
    const d = cause.delta_e2000;
    const cells = cause.acts
      ? [percent(cause.share), bar(cause.share, cause.color), digits(d.mean), digits(d.p95), digits(d.max)]
      : ["0.0 %", bar(0, "transparent"), "0", "0", "0"];
    const name = cause.acts
      ? element("button", { "data-map": cause.name, "aria-pressed": "false" }, cause.name) : cause.name;
    const line = row(element("td", { title: cause.text }, name), ...cells);
    if (!cause.acts) line.className = "idle";
    body.append(line);
  }
  if (report.interaction.shown) {
    const d = report.interaction.delta_e2000;
    body.append(row("interaction", percent(report.interaction.share),
      bar(report.interaction.share, "#8a8f96"), digits(d.mean), digits(d.p95), digits(d.max)));
  }
  byId("cause-note").textContent = report.attribution.note;
  for (const button of document.querySelectorAll("button[data-map]")) {
    button.addEventListener("click", () => showMap(view.map === button.dataset.map ? "" : button.dataset.map));
  }
}

function fillMetrics() {
  const names = { delta_e2000: "ΔE2000", delta_e_itp: "ΔE ITP", flip: "FLIP" };
  for (const [mode, metrics] of Object.entries(report.difference)) {
    for (const [key, name] of Object.entries(names)) {
      const m = metrics[key];
      byId("metrics").tBodies[0].append(row(`${mode}: ${name}`, digits(m.mean, 3), digits(m.p95, 3), digits(m.max)));
    }
  }
}

function fillProvenance() {
  const modes = Object.keys(report.provenance);
  byId("provenance").tHead.append(element("tr", {}, ...["", ...modes].map((m) => element("th", {}, m))));
  const names = [...new Set(modes.flatMap((m) => Object.keys(report.provenance[m])))];
  for (const name of names) {
    byId("provenance").tBodies[0].append(row(name, ...modes.map((m) => report.provenance[m][name] ?? "")));
  }
}

async function start() {
  byId("summary").textContent = report.summary;
  fillCauses();
  fillMetrics();
  fillProvenance();
  startViewer();
  drawCharts();
  await loadProbe();
  startProbe();
  moveProbe(Math.floor(report.size[0] / 2), Math.floor(report.size[1] / 2));
  document.documentElement.dataset.ready = "1";
}

start();
