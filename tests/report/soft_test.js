// A run under lights with and without area, read as a person reads it.

import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";

import { closeBrowser, colorAt, dataOf, gnomon, home, open, openBrowser, readOut, saved, shownRows } from "./browser.js";

// From straight above a floor 8.284 m wide: a card 2 m wide and 1 m above it, a disc 4 m above it and a bulb at the same place.
const scene = `
[[shape]]
kind = "plane"
center = [0, 0, 0]
normal = [0, 1, 0]
size = [20, 20]
[[shape]]
kind = "box"
min = [-1, 1, -1]
max = [1, 1.01, 1]
[[light]]
name = "lamp"
kind = "disc"
center = [0, 4, 0]
normal = [0, -1, 0]
radius = 0.6
intensity = 8
[[light]]
name = "bulb"
kind = "point"
position = [0, 4, 0]
intensity = 8
[[view]]
name = "above"
eye = [0, 3.5, 3.5]
target = [0, 0.3, 0]
`;
const run = join(home, "run"),
  report = join(run, "report.html");

before(async () => {
  writeFileSync(join(home, "card.toml"), scene);
  writeFileSync(
    join(home, "soft.toml"),
    `
width = 160
height = 90
processes = 2
repetitions = 1
[[group]]
scenes = ["${join(home, "card.toml")}"]
techniques = ["embree_rays", "unshadowed"]
[[group]]
scenes = ["${join(home, "card.toml")}"]
lights = ["bulb"]
techniques = ["shadow_map:resolution={64,256}"]
[[group]]
scenes = ["${join(home, "card.toml")}"]
lights = ["lamp"]
techniques = ["area_rays:samples={4,16}", "center_ray", "exact_area"]
`,
  );
  gnomon(["run", join(home, "soft.toml"), "--out", run, "--quiet"]);
  assert.equal(gnomon(["report", run]).trim(), report);
  await openBrowser();
});
after(closeBrowser);

const rowOf = (data, title, light = "lamp") =>
  data.rows.findIndex((row) => row.title === title && data.groups[row.group].light === light);

test("the table has a mean error with the reference's own beside it, and what soft shadows alone have", async () => {
  const page = await open(report);
  const data = await dataOf(page);
  const headings = await page.locator("thead th").evaluateAll((cells) => cells.map((cell) => cell.dataset.column));
  const error = headings.indexOf("error");
  assert.ok(error > 0, String(headings));
  assert.deepEqual(headings.slice(error, error + 3), ["error", "reference_error_mean", "snapping_floor"]);
  assert.ok(!headings.includes("wrong_rate"), "error says the same");
  for (const name of ["other_error_mean", "penumbra_width_ratio", "penumbra_shift", "penumbra_noise"])
    assert.ok(headings.includes(name), name);
  const cells = (row) =>
    page.locator(`tr[data-row="${row}"] > *`).evaluateAll((all) => all.map((cell) => cell.textContent.replace("\u2605", "")));
  const column = (name) => data.columns.findIndex((info) => info.name === name);
  const soft = rowOf(data, "area_rays:samples=4"),
    hard = rowOf(data, "shadow_map:resolution=64", "bulb");
  const shown = await cells(soft);
  assert.equal(shown[error], data.rows[soft].texts[column("error")]);
  assert.equal(shown[error + 1], data.rows[soft].texts[column("reference_error_mean")]);
  assert.equal(shown[error + 2], "-", "a floor of rasterizers");
  assert.ok(data.rows[soft].values[column("reference_error_mean")] > 0);
  assert.equal(data.rows[soft].values[column("error")], data.rows[soft].values[column("error_mean")]);
  assert.equal((await cells(hard))[error + 1], "-");
  assert.equal(data.rows[hard].values[column("error")], data.rows[hard].values[column("wrong_rate")]);
  const best = rowOf(data, "exact_area");
  assert.match(await page.locator(`tr[data-row="${best}"] td.best`).allTextContents().then(String), /\u2605/);
  assert.match(await page.locator(".marks").textContent(), /error mean difference .* under lights without area the wrong rate/);
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

test("the front is of mean errors above a dotted floor, and of wrong rates elsewhere", async () => {
  const page = await open(report);
  const data = await dataOf(page);
  await page.locator("#plots").scrollIntoViewIfNeeded();
  const front = page.locator(".card.front");
  await front.locator("figure svg[role=img]").waitFor();
  assert.equal(await front.locator("select[name=error]").inputValue(), "error");
  const choose = async (light) => {
    const group = data.groups.findIndex((info) => info.light === light);
    await front.locator("select[name=where]").selectOption(String(group));
    await page.waitForTimeout(150);
    return front.locator("> figure").textContent();
  };
  const soft = await choose("lamp");
  assert.match(soft, /mean error \(%\)/);
  assert.match(soft, /Dotted: the reference's own mean error/);
  const lines = await front.locator('svg g[stroke-dasharray="1 4"] line').count();
  assert.equal(lines, 1);
  const hard = await choose("bulb");
  assert.match(hard, /wrong \(%\)/);
  assert.doesNotMatch(hard, /Dotted/);
  assert.deepEqual(page.troubles, []);
  await page.context().close();
});

/** A page on the comparer, showing the lamp's shadow by `a`. */
async function openPictures(a) {
  const page = await open(report);
  const pictures = page.locator("#pictures");
  await pictures.scrollIntoViewIfNeeded();
  await pictures.locator("select[name=picture]").selectOption({ label: "card.toml \u00b7 lamp" });
  await pictures.locator("select[name=a]").selectOption({ label: a });
  await page.waitForTimeout(200);
  return page;
}

const choose = (page, mode) => page.locator(`input[name=mode][value=${mode}]`).check({ force: true });

/** The mask in the report, 0 .. 255. */
const pictureOf = (page, number) =>
  page.evaluate(async (number) => {
    const bytes = Uint8Array.from(atob(document.getElementById(`blob${number}`).textContent), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    return [...new Uint8Array(await new Response(stream).arrayBuffer())];
  }, number);

test("errors are as strong as they are large, and the legend has their scale", async () => {
  const page = await openPictures("center_ray");
  const data = await dataOf(page);
  const row = rowOf(data, "center_ray"),
    { pictures } = data.groups[data.rows[row].group];
  const mask = await pictureOf(page, data.rows[row].pictures.mask),
    truth = await pictureOf(page, pictures.reference),
    classes = await pictureOf(page, pictures.classes);
  const tested = data.classes.findIndex((info) => info.name === "T");
  const find = (accepts) => mask.findIndex((value, i) => classes[i] === tested && accepts((value - truth[i]) / 255));
  const at = (i) => colorAt(page, i % 160, Math.floor(i / 160));
  const weak = find((off) => off < -0.11 && off > -0.29),
    strong = find((off) => off < -0.31),
    light = find((off) => off > 0.31),
    right = find((off) => off === 0);
  for (const i of [weak, strong, light, right]) assert.ok(i >= 0);
  const legend = () => page.locator("#pictures .swatches").textContent();
  await choose(page, "error");
  assert.deepEqual(await at(strong), [213, 94, 0]);
  assert.deepEqual(await at(light), [86, 180, 233]);
  const [r, g, b] = await at(right);
  assert.ok(r === g && g === b, "what is right stays gray");
  const [wr, , wb] = await at(weak);
  assert.ok(wr > wb && wb > 0, `${wr} ${wb}: between gray and orange`);
  assert.match(await legend(), /mean error [\d.]+ %, the reference's own [\d.]+ %/);
  assert.match(await legend(), /too dark [\d.]+ % of the error\s*too light [\d.]+ % of the error/);
  assert.match(await legend(), /off by 1 %\s*3 %\s*10 %\s*30 % or more/);
  // The hard shadow of the light's center: its causes hold all of the error.
  await choose(page, "causes");
  const cause = data.causes.find((info) => info.name === "hard_shadow");
  assert.deepEqual(await at(strong), cause.color);
  assert.match(await legend(), /mean error .*hard shadow [\d.]+ % of the error/);
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
  const mask = await pictureOf(page, data.rows[row].pictures.mask),
    truth = await pictureOf(page, pictures.reference),
    classes = await pictureOf(page, pictures.classes);
  const tested = data.classes.findIndex((info) => info.name === "T");
  const half = mask.findIndex((value, i) => value === 128 && classes[i] === tested && Math.abs(value - truth[i]) > 5);
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
  assert.equal(said.reference, (truth[half] / 255).toFixed(2));
  assert.deepEqual(page.troubles, []);
  await page.context().close();
});
