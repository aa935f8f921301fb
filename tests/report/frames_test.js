// The player of frames: rows on paths, their errors, and the course of a pixel in time.

import assert from "node:assert/strict";
import { existsSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";

import { bytesOf } from "./blobs.js";
import { accessFindings, closeBrowser, colorAt, dataOf, gnomon, here, home, open, openBrowser, screenshot, settled } from "./browser.js";

const [width, height] = [64, 36];
// Of slope.toml: 36 pixels see 8.284 m, so a meter is 4.346 pixels, and pixel 28 lies at x = (28.5 - 32) / 4.346 = -0.805. The
// light travels along (a, -1, 0) with a = 1, 0.8, 0.6, 0.4, so that the shadow of the card, whose right edge is at x = -1.5 and
// 1 m above the floor, ends at x = -0.5, -0.7, -0.9, -1.1: the pixel is dark in frames 0 and 1 and lit in 2 and 3.
const pixel = { x: 28, y: 18 };
const course = [0, 0, 1, 1];
// On the floor far from all casters, always lit.
const bare = { x: 40, y: 30 };

const run = join(home, "run"),
  report = join(run, "report.html"),
  slope = join(home, "slope.toml");
const path = `
[[path]]
name = "sweep"
moves = "light"
positions = [[1, -1, 0], [0.4, -1, 0]]
frames = 4
`;
const suite = `
width = ${width}
height = ${height}
processes = 1
repetitions = 1
warmups = 1
[[group]]
scenes = ["${slope}"]
paths = ["sweep"]
techniques = ["unshadowed", "embree_rays"]
[[group]]
scenes = ["${slope}"]
paths = ["camera_slide"]
techniques = ["embree_rays"]
[[group]]
scenes = ["${slope}"]
techniques = ["embree_rays"]
`;

before(async () => {
  writeFileSync(slope, readFileSync(join(here, "slope.toml"), "utf8") + path);
  writeFileSync(join(home, "moving.toml"), suite);
  gnomon(["run", join(home, "moving.toml"), "--out", run, "--quiet"]);
  assert.equal(gnomon(["report", run]).trim(), report);
  await openBrowser();
});
after(closeBrowser);

const recordsOf = (folder) =>
  readFileSync(join(folder, "records.jsonl"), "utf8")
    .trim()
    .split("\n")
    .map((line) => JSON.parse(line))
    .sort((a, b) => a.place - b.place);

/** A page on the player, showing the row of a technique on the path. */
async function openPlayer(technique, options = {}) {
  const page = await open(report, options);
  const player = page.locator(".player");
  await player.scrollIntoViewIfNeeded();
  const { rows } = await dataOf(page);
  const row = rows.findIndex((one) => one.technique === technique && one.path === "sweep");
  await player.locator("select[name=played]").selectOption(String(row));
  await settled(page);
  return { page, player };
}

const placeOf = (player) => player.locator("output").textContent();
const valuesOf = (player) => player.locator(".values").textContent();

/** Picks a pixel of the frame, the whole picture being fit. */
async function pick(page, { x, y }) {
  const canvas = page.locator(".screen canvas");
  await canvas.scrollIntoViewIfNeeded();
  const box = await canvas.boundingBox();
  const scale = Math.min(box.width / width, box.height / height);
  const left = (box.width - scale * width) / 2,
    top = (box.height - scale * height) / 2;
  await canvas.click({ position: { x: left + (x + 0.5) * scale, y: top + (y + 0.5) * scale } });
  await settled(page);
}

test("a run keeps a picture of each frame, those of the reference once, and none of a still", () => {
  const records = recordsOf(run);
  const on = (path) => records.filter((record) => record.path === path);
  const [first, second] = on("sweep").map((record) => record.kept_frames);
  assert.deepEqual([first.numbers, second.numbers], [course.map((_, k) => k), course.map((_, k) => k)]);
  assert.equal(first.reference, second.reference);
  assert.notEqual(first.mask, second.mask);
  const [slide] = on("camera_slide");
  assert.equal(slide.kept_frames.numbers.length, 16);
  assert.notEqual(slide.kept_frames.reference, first.reference);
  for (const { numbers, mask, reference } of [first, second, slide.kept_frames])
    for (const number of numbers)
      for (const folder of [mask, reference])
        assert.ok(existsSync(join(run, folder, `${String(number).padStart(4, "0")}.png`)), `${folder} ${number}`);
  assert.ok(!("kept_frames" in on("")[0]));
});

test("the page has the bytes of the frames, and the reference once", async () => {
  const page = await open(report);
  const { rows } = await dataOf(page);
  const [plain, rays] = ["unshadowed", "embree_rays"].map((name) =>
    rows.find((row) => row.technique === name && row.path === "sweep"),
  );
  assert.equal(plain.kept_frames.reference, rays.kept_frames.reference);
  assert.deepEqual([plain.kept_frames.start, plain.kept_frames.frame_rate], [null, 60]);
  assert.ok(rows.filter((row) => row.path === "").every((row) => !("kept_frames" in row)));
  const undone = (bytes, size) => {
    for (let i = size; i < bytes.length; ++i) bytes[i] = (bytes[i] + bytes[i - size]) & 255;
    return bytes;
  };
  const pixels = width * height,
    i = pixel.y * width + pixel.x;
  const reference = undone(await bytesOf(page, rays.kept_frames.reference), 2 * pixels);
  const mask = undone(await bytesOf(page, rays.kept_frames.mask), pixels);
  assert.equal(reference.length, 2 * pixels * course.length);
  course.forEach((share, k) => {
    assert.equal(reference[2 * k * pixels + i], 255 * share, `the reference in frame ${k}`);
    assert.equal(reference[(2 * k + 1) * pixels + i], 255, "the pixel is tested");
    assert.equal(mask[k * pixels + i], 255 * share, `the rays in frame ${k}`);
  });
  await page.context().close();
});

test("steps, scrubs and shows technique, reference and signed error", async () => {
  const { page, player } = await openPlayer("unshadowed");
  assert.equal(await placeOf(player), "frame 0");
  const shown = async (what) => {
    await player.locator("select[name=frames-of]").selectOption(what);
    return colorAt(page, pixel.x, pixel.y, "screen");
  };
  assert.deepEqual(await shown("mask"), [255, 255, 255]);
  assert.deepEqual(await shown("reference"), [0, 0, 0]);
  assert.deepEqual(await shown("difference"), [8, 45, 100], "technique lit, reference dark: the end of the scale");
  assert.match(await player.locator('ul[aria-label="Colors of the frame"]').textContent(), /A darker 0 px/);
  await screenshot(page, "frames");
  for (let k = 0; k < 2; ++k) await player.getByRole("button", { name: "One frame on" }).click();
  assert.equal(await placeOf(player), "frame 2");
  assert.deepEqual(await colorAt(page, pixel.x, pixel.y, "screen"), await colorAt(page, bare.x, bare.y, "screen"), "no error there");
  await player.locator('input[type="range"]').fill("1");
  assert.equal(await placeOf(player), "frame 1");
  assert.deepEqual(await colorAt(page, pixel.x, pixel.y, "screen"), [8, 45, 100]);
  assert.deepEqual(page.troubles, []);
  await page.context().close();
});

test("keys step, play and pause", async () => {
  const { page, player } = await openPlayer("unshadowed");
  await page.locator(".screen canvas").focus();
  const press = async (key) => {
    await page.keyboard.press(key);
    await settled(page);
    return placeOf(player);
  };
  assert.equal(await press("End"), "frame 3");
  assert.equal(await press("."), "frame 3", "there is none after the last");
  assert.equal(await press(","), "frame 2");
  assert.equal(await press("Home"), "frame 0");
  await player.locator("select[name=speed]").selectOption(String(1 / 16));
  await page.locator(".screen canvas").focus();
  await page.keyboard.press(" ");
  assert.equal(await player.locator(".play").textContent(), "Pause");
  const seen = new Set();
  for (const end = Date.now() + 60_000; seen.size < course.length && Date.now() < end; ) seen.add(await placeOf(player));
  assert.deepEqual([...seen].sort(), ["frame 0", "frame 1", "frame 2", "frame 3"], "it begins anew after the last");
  await page.keyboard.press(" ");
  assert.equal(await player.locator(".play").textContent(), "Play");
  const still = await placeOf(player);
  await settled(page);
  assert.equal(await placeOf(player), still);
  await page.context().close();
});

test("a picked pixel has its course in time", async () => {
  const { page, player } = await openPlayer("unshadowed");
  assert.ok(await player.locator(".course").isHidden());
  await pick(page, pixel);
  assert.equal(await valuesOf(player), "pixel 28, 18: technique 1.000, reference 0.000, tested");
  assert.match(await player.locator(".course .lead").textContent(), /^Pixel 28, 18, unshadowed/);
  assert.deepEqual(await player.locator('ul[aria-label="Lines of the course"] li').allTextContents(), [
    "technique, in steps of 1/255",
    "reference, in steps of 1/255",
  ]);
  // The reference's line is drawn first: heights of its points, of which the lit ones are above the dark ones.
  const heights = await player
    .locator('.course svg [data-mark="line"] path')
    .first()
    .evaluate((line) => [...line.getAttribute("d").matchAll(/[ML][\d.]+,([\d.]+)/g)].map((match) => Number(match[1])));
  assert.equal(heights.length, course.length);
  assert.deepEqual(heights.map((y) => y < (Math.min(...heights) + Math.max(...heights)) / 2), course.map((share) => share === 1));
  const mark = () => player.locator(".course .now").getAttribute("x1");
  const before = Number(await mark());
  await player.getByRole("button", { name: "One frame on" }).click();
  assert.ok(Number(await mark()) > before, "the mark goes with the frame");
  await page.locator(".screen canvas").focus();
  await page.mouse.move(0, 0);
  await pick(page, pixel);
  await page.keyboard.press("ArrowRight");
  await settled(page);
  assert.match(await player.locator(".course .lead").textContent(), /^Pixel 29, 18/);
  await screenshot(page, "course");
  assert.deepEqual(await accessFindings(page), []);
  assert.deepEqual(page.troubles, []);
  await page.context().close();
});

test("without kept frames the place says why", async () => {
  const bare = join(home, "masks");
  gnomon(["run", join(home, "moving.toml"), "--pictures", "masks", "--out", bare, "--quiet"]);
  assert.ok(!existsSync(join(bare, "frames")));
  const reasonOf = async (file) => {
    const page = await open(file);
    const text = await page.locator(".player .why-not").textContent();
    assert.ok(await page.locator(".screen").isHidden());
    assert.deepEqual(page.troubles, []);
    await page.context().close();
    return text;
  };
  const why = (reason) => `There are no frames to play: ${reason}.`;
  assert.equal(await reasonOf(gnomon(["report", bare]).trim()), why("they were not kept: the row was run with --pictures masks"));
  const small = join(home, "small.html");
  gnomon(["report", run, "--no-pictures", "--out", small]);
  assert.equal(await reasonOf(small), why("pictures were left out on demand"));
});

test("a run without paths has no player", async () => {
  const still = join(home, "still");
  const small = ["--size", `${width}x${height}`, "--processes", "1", "--repetitions", "1", "--warmups", "1", "--quiet"];
  gnomon(["run", "--scene", slope, "--light", "slanted", "--technique", "embree_rays", ...small, "--out", still]);
  const page = await open(gnomon(["report", still]).trim());
  assert.equal(await page.locator(".player").count(), 0);
  assert.doesNotMatch(await page.locator("#data").textContent(), /kept_frames/);
  await page.context().close();
});

test("merged shards keep the frames of every row", () => {
  const folders = [0, 1].map((k) => join(home, `shard${k}`));
  folders.forEach((folder, k) =>
    gnomon(["run", join(home, "moving.toml"), "--shard", `${k}/2`, "--out", folder, "--quiet"]),
  );
  const merged = join(home, "merged");
  gnomon(["merge", ...folders, "--out", merged]);
  const kept = (folder) => recordsOf(folder).map((record) => record.kept_frames);
  assert.deepEqual(kept(merged), kept(run));
  for (const frames of kept(merged).filter(Boolean))
    for (const folder of [frames.mask, frames.reference])
      for (const number of frames.numbers) {
        const name = join(folder, `${String(number).padStart(4, "0")}.png`);
        assert.deepEqual(readFileSync(join(merged, name)), readFileSync(join(run, name)), name);
      }
});
