// The page of a small run as a whole: what it may do, where it can be read, what it says when something is not there.

import assert from "node:assert/strict";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";

import {
  accessFindings,
  closeBrowser,
  dataOf,
  gnomon,
  home,
  open,
  openBrowser,
  saved,
  screenshot,
  settled,
  shownRows,
} from "./browser.js";
import { contrast, distance } from "./sight.js";
import { changedRun, makeRun, report, run } from "./small_run.js";

before(async () => {
  assert.equal(makeRun().trim(), report);
  await openBrowser();
});
after(closeBrowser);

test("loads without requests, messages or errors and shows every row", async () => {
  const page = await open(report);
  const { rows } = await dataOf(page);
  assert.equal(rows.length, readFileSync(join(run, "records.jsonl"), "utf8").trim().split("\n").length);
  assert.deepEqual(
    await shownRows(page),
    rows.map((_, index) => index),
  );
  for (const id of ["plots", "ranks", "pictures", "about"]) {
    await page.locator(`#${id}`).scrollIntoViewIfNeeded();
    await settled(page);
  }
  assert.deepEqual(page.troubles, []);
  await screenshot(page, "whole", { fullPage: true });
  await page.context().close();
});

test("readable in light and dark, for people and for machines that read to them", async () => {
  const shade = {};
  for (const colorScheme of ["light", "dark"]) {
    const page = await open(report, { colorScheme });
    for (const id of ["plots", "ranks", "pictures", "about"]) {
      await page.locator(`#${id}`).scrollIntoViewIfNeeded();
      await settled(page);
    }
    await page.locator("#about details").evaluateAll((all) => all.forEach((details) => (details.open = true)));
    shade[colorScheme] = await page.evaluate(() =>
      getComputedStyle(document.body)
        .backgroundColor.match(/\d+/g)
        .slice(0, 3)
        .reduce((sum, c) => sum + Number(c), 0),
    );
    assert.deepEqual(await accessFindings(page), []);
    await page.evaluate(() => scrollTo(0, 0));
    await screenshot(page, colorScheme, { fullPage: true });
    await page.context().close();
  }
  assert.ok(shade.light > 650 && shade.dark < 120, JSON.stringify(shade));
});

test("every two colors of plots are told apart by any eyes, on light and on dark ground", async () => {
  // Black and white are 100 apart, this red and this green less than 20 without green cones; by the WCAG black on white is 21.
  assert.ok(Math.abs(distance("#000000", "#ffffff") - 100) < 0.1 && distance("#c04040", "#6f7d00") < 20);
  assert.equal(contrast("#000000", "#ffffff").toFixed(3), "21.000");
  for (const colorScheme of ["light", "dark"]) {
    const page = await open(report, { colorScheme });
    const valuesOf = (names) =>
      page.evaluate((names) => {
        const style = getComputedStyle(document.documentElement);
        return names.map((name) => style.getPropertyValue(`--${name}`).trim());
      }, names);
    const series = await valuesOf(Array.from({ length: 8 }, (_, k) => `series-${k}`));
    const stages = await valuesOf(["setup", "build", "update", "relight", "resolve"].map((stage) => `stage-${stage}`));
    const [surface, ink] = await valuesOf(["surface", "ink"]);
    const all = [...series, surface, ink];
    assert.ok(all.every((color) => /^#[0-9a-f]{6}$/.test(color)), String(all));
    for (const [k, a] of all.entries())
      for (const b of all.slice(0, k)) assert.ok(distance(a, b) >= 20, `${a} ${b}: ${distance(a, b)} apart, ${colorScheme}`);
    assert.equal(new Set(stages).size, stages.length);
    assert.ok(stages.every((color) => series.includes(color)), String(stages));
    // On paper's white the colors are those of figures, where yellow is told by its hue.
    if (colorScheme === "dark")
      for (const color of series) assert.ok(contrast(color, surface) >= 3, `${color} on ${surface}: ${contrast(color, surface)}`);
    await page.context().close();
  }
});

test("in windows of any width nothing hangs over the side, and nothing is said on the console", async () => {
  for (const width of [1400, 800, 420]) {
    const page = await open(report, { viewport: { width, height: 900 } });
    for (const id of ["table", "plots", "ranks", "pictures", "about"]) {
      await page.locator(`#${id}`).scrollIntoViewIfNeeded();
      await settled(page);
      assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), width, id);
    }
    assert.deepEqual(page.troubles, [], `at ${width} pixels`);
    await page.evaluate(() => scrollTo(0, 0));
    await screenshot(page, `width_${width}`, { fullPage: true });
    await page.context().close();
  }
});

test("on a phone nothing hangs over the side", async () => {
  const page = await open(report, {
    viewport: { width: 360, height: 740 },
    deviceScaleFactor: 2,
    hasTouch: true,
    isMobile: true,
  });
  for (const id of ["table", "plots", "ranks", "pictures", "about"]) {
    await page.locator(`#${id}`).scrollIntoViewIfNeeded();
    await settled(page);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 360, id);
  }
  await page.evaluate(() => scrollTo(0, 0));
  await screenshot(page, "phone", { fullPage: true });
  await page.context().close();
});

test("on paper: light, whole tables, nothing to click", async () => {
  const page = await open(report, { colorScheme: "dark" });
  await page.emulateMedia({ media: "print", colorScheme: "dark" });
  assert.equal(await page.evaluate(() => getComputedStyle(document.body).backgroundColor), "rgb(255, 255, 255)");
  for (const selector of ["nav", ".filters", ".columns"])
    assert.ok(!(await page.locator(selector).first().isVisible()), selector);
  assert.equal(await page.locator("#table .scroll").evaluate((box) => getComputedStyle(box).overflow), "visible");
  const paper = await page.pdf({ path: saved("paper.pdf"), preferCSSPageSize: true });
  assert.ok(paper.length > 10000);
  await page.context().close();
});

test("text of records stays text", async () => {
  const evil = '</script><script>window.broken = 1</script><img src=x onerror="window.broken = 2">';
  const dir = changedRun("evil", (record) => ({ ...record, label: evil, suite: evil, reason: record.reason && evil }));
  gnomon(["report", dir, "--no-pictures"]);
  const page = await open(join(dir, "report.html"));
  assert.equal(await page.evaluate(() => window.broken), undefined);
  assert.equal(await page.locator("h1").textContent(), evil);
  assert.equal(await page.locator("tbody .id").first().textContent(), evil);
  assert.deepEqual(page.troubles, []);
  await page.context().close();
});

test("contenders are compared in pairs, and that three places are too few is said", async () => {
  const page = await open(report);
  const { ranks } = await dataOf(page);
  const section = page.locator("#ranks");
  assert.equal(
    await section.locator("tbody tr").count(),
    ranks.groups.reduce((sum, group) => sum + 1 + group.rows.length, 0),
  );
  const headings = await section.locator("thead th").allTextContents();
  assert.deepEqual(headings.slice(0, 4), ["technique", "against", "ratio", "verdict"]);
  assert.deepEqual([...headings].sort(), ranks.columns.map((column) => column.heading).sort());
  const texts = await section.locator("tbody tr:not(.title)").first().locator("td").allTextContents();
  const cells = texts.map((text, k) => [headings[k], text]);
  const [first] = ranks.groups[0].rows;
  assert.deepEqual(Object.fromEntries(cells), Object.fromEntries(first.map((text, k) => [ranks.columns[k].heading, text])));
  // On a phone the first four are in sight.
  await page.setViewportSize({ width: 420, height: 900 });
  await settled(page);
  const room = await section.locator("tbody tr:not(.title)").first().evaluate((row) => {
    const right = row.closest(".scroll").getBoundingClientRect().right;
    return Math.min(right, innerWidth) - row.children[3].getBoundingClientRect().right;
  });
  assert.ok(room >= 0, `the verdict ends ${-room} pixels right of the window`);
  const text = await section.textContent();
  assert.match(text, /by error/);
  assert.match(text, /too few places, \d+ needed/);
  assert.match(text, /left out of pairs: fence, point.*path camera_slide/);
  await page.context().close();

  const dir = changedRun("alone", (record) => ({ ...record, role: "baseline" }));
  gnomon(["report", dir, "--no-pictures"]);
  const other = await open(join(dir, "report.html"));
  assert.equal(await other.locator("#ranks").count(), 0);
  assert.equal(await other.locator('nav a[href="#ranks"]').count(), 0);
  assert.deepEqual(other.troubles, []);
  await other.context().close();
});

test("pictures of another scene than the one measured are left out, and the page says so", async () => {
  const dir = changedRun("other", (record) =>
    record.scene === "fence" ? { ...record, context: { ...record.context, scene_hash: "0" } } : record,
  );
  gnomon(["report", dir]);
  const page = await open(join(dir, "report.html"));
  const { groups, notes } = await dataOf(page);
  assert.deepEqual(
    groups.map((group) => group.pictures !== null),
    groups.map((group) => group.scene !== "fence"),
  );
  assert.equal(notes.length, 1);
  assert.match(notes[0], /fence: the scene is not the one that was measured/);
  assert.match(await page.locator("#about").textContent(), /not the one that was measured/);
  await page.context().close();
});

test("causes of other references than the one shown are left out, and the page says so", async () => {
  const dir = changedRun("older", (record) =>
    record.scene === "fence" ? { ...record, context: { ...record.context, frames: 1 } } : record,
  );
  gnomon(["report", dir]);
  const page = await open(join(dir, "report.html"));
  const { rows, notes } = await dataOf(page);
  const explained = rows.filter((row) => row.pictures && row.causes);
  assert.ok(explained.some((row) => row.scene === "fence") && explained.some((row) => row.scene !== "fence"));
  for (const row of explained) assert.equal(row.pictures.causes === null, row.scene === "fence", row.title);
  assert.equal(notes.length, 1, notes.join("\n"));
  assert.match(notes[0], /no causes of scene fence: they were found on references of version 1/);
  await page.context().close();
});

test("without pictures the page is small and says so", async () => {
  const out = join(home, "small.html");
  gnomon(["report", run, "--no-pictures", "--out", out]);
  const size = readFileSync(out).length;
  assert.ok(size < readFileSync(report).length && size < 1e6, String(size));
  const page = await open(out);
  assert.match(await page.locator("#pictures").textContent(), /no pictures to compare/);
  assert.equal(await page.locator(".picture").count(), 0);
  assert.deepEqual(page.troubles, []);
  await page.context().close();
});

test("bad calls are refused", () => {
  assert.match(gnomon(["report", join(home, "nowhere")], { status: 2 }).stderr, /nowhere/);
  assert.match(gnomon(["report", run, "--out", home], { status: 2 }).stderr, /is a folder/);
  mkdirSync(join(home, "empty"));
  writeFileSync(join(home, "empty", "records.jsonl"), "");
  assert.match(gnomon(["report", join(home, "empty")], { status: 2 }).stderr, /no records/);
});
