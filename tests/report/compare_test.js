// Two answers against each other under a light with area: signed differences, contours, and a profile along a line.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import { bytesOf, sharesOf } from "./blobs.js";
import { accessFindings, choose, closeBrowser, colorAt, dataOf, openBrowser, readOut, saved, settled } from "./browser.js";
import { makeSoftRun, openPictures, rowOf } from "./soft_run.js";

before(async () => {
  makeSoftRun();
  await openBrowser();
});
after(closeBrowser);

const width = 160,
  height = 90;
const check = (page, name) => page.locator("#pictures .toggle", { hasText: name }).locator("input").check();
const legendOf = (page) => page.locator("#pictures > .swatches").textContent();

/** Masks and classes of the lamp's picture; `faces(i)` says whether a pixel faces the light, `tested(i)` whether it counts. */
async function picturesOf(page, title) {
  const data = await dataOf(page),
    row = data.rows[rowOf(data, title)];
  const { pictures } = data.groups[row.group];
  const [mask, truth] = [
    await sharesOf(page, row.pictures.mask, pictures.bits),
    await sharesOf(page, pictures.reference, pictures.bits),
  ];
  const classes = await bytesOf(page, pictures.classes),
    errors = await bytesOf(page, pictures.reference_error);
  const class_of = (name) => data.classes.findIndex((info) => info.name === name);
  const faces = (i) => classes[i] >= class_of("G"),
    tested = (i) => classes[i] === class_of("T");
  return { data, mask, truth, errors: errors.map((k) => (k ? 10 ** ((6 * (k - 255)) / 254) : 0)), faces, tested };
}

/** Where a place in the picture, in pixels, lies in the window; the whole picture is fit. */
async function placeOf(page, x, y) {
  const box = await page.locator(".viewport canvas").boundingBox();
  const scale = Math.min(box.width / width, box.height / height);
  return [box.x + (box.width - width * scale) / 2 + x * scale, box.y + (box.height - height * scale) / 2 + y * scale];
}

test("a signed difference has the color of its share of the scale, and the scale has numbers", async () => {
  const page = await openPictures("center_ray");
  const { data, mask, truth, tested } = await picturesOf(page, "center_ray");
  await choose(page, "difference");
  const { colors, scales } = data.signed;
  assert.deepEqual(scales, [1, 0.3, 0.1, 0.03]);
  const color = (share) => {
    const place = ((colors.length - 1) * (1 + Math.max(-1, Math.min(1, share)))) / 2,
      k = Math.min(Math.floor(place), colors.length - 2);
    return colors[k].map((c, axis) => c + (place - k) * (colors[k + 1][axis] - c));
  };
  const find = (low, high) => mask.findIndex((v, i) => tested(i) && v - truth[i] > low && v - truth[i] < high);
  const pixels = [find(-0.09, -0.05), find(0.05, 0.09), find(-0.7, -0.35), find(0.35, 0.7)];
  assert.ok(pixels.every((i) => i >= 0), String(pixels));
  for (const scale of scales) {
    await page.locator("select[name=scale]").selectOption(String(scale));
    for (const i of pixels) {
      const share = (mask[i] - truth[i]) / scale,
        shown = await colorAt(page, i % width, Math.floor(i / width));
      // The scene darkens small differences, by 36 of 255 at most where there is none.
      const room = 36 * (1 - Math.min(1, Math.abs(share))) + 2;
      color(share).forEach((c, axis) => assert.ok(c - shown[axis] < room && shown[axis] - c < 2, `${share}: ${shown}`));
    }
    const ticks = await page.locator("#pictures .ticks span").allTextContents();
    const half = String(Number((scale / 2).toPrecision(3)));
    assert.deepEqual(ticks, [`\u2212${scale}`, `\u2212${half}`, "0", `+${half}`, `+${scale}`]);
  }
  // What the legend says of it: the mean over tested pixels, which is the table's error but for the page's 12 bits.
  const off = mask.map((v, i) => v - truth[i]).filter((_, i) => tested(i));
  const mean = off.reduce((sum, d) => sum + Math.abs(d), 0) / off.length;
  const said = Number((await legendOf(page)).match(/mean size ([\d.]+)/)[1]);
  assert.ok(Math.abs(said - mean) < 0.03 * mean, `${said} ${mean}: two digits are said`);
  const error = data.rows[rowOf(data, "center_ray")].values[data.columns.findIndex(({ name }) => name === "error")];
  assert.ok(Math.abs(mean - error) < 0.00025, `${mean} ${error}`);
  // Against B the difference turns round when both are exchanged.
  await page.locator("#pictures select[name=a]").selectOption({ label: "reference" });
  await page.locator("#pictures select[name=b]").selectOption({ label: "center_ray" });
  await page.locator("select[name=scale]").selectOption("0.03");
  assert.deepEqual(await colorAt(page, pixels[2] % width, Math.floor(pixels[2] / width)), colors.at(-1));
  assert.deepEqual(page.troubles, []);
  await page.context().close();
});

test("contours run where masks cross their levels, over every picture", async () => {
  const page = await openPictures("area_rays:samples=16");
  const { data, mask, truth, faces } = await picturesOf(page, "area_rays:samples=16");
  const [half] = data.contours.levels.slice(1);
  assert.deepEqual(data.contours.levels, [0.02, 0.5, 0.98]);
  // Between two pixels of a row the values cross one half, in the rows above and below at nearly the same place.
  const crossing = (values, i) => {
    const [p, q] = [values[i], values[i + 1]];
    return p >= half !== q >= half && faces(i) && faces(i + 1) ? (i % width) + 0.5 + (half - p) / (q - p) : null;
  };
  const upright = (values, other) => {
    for (let i = width; i < (height - 1) * width - 1; ++i) {
      const all = [i - width, i, i + width].map((k) => crossing(values, k));
      const is_clear = other === null || [-2, -1, 0, 1, 2].every((k) => crossing(other, i + k) === null);
      if (all.every((x) => x !== null) && Math.max(...all) - Math.min(...all) < 0.4 && is_clear) return [all[1] - 0.5, Math.floor(i / width)];
    }
    return null;
  };
  const of_a = upright(mask, null);
  assert.ok(of_a, "there is an upright piece");
  const is_yellow = ([r, g, b]) => r > 190 && g > 150 && b < 120;
  for (const mode of ["wipe", "difference", "error", "causes", "classes"]) {
    await choose(page, mode);
    if (mode === "wipe") {
      await page.locator(".divider").focus();
      await page.keyboard.press("End"); // all of it is A
    }
    assert.ok(!is_yellow(await colorAt(page, ...of_a)), `${mode} without contours`);
    await check(page, "contours");
    assert.ok(is_yellow(await colorAt(page, ...of_a)), `${mode}: ${await colorAt(page, ...of_a)}`);
    const legend = await legendOf(page);
    assert.match(legend, /contours of reference.*contours of area_rays:samples=16.*V = 0.02.*V = 0.5.*V = 0.98/);
    if (mode === "error") await page.locator("#pictures").screenshot({ path: saved("contours.png") });
    await page.locator("#pictures .toggle", { hasText: "contours" }).locator("input").uncheck();
  }
  // The reference alone is black.
  await choose(page, "wipe");
  await check(page, "contours");
  await page.locator("#pictures select[name=a]").selectOption({ label: "reference" });
  await settled(page);
  const color = await colorAt(page, ...upright(truth, null));
  assert.ok(Math.max(...color) < 60, String(color));
  assert.doesNotMatch(await legendOf(page), /contours of area_rays/);
  assert.deepEqual(page.troubles, []);
  await page.context().close();
});

test("a profile shows the masks along the line that is drawn, with the reference's band", async () => {
  const page = await openPictures("area_rays:samples=4");
  const { mask, truth, errors } = await picturesOf(page, "area_rays:samples=4");
  await page.locator("#pictures select[name=b]").selectOption({ label: "center_ray" });
  const card = page.locator(".card.profile");
  assert.ok(!(await card.isVisible()));
  await check(page, "profile");
  await card.locator("figure svg").first().waitFor();
  const lead = () => card.locator(".lead").textContent();
  assert.match(await lead(), /^From pixel \d+, \d+ to \d+, \d+: [\d.]+ pixels\.$/, "a line is there from the start");
  await page.locator(".viewport canvas").scrollIntoViewIfNeeded();
  const drag = async (from, to) => {
    await page.mouse.move(...(await placeOf(page, ...from.map((c) => c + 0.5))));
    await page.mouse.down();
    await page.mouse.move(...(await placeOf(page, ...to.map((c) => c + 0.5))), { steps: 5 });
    await page.mouse.up();
  };
  await drag([30, 30], [120, 30]);
  assert.equal(await lead(), "From pixel 30, 30 to 120, 30: 90.0 pixels.");
  await drag([120, 30], [120, 70]); // its end; 90 and 40 are 98.5
  assert.equal(await lead(), "From pixel 30, 30 to 120, 70: 98.5 pixels.");
  // By keys: P puts the first end at the chosen pixel, then the second one.
  await page.locator(".viewport canvas").focus();
  await page.mouse.move(...(await placeOf(page, 40.5, 50.5)));
  await page.keyboard.press("p");
  for (let k = 0; k < 8; ++k) await page.keyboard.press("Shift+ArrowRight");
  await page.keyboard.press("p");
  assert.equal(await lead(), "From pixel 40, 50 to 120, 50: 80.0 pixels.");

  assert.match(await card.locator(".swatches").textContent(), /A {2}area_rays:samples=4.*B {2}center_ray.*reference.*95 % band/);
  assert.ok((await card.locator("figure svg g[data-mark=area] path").count()) > 0, "a band");
  const svg = card.locator("figure svg[role=img]");
  await svg.scrollIntoViewIfNeeded();
  const box = await svg.boundingBox();
  const number = (text) => Number(text.replace("\u2212", "-"));
  let differing = 0;
  for (const share of [0.2, 0.35, 0.5, 0.65, 0.8]) {
    await page.mouse.move(box.x + share * box.width, box.y + box.height / 2);
    await settled(page);
    const tip = await svg.locator("g[data-mark=tip]").textContent();
    const [, distance, x, y] = tip.match(/([\d.]+) pixels: (\d+), (\d+) \(/).map(Number);
    assert.equal(y, 50);
    assert.equal(distance, x - 40);
    const i = y * width + x;
    const a = tip.match(/A: ([\d.]+) \(([+\u2212][\d.]+)\)/),
      reference = tip.match(/reference: ([\d.]+) \u00b1 ([\d.]+)/);
    assert.equal(a[1].slice(0, 6), mask[i].toFixed(4));
    assert.ok(Math.abs(number(a[2].slice(0, 7)) - (mask[i] - truth[i])) < 6e-5, tip);
    assert.equal(reference[1].slice(0, 6), truth[i].toFixed(4));
    assert.ok(Math.abs(Number(reference[2].slice(0, 6)) - 1.96 * errors[i]) < 6e-5, `${tip} ${errors[i]}`);
    assert.equal((await readOut(page)).pixel, `${x}, ${y}`, "the read-out follows");
    differing += mask[i] !== truth[i];
  }
  assert.ok(differing > 0, "the line crosses the penumbra");
  await page.locator("select[name=profile]").selectOption("difference");
  assert.match(await card.textContent(), /share of the light, less the reference's/);
  assert.deepEqual(await accessFindings(page), []);
  assert.deepEqual(page.troubles, []);
  await page.locator("#pictures").screenshot({ path: saved("profile.png") });
  await page.locator("#pictures .toggle", { hasText: "profile" }).locator("input").uncheck();
  assert.ok(!(await card.isVisible()));
  await page.context().close();
});

test("under a light without area there is a profile without a band", async () => {
  const page = await openPictures("area_rays:samples=4");
  await page.locator("#pictures select[name=picture]").selectOption({ label: "card.toml \u00b7 bulb" });
  await check(page, "profile");
  const card = page.locator(".card.profile");
  await card.locator("figure svg").first().waitFor();
  assert.doesNotMatch(await card.textContent(), /95 %/);
  assert.match(await card.textContent(), /exact but for class U/);
  assert.equal(await card.locator("figure svg g[data-mark=area]").count(), 0);
  assert.deepEqual(page.troubles, []);
  await page.context().close();
});
