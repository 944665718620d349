// The page of `abbe compare` in Chromium, used as a reader would: slider, probe, maps, keyboard.
//
//   node page_test.mjs ABBE SOURCE_FOLDER NODE_MODULES RESULTS_FOLDER
//
// Screenshots are left in the results folder to be looked at.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdirSync, rmSync, statSync } from "node:fs";
import { createRequire } from "node:module";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [abbe, source, modules, results] = process.argv.slice(2).map((path) => resolve(path));
if (!existsSync(`${modules}/playwright-core`)) {
  console.error(`playwright-core is missing in ${modules}: make deps-page installs it`);
  process.exit(1);
}
const { chromium } = createRequire(`${modules}/here.js`)("playwright-core");
const browserPath = process.env.ABBE_CHROMIUM ?? "/usr/bin/chromium";

rmSync(results, { recursive: true, force: true });
mkdirSync(results, { recursive: true });
const folder = `${results}/compare`;
execFileSync(abbe, ["compare", `${source}/scenes/prism/prism.gltf`, "-o", folder, "--size", "96x54",
  "--spp", "1", "--wavelengths", "8", "--sweep", "wavelengths=4,8", "--quiet"], { stdio: "inherit" });

const browser = await chromium.launch({ executablePath: browserPath, args: ["--no-sandbox",
  "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
  "--disable-component-update", "--disable-sync"] });
const errors = [];
const requests = [];

async function open(scheme) {
  const context = await browser.newContext({ viewport: { width: 1400, height: 1000 }, colorScheme: scheme });
  const page = await context.newPage();
  page.on("pageerror", (error) => errors.push(error.message));
  page.on("console", (message) => { if (message.type() === "error") errors.push(message.text()); });
  page.on("request", (request) => requests.push(request.url()));
  await page.goto(pathToFileURL(`${folder}/index.html`).href);
  await page.waitForSelector("html[data-ready]");
  return page;
}

// Mean colour of a part of the stage, given in shares of it, as it is on the screen.
async function seen(page, u0, v0, u1, v1) {
  const box = await page.locator("#stage").boundingBox();
  const shot = await page.screenshot({ clip: { x: box.x + u0 * box.width, y: box.y + v0 * box.height,
    width: (u1 - u0) * box.width, height: (v1 - v0) * box.height } });
  return page.evaluate(async (base64) => {
    const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
    const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
    const context = canvas.getContext("2d");
    context.drawImage(bitmap, 0, 0);
    const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    const sum = [0, 0, 0];
    let chroma = 0;
    for (let i = 0; i < data.length; i += 4) {
      for (let c = 0; c < 3; ++c) sum[c] += data[i + c];
      chroma += Math.max(data[i], data[i + 1], data[i + 2]) - Math.min(data[i], data[i + 1], data[i + 2]);
    }
    return { mean: sum.map((s) => (4 * s) / data.length), chroma: (4 * chroma) / data.length };
  }, shot.toString("base64"));
}

const cases = [];
const test = (name, body) => cases.push([name, body]);

test("slider_shows_grey_glass_on_its_left_and_a_spectrum_on_its_right", async (page) => {
  const slider = page.locator("#slider");
  await slider.focus();
  await page.keyboard.press("Home");
  assert.equal(await page.evaluate(() => abbeView.split), 0);
  // The prism's right face: the spectrum in spectral mode, white slits in rgb.
  const spectral = await seen(page, 0.52, 0.2, 0.62, 0.6);
  await page.keyboard.press("End");
  assert.equal(await page.evaluate(() => abbeView.split), 1);
  const rgb = await seen(page, 0.52, 0.2, 0.62, 0.6);
  assert.ok(spectral.chroma > 40, `spectral is colourful: ${spectral.chroma}`);
  assert.ok(rgb.chroma < 15, `rgb is grey: ${rgb.chroma}`);
  await slider.fill("500");
  assert.equal(await page.evaluate(() => abbeView.split), 0.5);
});

test("probe_follows_a_click_with_spectrum_colours_and_rays", async (page) => {
  const box = await page.locator("#stage").boundingBox();
  await page.mouse.click(box.x + 0.57 * box.width, box.y + 0.4 * box.height);
  assert.deepEqual(await page.evaluate(() => [abbeView.x, abbeView.y]), [54, 21]);
  assert.match(await page.locator("#place").textContent(), /54,21/);
  assert.equal(await page.locator("#values tbody tr").count(), 3);
  const spectrum = await page.evaluate(() => spectrumChart.data.datasets[0].data);
  assert.equal(spectrum.length, 36);
  assert.ok(Math.max(...spectrum.map((p) => p.y)) > 0);
  // Light of one wavelength or few behind a prism: its spectrum stands out of its own mean.
  const mean = spectrum.reduce((sum, p) => sum + p.y, 0) / 36;
  assert.ok(Math.max(...spectrum.map((p) => p.y)) > 3 * mean);
  await page.waitForFunction(() => document.querySelector("#differences").textContent.includes("dispersion"));
  assert.match(await page.locator("#tree").textContent(), /camera, united, 8 wavelengths/);
  assert.match(await page.locator("#tree-place").textContent(), /abbe probe SCENE --size 96x54 --pixel 54,21/);
});

test("map_of_a_cause_is_drawn_where_it_acts", async (page) => {
  await page.locator("#map").selectOption("dispersion");
  await page.waitForFunction(() => abbeView.mapShown === "dispersion");
  const glass = await seen(page, 0.52, 0.2, 0.62, 0.6);
  const backdrop = await seen(page, 0.02, 0.02, 0.3, 0.2);
  const sum = (color) => color.mean.reduce((a, b) => a + b);
  assert.ok(sum(glass) > sum(backdrop) + 60, `${sum(glass)} against ${sum(backdrop)}`);
  await page.screenshot({ path: `${results}/map.png`, fullPage: true });
  await page.locator("button[data-map=dispersion]").click();
  assert.equal(await page.evaluate(() => abbeView.map), "");
  assert.ok(await page.locator("#heat").isHidden());
});

test("dominant_cause_of_the_glass_is_dispersion", async (page) => {
  await page.locator("#map").selectOption("dominant");
  await page.waitForFunction(() => abbeView.mapShown === "dominant");
  const color = await page.evaluate(() => report.causes.find((c) => c.name === "dispersion").color);
  const pixel = await page.evaluate(() => [...document.getElementById("heat").getContext("2d")
    .getImageData(54, 21, 1, 1).data].slice(0, 3));
  assert.deepEqual(pixel, [1, 3, 5].map((i) => parseInt(color.slice(i, i + 2), 16)));
  await page.locator("#map").selectOption("");
});

test("keyboard_moves_probe_slider_map_and_modes", async (page) => {
  await page.locator("#stage").focus();
  const [x, y] = await page.evaluate(() => [abbeView.x, abbeView.y]);
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("Shift+ArrowUp");
  assert.deepEqual(await page.evaluate(() => [abbeView.x, abbeView.y]), [x + 1, y - 10]);
  await page.keyboard.press("d");
  assert.ok((await page.evaluate(() => abbeView.split)) > 0.5);
  await page.keyboard.press("m");
  await page.waitForFunction(() => abbeView.mapShown === "dominant");
  await page.locator("#map").selectOption("");
  await page.locator("#stage").focus();
  await page.keyboard.press("Space");
  assert.equal(await page.locator("#left").inputValue(), "spectral");
  // Every control can be reached and seen to be in focus.
  await page.locator("#left").focus();
  await page.keyboard.press("Tab");
  assert.equal(await page.evaluate(() => document.activeElement.id), "right");
});

test("causes_histogram_times_sweep_and_provenance_are_there", async (page) => {
  assert.equal(await page.locator("#cause-table tbody tr").count() >= 5, true);
  assert.match(await page.locator("#cause-table tbody tr").first().textContent(), /dispersion\d\d\.\d\s%/);
  assert.equal(await page.locator("canvas[data-sweep=wavelengths]").count(), 1);
  assert.match(await page.locator("#provenance").textContent(), /Jakob-Hanika/);
  for (const id of ["histogram", "times", "spectrum"]) {
    const drawn = await page.evaluate((name) => {
      const canvas = document.getElementById(name);
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      return data.some((v) => v !== 0);
    }, id);
    assert.ok(drawn, id);
  }
});

let failed = 0;
const page = await open("light");
for (const [name, body] of cases) {
  try {
    await body(page);
    console.log(`ok ${name}`);
  } catch (error) {
    failed += 1;
    console.error(`FAILED ${name}: ${error.stack}`);
    await page.screenshot({ path: `${results}/failed-${name}.png`, fullPage: true });
  }
}
await page.screenshot({ path: `${results}/light.png`, fullPage: true });
const dark = await open("dark");
await dark.screenshot({ path: `${results}/dark.png`, fullPage: true });
const ground = await dark.evaluate(() => getComputedStyle(document.body).backgroundColor);
await browser.close();
try {
  assert.match(ground, /rgb\((\d|1\d|2\d), /, "the dark page is dark");
  assert.deepEqual(errors, [], "the page reports errors");
  assert.deepEqual(requests.filter((url) => !/^(file|data|blob):/.test(url)), [], "the page asks the network");
  assert.ok(statSync(`${folder}/index.html`).size < 8e6, "the page is large");
} catch (error) {
  failed += 1;
  console.error(`FAILED the page alone: ${error.message}`);
}
process.exit(failed === 0 ? 0 : 1);
