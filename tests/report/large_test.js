// A report of 2,000 rows, 200 of them with pictures of 640 x 360: below 30 MB, open in less than 30 loops: 3 s where a loop takes
// 0.1 s. Pictures of all rows would take a minute to make; the page reads a picture when it is shown.
//
// How fast the page is, is judged by the processor time of the browser. Its unit is a loop that the same browser runs just
// before and just after it. It takes about as long as the loop of tests/budget, and longer on a slow or busy machine. By the
// clock the page has four times as long, for other work: what waits for something other than the processor is found by that.

import assert from "node:assert/strict";
import { copyFileSync, mkdirSync, readFileSync, statSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";

import { closeBrowser, costOf, dataOf, gnomon, home, newPage, openBrowser, screenshot, shownRows } from "./browser.js";

const wanted_rows = 2000;
const pictured_rows = 200;
const drawn_rows = 300; // when the page opens
const run = join(home, "measured"),
  large = join(home, "large");
const suite = `
width = 640
height = 360
processes = 2
repetitions = 1
warmups = 1
[[group]]
scenes = ["fence", "contact", "box_city", "colonnade", "soup"]
lights = ["point", "sun"]
techniques = ["unshadowed", "embree_rays", "planar_projected", "shadow_map", "shadow_map:resolution=256"]
`;

before(async () => {
  writeFileSync(join(home, "measured.toml"), suite);
  gnomon(["run", join(home, "measured.toml"), "--out", run, "--quiet"]);
  multiply();
  await openBrowser();
});
after(closeBrowser);

/** The rows of the run again and again under other names, until there are enough; the first ones each with a mask of its own. */
function multiply() {
  mkdirSync(join(large, "masks"), { recursive: true });
  const measured = readFileSync(join(run, "records.jsonl"), "utf8")
    .trim()
    .split("\n")
    .map((line) => JSON.parse(line));
  const rows = [];
  for (let k = 0; k < wanted_rows; ++k) {
    const source = measured[k % measured.length],
      copy = Math.floor(k / measured.length);
    const row = {
      ...source,
      place: k,
      job: k.toString(16).padStart(16, "0"),
      label: copy ? `${source.label ?? source.technique} ${copy}` : source.label,
    };
    if (k >= pictured_rows) row.mask = null;
    if (row.mask) {
      row.mask = `masks/${k}.exr`;
      copyFileSync(join(run, source.mask), join(large, row.mask));
    }
    rows.push(row);
  }
  writeFileSync(join(large, "records.jsonl"), rows.map((row) => JSON.stringify(row) + "\n").join(""));
}

test("2,000 rows, 200 of them with pictures: small and quick", async () => {
  const start = Date.now();
  const file = gnomon(["report", large]).trim();
  const made = Date.now() - start,
    size = statSync(file).size;

  console.log(`# ${(size / 1e6).toFixed(1)} MB, made in ${made} ms`);
  assert.ok(size < 30e6, `${size} bytes`);

  /** Demands that the work takes less than so many loops. */
  const takesLessThan = async (most, what, work) => {
    const { processor, clock, loop } = await costOf(work);
    const loops = `${(processor / loop).toFixed(1)} loops of ${loop.toFixed(0)} ms`;
    const words = `${what}: ${processor.toFixed(0)} ms of processor time, ${loops}; ${clock} ms by the clock`;
    console.log(`# ${words}`);
    const wanted = `${most} loops (${(most * loop).toFixed(0)} ms) are wanted, by the clock four times as long`;
    assert.ok(processor < most * loop && clock < 4 * most * loop, `${words}, where ${wanted}`);
  };
  const page = await newPage();
  await takesLessThan(30, "opening", async () => {
    await page.goto(`file://${file}`, { waitUntil: "load" });
    assert.equal((await shownRows(page)).length, drawn_rows);
  });

  const { rows } = await dataOf(page);
  assert.equal(rows.length, wanted_rows);
  assert.ok(rows.filter((row) => row.pictures).length > 0.8 * pictured_rows);
  await takesLessThan(15, "sorting", () => page.locator('th[data-column="resolve_ms"] button').click());
  const last = (await shownRows(page)).findLast((row) => rows[row].pictures);
  await takesLessThan(20, "a picture", async () => {
    await page.locator(`tr[data-row="${last}"] .picture`).click();
    await page.waitForFunction((name) => document.querySelector(".labels")?.textContent.includes(name), rows[last].title);
  });
  assert.deepEqual(page.troubles, []);
  await screenshot(page, "large");
  await page.context().close();
});
