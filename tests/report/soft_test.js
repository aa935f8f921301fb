// A run under lights with and without area, read as a person reads it.

import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";

import { bytesOf, sharesOf } from "./blobs.js";
import { choose, closeBrowser, colorAt, dataOf, gnomon, home, open, openBrowser, readOut, saved, settled, shownRows } from "./browser.js";
import { makeSoftRun, openPictures, report, rowOf, scene } from "./soft_run.js";

before(async () => {
  makeSoftRun();
  await openBrowser();
});
after(closeBrowser);

test("the table has an error with its causes and its floor beside it, and what soft shadows alone have", async () => {
  const page = await open(report);
  const data = await dataOf(page);
  const headings = await page.locator("#table thead th").evaluateAll((cells) => cells.map((cell) => cell.dataset.column));
  const error = headings.indexOf("error");
  assert.ok(error > 0, String(headings));
  assert.deepEqual(headings.slice(error, error + 4), ["error", "causes", "error_floor", "snapping_floor"]);
  for (const name of ["other_error_mean", "penumbra_width_ratio", "penumbra_shift", "penumbra_noise"])
    assert.ok(headings.includes(name), name);
  const cells = (row) =>
    page.locator(`tr[data-row="${row}"] > *`).evaluateAll((all) => all.map((cell) => cell.textContent.replace("\u2605", "")));
  const column = (name) => data.columns.findIndex((info) => info.name === name);
  const soft = rowOf(data, "area_rays:samples=4"),
    hard = rowOf(data, "shadow_map:resolution=64", "bulb");
  const shown = await cells(soft);
  assert.equal(shown[error], data.rows[soft].texts[column("error")]);
  assert.equal(shown[error + 2], data.rows[soft].texts[column("error_floor")]);
  assert.equal(shown[error + 3], "-", "a floor of rasterizers");
  assert.ok(data.rows[soft].values[column("error_floor")] > 0);
  assert.equal((await cells(hard))[error + 2], "-");
  assert.equal(data.rows[hard].values[column("error")], data.rows[hard].values[column("wrong_rate")]);
  const best = rowOf(data, "exact_area");
  assert.match(await page.locator(`tr[data-row="${best}"] td.best`).allTextContents().then(String), /\u2605/);
  assert.match(await page.locator(".marks").textContent(), /error mean difference from the reference over the tested pixels/);
  await page.locator('th[data-column="error"] button').click();
  const values = (await shownRows(page)).map((row) => data.rows[row].values[column("error")]).filter((value) => value !== null);
  assert.deepEqual(
    values,
    [...values].sort((a, b) => a - b),
  );
  assert.deepEqual(page.troubles, []);
  await page.screenshot({ path: saved("soft_table.png") });
  await page.context().close();
});

test("the front is of errors, under a light with area above a dotted floor", async () => {
  const page = await open(report);
  const data = await dataOf(page);
  await page.locator("#plots").scrollIntoViewIfNeeded();
  const front = page.locator(".card.front");
  await front.locator("figure svg[role=img]").waitFor();
  assert.equal(await front.locator("select[name=error]").inputValue(), "error");
  const choose = async (light) => {
    const group = data.groups.findIndex((info) => info.light === light);
    await front.locator("select[name=where]").selectOption(String(group));
    await settled(page);
    return front.locator("> figure").textContent();
  };
  const soft = await choose("lamp");
  assert.match(soft, /error \(%\)/);
  assert.match(soft, /Dashed: the best constant mask/);
  assert.match(soft, /Dotted: the error floor/);
  const lines = await front.locator('svg g[stroke-dasharray="1 4"] line').count();
  assert.equal(lines, 1);
  const hard = await choose("bulb");
  assert.match(hard, /error \(%\)/);
  assert.doesNotMatch(hard, /Dotted/);
  assert.deepEqual(page.troubles, []);
  await page.context().close();
});

test("errors fall along samples: seeds are one point, with their floor and a slope to compare with", async () => {
  const page = await open(report);
  const data = await dataOf(page);
  await page.locator("#plots").scrollIntoViewIfNeeded();
  const card = page.locator(".card.scaling");
  await card.locator("select[name=along]").selectOption("parameter.samples");
  await card.locator("select[name=what]").selectOption("error");
  await settled(page);
  const svg = card.locator("figure svg[role=img]");
  // Two settings, each at 4 and at 16 samples.
  const dots = await svg
    .locator("g[data-mark=dot] path, g[data-mark=dot] circle")
    .evaluateAll((all) => all.map((dot) => dot.getAttribute("transform").match(/[\d.]+/g).map(Number)));
  assert.equal(dots.length, 4);
  const text = await card.locator("> figure").textContent();
  assert.match(text, /slope \u22121\/2/);
  assert.match(text, /means of up to 3 seeds, bars reach from the smallest to the largest/);
  assert.match(text, /Dotted: the error floor/);
  assert.equal(await svg.locator('g[stroke-dasharray="1 4"] line').count(), 1);
  // Heights are logarithms: two errors that are known give pixels for each decade.
  const column = data.columns.findIndex(({ name }) => name === "error");
  const errorOf = (title) => data.rows[rowOf(data, title)].values[column];
  const mean = (samples) => {
    const seeds = [1, 2, 3].map((seed) => errorOf(`area_rays:samples=${samples},pattern=random,seed=${seed}`));
    return seeds.reduce((sum, one) => sum + one, 0) / 3;
  };
  const errors = [errorOf("area_rays:samples=4"), errorOf("area_rays:samples=16"), mean(4), mean(16)];
  const across = [...new Set(dots.map(([x]) => x))].sort((p, q) => p - q);
  assert.equal(across.length, 2);
  const places = dots.map(([, y]) => y).sort((p, q) => p - q),
    sorted = errors.map(Math.log10).sort((p, q) => q - p);
  const decade = (places[3] - places[0]) / (sorted[0] - sorted[3]);
  places.forEach((place, k) => assert.ok(Math.abs(place - places[0] - decade * (sorted[0] - sorted[k])) < 0.5, String(places)));
  // From 4 to 16 one over the root halves.
  const guide = await svg.locator('g[stroke-dasharray="7 5"] path').getAttribute("d");
  const [x0, y0, x1, y1] = guide.match(/[\d.]+/g).map(Number);
  assert.ok(Math.abs(x0 - across[0]) < 0.5 && Math.abs(x1 - across[1]) < 0.5, guide);
  assert.ok(Math.abs(y1 - y0 - decade * Math.log10(2)) < 0.5, `${guide}, ${decade} a decade`);
  assert.deepEqual(page.troubles, []);
  await card.screenshot({ path: saved("samples.png") });
  await card.locator("select[name=what]").selectOption("resolve");
  await settled(page);
  assert.doesNotMatch(await card.locator("> figure").textContent(), /slope|Dotted/, "a time has neither");
  await page.context().close();
});

test("errors are as strong as they are large, and the legend has their scale", async () => {
  const page = await openPictures("center_ray");
  const data = await dataOf(page);
  const row = rowOf(data, "center_ray"),
    { pictures } = data.groups[data.rows[row].group];
  const mask = await sharesOf(page, data.rows[row].pictures.mask, pictures.bits),
    truth = await sharesOf(page, pictures.reference, pictures.bits),
    classes = await bytesOf(page, pictures.classes);
  const tested = data.classes.findIndex((info) => info.name === "T");
  const find = (accepts) => mask.findIndex((value, i) => classes[i] === tested && accepts(value - truth[i]));
  const at = (i) => colorAt(page, i % 160, Math.floor(i / 160));
  const weak = find((off) => off < -0.11 && off > -0.29),
    strong = find((off) => off < -0.31),
    light = find((off) => off > 0.31),
    right = find((off) => off === 0);
  for (const i of [weak, strong, light, right]) assert.ok(i >= 0);
  const legend = () => page.locator("#pictures > .swatches").textContent();
  await choose(page, "error");
  assert.deepEqual(await at(strong), [213, 94, 0]);
  assert.deepEqual(await at(light), [86, 180, 233]);
  const [r, g, b] = await at(right);
  assert.ok(r === g && g === b, "what is right stays gray");
  const [wr, , wb] = await at(weak);
  assert.ok(wr > wb && wb > 0, `${wr} ${wb}: between gray and orange`);
  assert.match(await legend(), /error [\d.]+ %, floor [\d.]+ %/);
  assert.match(await legend(), /too dark [\d.]+ % of the error\s*too light [\d.]+ % of the error/);
  assert.match(await legend(), /off by 1 %\s*3 %\s*10 %\s*30 % or more/);
  // The hard shadow of the light's center: its causes hold all of the error.
  await choose(page, "causes");
  const cause = data.causes.find((info) => info.name === "hard_shadow");
  assert.deepEqual(await at(strong), cause.color);
  assert.match(await legend(), /error .*hard shadow [\d.]+ % of the error/);
  const held = data.rows[row].causes.reduce((sum, part) => sum + part, 0);
  const error = data.rows[row].values[data.columns.findIndex((info) => info.name === "error")];
  assert.ok(Math.abs(held - error) < 1e-9, `${held} ${error}`);
  await choose(page, "error");
  await page.locator(".viewport canvas").focus();
  await page.locator("#pictures").screenshot({ path: saved("soft_error.png") });
  await page.context().close();
});

test("masks are gray, and the read-out says how far a pixel is off", async () => {
  const page = await openPictures("area_rays:samples=4");
  const data = await dataOf(page);
  const row = rowOf(data, "area_rays:samples=4"),
    { pictures } = data.groups[data.rows[row].group];
  const mask = await sharesOf(page, data.rows[row].pictures.mask, pictures.bits),
    truth = await sharesOf(page, pictures.reference, pictures.bits),
    classes = await bytesOf(page, pictures.classes);
  const tested = data.classes.findIndex((info) => info.name === "T");
  const half = mask.findIndex((value, i) => value === 2048 / 4095 && classes[i] === tested && Math.abs(value - truth[i]) > 0.02);
  assert.ok(half >= 0);
  await page.locator(".toggle", { hasText: "shaded" }).locator("input").uncheck();
  await choose(page, "flicker");
  const [x, y] = [half % 160, Math.floor(half / 160)];
  assert.deepEqual(await colorAt(page, x, y), [128, 128, 128]);
  const canvas = page.locator(".viewport canvas");
  const box = await canvas.boundingBox();
  const scale = Math.min(box.width / 160, box.height / 90);
  await page.mouse.move(
    box.x + (box.width - 160 * scale) / 2 + (x + 0.5) * scale,
    box.y + (box.height - 90 * scale) / 2 + (y + 0.5) * scale,
  );
  const said = await readOut(page);
  assert.equal(said.pixel, `${x}, ${y}`);
  assert.match(said.A, /^0\.50 \([+\u2212]0\.\d\d\)$/);
  assert.equal(said.reference, truth[half].toFixed(2));
  assert.deepEqual(page.troubles, []);
  await page.context().close();
});

// Half of the light in twice the light is white, in half of it a quarter. False colors are a helix (Green 2011): black and white
// at the ends, and in between lighter the more is seen, as luminance by Rec. 709 is.
test("exposure multiplies the light, and false colors rise with it", async () => {
  const page = await openPictures("area_rays:samples=4");
  const data = await dataOf(page);
  const row = rowOf(data, "area_rays:samples=4"),
    { pictures } = data.groups[data.rows[row].group];
  const mask = await sharesOf(page, data.rows[row].pictures.mask, pictures.bits),
    classes = await bytesOf(page, pictures.classes);
  const tested = data.classes.findIndex((info) => info.name === "T");
  const at = (value) => mask.findIndex((share, i) => share === value && classes[i] === tested);
  const half = at(2048 / 4095),
    colorOf = (i) => colorAt(page, i % 160, Math.floor(i / 160));
  const [exposure, colors] = [page.locator("select[name=exposure]"), page.locator(".toggle", { hasText: "false colors" }).locator("input")];
  await choose(page, "flicker");
  await page.locator(".toggle", { hasText: "shaded" }).locator("input").uncheck();
  for (const [stops, gray] of [["1", 255], ["-1", 64], ["0", 128]]) {
    await exposure.selectOption(stops);
    assert.deepEqual(await colorOf(half), [gray, gray, gray], stops);
  }
  await colors.check();
  const legend = await page.locator('#pictures ul[aria-label="Colors of the picture"]').textContent();
  assert.match(legend, /dark0.*0\.25.*0\.5.*0\.75.*1.*lit/);
  const shown = [];
  for (const value of [0, 1024 / 4095, 2048 / 4095, 3071 / 4095, 1]) if (at(value) >= 0) shown.push(await colorOf(at(value)));
  assert.ok(shown.length >= 4, `${shown.length} shares are seen`);
  assert.deepEqual([shown[0], shown.at(-1)], [[0, 0, 0], [255, 255, 255]]);
  const lightness = shown.map(([r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b);
  lightness.slice(1).forEach((value, k) => assert.ok(value > lightness[k] + 20, String(lightness)));
  assert.ok(shown.slice(1, -1).some(([r, g, b]) => Math.max(r, g, b) - Math.min(r, g, b) > 60), "they are colors");
  // A link shows what was seen, and differences have colors of their own.
  await exposure.selectOption("2");
  assert.match(await page.locator('#pictures ul[aria-label="Colors of the picture"]').textContent(), /0\.125.*or more.*4 times the light/);
  await page.waitForFunction(() => location.hash.includes("exposure=2"));
  const again = await page.context().newPage();
  await again.goto(page.url());
  await settled(again);
  assert.equal(await again.locator("select[name=exposure]").inputValue(), "2");
  assert.ok(await again.locator(".toggle", { hasText: "false colors" }).locator("input").isChecked());
  await choose(page, "difference");
  assert.ok(await exposure.isHidden());
  assert.deepEqual(page.troubles, []);
  await page.context().close();
});

/** The pixels of a PNG file, [r, g, b] each. */
const pixelsOf = (page, file) =>
  page.evaluate(
    async (source) => {
      const image = new Image();
      image.src = source;
      await image.decode();
      const canvas = new OffscreenCanvas(image.width, image.height).getContext("2d");
      canvas.drawImage(image, 0, 0);
      const bytes = canvas.getImageData(0, 0, image.width, image.height).data;
      return Array.from({ length: bytes.length / 4 }, (_, i) => [...bytes.slice(4 * i, 4 * i + 3)]);
    },
    `data:image/png;base64,${readFileSync(file).toString("base64")}`,
  );

// With this exposure the floor is three times as bright as white: a place that sees half of the lamp is white, too;
// mixed from a white that was cut off it would be gray.
test("penumbrae of what is brighter than white are as bright as in the row's own picture", async () => {
  const run = join(home, "bright"),
    of = join(run, "report.html");
  writeFileSync(join(home, "bright.toml"), `${scene}exposure = 6\n`);
  writeFileSync(
    join(home, "bright_suite.toml"),
    `
width = 160
height = 90
repetitions = 1
warmups = 1
[[group]]
scenes = ["${join(home, "bright.toml")}"]
techniques = ["unshadowed"]
[[group]]
scenes = ["${join(home, "bright.toml")}"]
lights = ["lamp"]
techniques = ["exact_area"]
`,
  );
  gnomon(["run", join(home, "bright_suite.toml"), "--out", run, "--quiet"]);
  gnomon(["report", run]);
  const page = await openPictures("exact_area", { of, scene: "bright.toml" });
  const data = await dataOf(page);
  const row = rowOf(data, "exact_area"),
    { pictures } = data.groups[data.rows[row].group];
  assert.ok(pictures.white > 3, `${pictures.white} is the brightest`);
  const records = readFileSync(join(run, "records.jsonl"), "utf8").trim().split("\n").map(JSON.parse);
  const record = records.find(({ technique }) => technique === "exact_area");
  const drawn = await pixelsOf(page, join(run, record.shaded_picture));
  const mask = await sharesOf(page, data.rows[row].pictures.mask, pictures.bits);
  await choose(page, "flicker");
  const half = mask.flatMap((share, i) => (share > 0.2 && share < 0.8 ? [i] : [])).filter((_, k) => k % 20 === 0);
  assert.ok(half.length > 20, `${half.length} pixels`);
  for (const i of half) {
    const shown = await colorAt(page, i % 160, Math.floor(i / 160));
    assert.ok(
      shown.every((value, c) => Math.abs(value - drawn[i][c]) <= 2),
      `pixel ${i}, share ${mask[i]}: ${shown}, in the picture ${drawn[i]}`,
    );
  }
  assert.deepEqual(page.troubles, []);
  await page.context().close();
});
