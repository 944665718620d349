// What the page knows: the JSON of the data element, and its packed numbers. All else is built from
// `report`; see src/report/pack.h for the codes.
"use strict";

const report = JSON.parse(document.getElementById("data").textContent);

async function inflated(text) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// A map's values, each code being the difference to the one on its left.
async function unpackedMap(map) {
  const codes = await inflated(map.data);
  const values = new Float32Array(codes.length);
  let left = 0;
  for (let i = 0; i < codes.length; ++i) {
    if (i % map.width === 0) left = 0;
    left = (left + codes[i]) & 255;
    const code = map.signed && left > 127 ? left - 256 : left;
    const root = code / (map.signed ? 127 : 255);
    values[i] = Math.sign(root) * map.max * root * root;
  }
  return { ...map, values };
}

async function unpackedNumbers(packed) {
  const bytes = await inflated(packed.data);
  const codes = new Int16Array(bytes.buffer, 0, bytes.length / 2);
  return Float32Array.from(codes, (c) => Math.sign(c) * packed.max * (c / 32767) ** 2);
}

async function unpackedSpectra(packed, bands) {
  const bytes = await inflated(packed);
  const count = bytes.length / (4 + bands);
  return { largest: new Float32Array(bytes.buffer, 0, count), codes: bytes.subarray(4 * count) };
}

// Maps are unpacked when they are first looked at.
const unpacked = new Map();
function mapNamed(id) {
  if (!unpacked.has(id)) unpacked.set(id, unpackedMap(report.maps.find((m) => m.id === id)));
  return unpacked.get(id);
}

function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name === "style") made.style.cssText = value;
    else made.setAttribute(name, value);
  }
  made.append(...children);
  return made;
}

function row(...cells) {
  return element("tr", {}, ...cells.map((c) => (c instanceof Node && c.nodeName === "TD" ? c : element("td", {}, c))));
}

function digits(value, count = 2) {
  if (value === null || value === undefined) return "-";
  const size = Math.abs(value);
  if (size !== 0 && size < 0.5 * 10 ** -count) return "≈ 0";
  return value.toFixed(count);
}

function percent(share) {
  const text = (100 * share).toFixed(1);
  return `${text === "-0.0" ? "0.0" : text}\u00a0%`;
}
