// The picture: two modes with a slider between them, or a heat map; and the place of the probe.
"use strict";

const view = { x: 0, y: 0, split: 0.5, map: "", listeners: [] };
const byId = (id) => document.getElementById(id);
const stage = byId("stage");

// For tests and for whoever wants to know: what is shown, readable from outside.
window.abbeView = view;

function showSplit() {
  byId("over").style.clipPath = `inset(0 ${100 * (1 - view.split)}% 0 0)`;
  byId("divider").style.left = `${100 * view.split}%`;
  byId("slider").value = Math.round(1000 * view.split);
}

function showModes() {
  byId("over").src = report.images[byId("left").value];
  byId("under").src = report.images[byId("right").value];
  byId("over").alt = `rendered in mode ${byId("left").value}`;
  byId("under").alt = `rendered in mode ${byId("right").value}`;
  byId("names").textContent = `${byId("left").value} | ${byId("right").value}`;
}

function swapModes() {
  const left = byId("left").value;
  byId("left").value = byId("right").value;
  byId("right").value = left;
  showModes();
}

function heatColor(share) {
  const at = Math.min(Math.max(share, 0), 1) * (report.heat.length - 1);
  const i = Math.min(Math.floor(at), report.heat.length - 2);
  return report.heat[i].map((c, k) => c + (at - i) * (report.heat[i + 1][k] - c));
}

function hexColor(text) {
  return [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16));
}

function legend(map) {
  const box = byId("legend");
  box.replaceChildren();
  if (map.id === "dominant") {
    for (const cause of report.causes.filter((c) => c.acts)) {
      const chip = element("span", { class: "chip", style: `background:${cause.color}` });
      box.append(element("span", {}, chip, cause.name));
    }
    box.append(`pixels whose ΔE is below ${report.least_delta_e} stay dark`);
    return;
  }
  const stops = report.heat.map((c) => `rgb(${c.map(Math.round).join(" ")})`).join(",");
  box.append("0", element("span", { class: "ramp", style: `background:linear-gradient(90deg,${stops})` }),
    element("span", {}, `${digits(map.scale, 1)} ${map.unit}`), element("span", {}, `largest ${digits(map.max)}`));
}

async function showMap(id) {
  view.map = id;
  byId("map").value = id;
  for (const button of document.querySelectorAll("button[data-map]")) {
    button.setAttribute("aria-pressed", String(button.dataset.map === id));
  }
  const heat = byId("heat");
  heat.hidden = id === "";
  byId("legend").hidden = id === "";
  byId("divider").hidden = id !== "";
  view.mapShown = id === "" ? "" : undefined;
  if (id === "") return;
  const map = await mapNamed(id);
  if (view.map !== id) return;
  heat.width = map.width;
  heat.height = map.height;
  const context = heat.getContext("2d");
  const pixels = context.createImageData(map.width, map.height);
  const colors = report.causes.map((c) => hexColor(c.color));
  map.values.forEach((value, i) => {
    const color = id === "dominant"
      ? (value < 0 ? [24, 26, 29] : colors[Math.round(value)])
      : heatColor(value / map.scale);
    pixels.data.set([...color, 255], 4 * i);
  });
  context.putImageData(pixels, 0, 0);
  legend(map);
  view.mapShown = id;
}

function moveProbe(x, y) {
  view.x = Math.min(Math.max(x, 0), report.size[0] - 1);
  view.y = Math.min(Math.max(y, 0), report.size[1] - 1);
  byId("cross").style.left = `${(100 * (view.x + 0.5)) / report.size[0]}%`;
  byId("cross").style.top = `${(100 * (view.y + 0.5)) / report.size[1]}%`;
  for (const listener of view.listeners) listener(view.x, view.y);
}

function moveSplit(split) {
  view.split = Math.min(Math.max(split, 0), 1);
  showSplit();
}

function pointed(event) {
  const box = stage.getBoundingClientRect();
  return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
}

function followPointer() {
  let drags = false;
  stage.addEventListener("pointerdown", (event) => {
    const [u, v] = pointed(event);
    drags = view.map === "" && Math.abs(u - view.split) * stage.clientWidth < 8;
    stage.setPointerCapture(event.pointerId);
    if (!drags) moveProbe(Math.floor(u * report.size[0]), Math.floor(v * report.size[1]));
  });
  stage.addEventListener("pointermove", (event) => {
    const [u] = pointed(event);
    if (drags) moveSplit(u);
    const near = view.map === "" && Math.abs(u - view.split) * stage.clientWidth < 8;
    stage.style.cursor = near || drags ? "ew-resize" : "crosshair";
  });
  stage.addEventListener("pointerup", () => { drags = false; });
}

function followKeys() {
  const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  stage.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const step = steps[event.key];
    const far = event.shiftKey ? 10 : 1;
    if (step) moveProbe(view.x + far * step[0], view.y + far * step[1]);
    else if (event.key === "a" || event.key === "A") moveSplit(view.split - 0.02 * far);
    else if (event.key === "d" || event.key === "D") moveSplit(view.split + 0.02 * far);
    else if (event.key === "m" || event.key === "M") {
      const ids = ["", ...report.maps.map((m) => m.id)];
      showMap(ids[(ids.indexOf(view.map) + 1) % ids.length]);
    } else if (event.key === " ") swapModes();
    else return;
    event.preventDefault();
  });
}

function setZoom(zoom) {
  stage.style.width = zoom === "fit" ? "100%" : `${report.size[0] * Number(zoom)}px`;
  stage.style.aspectRatio = `${report.size[0]} / ${report.size[1]}`;
}

function startViewer() {
  for (const mode of Object.keys(report.images)) {
    byId("left").append(element("option", {}, mode));
    byId("right").append(element("option", {}, mode));
  }
  byId("left").value = "rgb";
  byId("right").value = "spectral";
  byId("map").append(element("option", { value: "" }, "none: the pictures"));
  for (const map of report.maps) byId("map").append(element("option", { value: map.id }, map.label));
  for (const zoom of ["fit", "1", "2", "4", "8"]) {
    byId("zoom").append(element("option", { value: zoom }, zoom === "fit" ? zoom : `${zoom}×`));
  }
  for (const id of ["left", "right"]) byId(id).addEventListener("change", showModes);
  byId("map").addEventListener("change", (event) => showMap(event.target.value));
  byId("zoom").addEventListener("change", (event) => setZoom(event.target.value));
  byId("slider").addEventListener("input", (event) => moveSplit(event.target.value / 1000));
  followPointer();
  followKeys();
  setZoom("fit");
  showModes();
  showSplit();
}
