// The table and the plots of a small run, used as a person uses them.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";

import { tick } from "../../harness/report/html/web/digits.js";
import { linesOf } from "../../harness/report/html/web/dom.js";
import { closeBrowser, dataOf, gnomon, open, openBrowser, saved, settled, shownRows } from "./browser.js";
import { changedRun, makeRun, report } from "./small_run.js";

before(async () => {
  assert.equal(makeRun().trim(), report);
  await openBrowser();
});
after(closeBrowser);

test("rows that were not measured say why", async () => {
  const page = await open(report);
  const failed = page.locator("tbody tr.failed").first();
  assert.match(await failed.locator(".reason").textContent(), /threw in build: the tree has no root/);
  const { rows } = await dataOf(page);
  const approximate = rows.findIndex((row) => row.support === "approximate");
  assert.ok(approximate >= 0);
  await page.locator(`tr[data-row="${approximate}"] .why summary`).click();
  assert.equal(await page.locator(`tr[data-row="${approximate}"] .why p`).textContent(), rows[approximate].reason);
  assert.ok(await page.locator(`tr[data-row="${approximate}"] .why p`).isVisible());
  await page.context().close();
});

test("sorts by a column: up, down, and back to the order of the run", async () => {
  const page = await open(report);
  const { rows, columns } = await dataOf(page);
  const index = columns.findIndex((column) => column.name === "wrong_rate");
  const header = page.locator('th[data-column="wrong_rate"]');
  const values = async () => (await shownRows(page)).map((row) => rows[row].values[index]);
  const unsorted = await shownRows(page);

  await header.locator("button").click();
  const up = await values(),
    known = up.filter((value) => value !== null);
  assert.equal(await header.getAttribute("aria-sort"), "ascending");
  assert.ok(known.length > 3 && new Set(known).size > 3);
  assert.deepEqual(
    known,
    [...known].sort((a, b) => a - b),
  );
  assert.ok(
    up.slice(known.length).every((value) => value === null),
    "rows without a value stand at the end",
  );

  await page.keyboard.press("Enter"); // the header keeps the focus
  const down = await values();
  assert.equal(await header.getAttribute("aria-sort"), "descending");
  assert.deepEqual(down.slice(0, known.length), [...known].reverse());
  assert.ok(down.slice(known.length).every((value) => value === null));

  await page.keyboard.press("Enter");
  assert.deepEqual(await shownRows(page), unsorted);
  await page.context().close();
});

test("filters by words and by lists, and the plots follow", async () => {
  const page = await open(report);
  const { rows } = await dataOf(page);
  await page.locator("#plots").scrollIntoViewIfNeeded();
  const bars = page.locator(".card.cost svg g[data-mark=bar] rect");
  await bars.first().waitFor();
  const before = await bars.count();

  await page.locator("input[type=search]").fill("fence 256");
  const wanted = rows.map((row, index) => [row, index]).filter(([row]) => row.scene === "fence" && row.title.includes("256"));
  assert.ok(wanted.length > 0);
  assert.deepEqual(
    await shownRows(page),
    wanted.map(([, index]) => index),
  );
  assert.match(await page.locator(".filters .count").textContent(), new RegExp(`^${wanted.length} of ${rows.length} rows`));

  await page.locator("button", { hasText: "Reset" }).click();
  assert.equal((await shownRows(page)).length, rows.length);
  for (const [key, value] of [
    ["scene", "fence"],
    ["light", "sun"],
    ["technique", "shadow_map"],
  ])
    await page.locator(`.filters select[name=${key}]`).selectOption(value);
  const matching = rows.filter((row) => row.scene === "fence" && row.light === "sun" && row.technique === "shadow_map");
  assert.equal((await shownRows(page)).length, matching.length);
  await page.locator("button", { hasText: "Reset" }).click();
  await page.locator(".filters select[name=technique]").selectOption("shadow_map");
  await page.locator(".card.cost").scrollIntoViewIfNeeded();  // a plot out of sight is drawn when it is seen
  await settled(page);
  assert.ok((await bars.count()) < before, "the cost plot shows fewer bars");

  await page.locator(".filters select[name=scene]").selectOption("fence");
  await settled(page);
  const places = await page.locator(".card.cost select[name=where] option").allTextContents();
  assert.ok(places.length > 0 && places.every((place) => place.startsWith("fence")), String(places));

  await page.locator("input[type=search]").fill("no such row");
  assert.match(await page.locator("#table tbody").textContent(), /No row passes/);
  await page.context().close();
});

test("columns can be chosen", async () => {
  const page = await open(report);
  assert.equal(await page.locator('th[data-column="class.T"]').count(), 0);
  await page.locator(".columns summary", { hasText: "Choose columns" }).click();
  await page.locator('.columns input[name="class.T"]').check();
  assert.equal(await page.locator('th[data-column="class.T"]').count(), 1);
  await page.locator('.columns input[name="technique"]').uncheck();
  assert.equal(await page.locator('th[data-column="technique"]').count(), 0);
  await page.context().close();
});

test("scene, light and technique stay in sight, and the error and its causes are in sight first", async () => {
  for (const width of [1400, 800, 420]) {
    const page = await open(report, { viewport: { width, height: 900 } });
    const names = await page.locator("thead th").evaluateAll((cells) => cells.map((cell) => cell.dataset.column));
    assert.deepEqual(names.slice(0, 5), ["scene", "light", "technique", "error", "causes"]);
    // Of the error all is in sight, of the bar of causes all on a desk, on a phone its beginning.
    const part = await page.locator("tbody .causes").first().evaluate((bar) => {
      const parts = [bar.closest(".scroll"), bar, bar.closest("tr").children[3]];
      const [scroll, causes, error] = parts.map((part) => part.getBoundingClientRect());
      const right = Math.min(scroll.right, innerWidth);
      return { error: right - error.right, causes: (right - causes.left) / causes.width };
    });
    assert.ok(part.error > 0, `${part.error} pixels are right of the error at ${width}`);
    assert.ok(part.causes > (width > 500 ? 1 : 0.3), `${part.causes} of the causes are in sight at ${width}`);
    const first = page.locator("tbody tr").first();
    const leftsOf = (row) => [...row.children].slice(0, 3).map((cell) => Math.round(cell.getBoundingClientRect().left));
    const lefts = () => first.evaluate(leftsOf);
    const before = await lefts();
    await page.locator("#table .scroll").evaluate((element) => (element.scrollLeft = element.scrollWidth));
    await settled(page);
    assert.deepEqual(await lefts(), before, `at ${width} pixels`);
    const room = await first.evaluate((row) => {
      const [scroll, last] = [row.closest(".scroll"), row.children[2]].map((part) => part.getBoundingClientRect());
      return scroll.right - last.right;
    });
    assert.ok(room > 100, `${room} pixels are left for numbers at ${width}`);
    await page.context().close();
  }
});

test("the filter finds causes, and an address keeps filter and order", async () => {
  const page = await open(report);
  const { rows, causes } = await dataOf(page);
  const cause = causes.findIndex((_, k) => rows.some((row) => row.causes?.[k] > 0));
  const wanted = rows.map((row, index) => [row, index]).filter(([row]) => row.causes?.[cause] > 0);
  assert.ok(wanted.length > 0 && wanted.length < rows.length);
  await page.locator("input[type=search]").fill(causes[cause].name);
  assert.deepEqual(await shownRows(page), wanted.map(([, index]) => index));
  await page.locator('th[data-column="error"] button').click();
  await page.waitForFunction(() => location.hash.includes("sort=error"));
  const again = await open(page.url().slice("file://".length));
  assert.deepEqual(await shownRows(again), await shownRows(page));
  assert.equal(await again.locator("input[type=search]").inputValue(), causes[cause].name);
  await again.context().close();

  // The table as text: a line of headings, then a line for each row that is shown.
  await page.locator(".as-text summary").click();
  const lines = (await page.locator(".as-text textarea").inputValue()).trimEnd().split("\n");
  assert.equal(lines.length, wanted.length + 1);
  assert.match(lines[0], /^scene\tlight\ttechnique\terror \(%\)\t/);
  assert.equal(new Set(lines.map((line) => line.split("\t").length)).size, 1);
  assert.deepEqual(page.troubles, []);
  await page.context().close();
});

test("plots by keyboard, and as files", async () => {
  const page = await open(report);
  await page.locator("#plots").scrollIntoViewIfNeeded();
  const plot = page.locator(".card.front figure svg[role=img]").last();
  await plot.waitFor();
  await plot.focus();
  const said = [];
  for (const key of ["ArrowRight", "ArrowRight", "End"]) {
    await page.keyboard.press(key);
    await settled(page);
    said.push(await page.locator(".card.front output").textContent());
  }
  assert.ok(said.every((text) => /error: .* %/.test(text)), String(said));
  assert.equal(new Set(said).size, 3, String(said));
  const [download] = await Promise.all([page.waitForEvent("download"), page.locator(".card.front .save").click()]);
  assert.equal(download.suggestedFilename(), "front.svg");
  const text = readFileSync(await download.path(), "utf8");
  assert.match(text, /<title>Error against cost, /);
  assert.ok(!text.includes("var("), "colors are those of the page");
  assert.match(text, />shadow_map</);
  assert.deepEqual(page.troubles, []);
  await page.context().close();
});

test("on a phone the settings of cost by stage are written out, in lines", async () => {
  assert.deepEqual(linesOf("shadow_map:resolution=256,filter=pcf", 19), ["shadow_map:", "resolution=256,", "filter=pcf"]);
  assert.deepEqual(linesOf("a:b=0123456789", 6), ["a:", "b=0123", "456789"]);
  const page = await open(report, { viewport: { width: 420, height: 900 } });
  await page.locator(".card.cost").scrollIntoViewIfNeeded();
  await settled(page);
  const place = Number(await page.locator(".card.cost select[name=where]").inputValue());
  const labels = page.locator('.card.cost [data-mark="y-axis tick label"] text');
  const lines = await labels.evaluateAll((all) =>
    all.map((label) => {
      const spans = [...label.querySelectorAll("tspan")];
      return (spans.length > 0 ? spans : [label]).map((part) => part.textContent);
    }),
  );
  const { rows } = await dataOf(page);
  const titles = rows.filter((row) => row.group === place && row.status === "ok").map((row) => row.title);
  assert.ok(titles.filter((title) => title.startsWith("shadow_map:")).length > 1, String(titles));
  assert.deepEqual(lines.map((parts) => parts.join("")).sort(), titles.sort());
  assert.ok(lines.some((parts) => parts.length > 1), String(lines));
  // No label runs into the next one, or out of the card.
  const boxes = await labels.evaluateAll((all) => all.map((label) => label.getBoundingClientRect().toJSON()));
  boxes.sort((p, q) => p.top - q.top);
  for (const [k, box] of boxes.entries())
    assert.ok(box.left >= 0 && (k === 0 || box.top >= boxes[k - 1].bottom - 1), `label ${k} from above`);
  await page.locator(".card.cost").screenshot({ path: saved("cost_phone.png") });
  await page.context().close();
});

test("no word breaks inside", async () => {
  for (const width of [1300, 390]) {
    const page = await open(report, { viewport: { width, height: 900 } });
    const broken = await page.locator("tbody td.text:not(.reason), tbody .id").evaluateAll((cells) => {
      const words = cells.flatMap((cell) => [...cell.childNodes].filter((node) => /^[^\s-]+$/.test(node.data ?? "")));
      const lines = (node) => {
        const range = document.createRange();
        range.selectNodeContents(node);
        return new Set([...range.getClientRects()].map((box) => Math.round(box.top))).size;
      };
      return [words.length, ...words.filter((node) => lines(node) > 1).map((node) => node.data)];
    });
    assert.ok(broken[0] > 20);
    assert.deepEqual(broken.slice(1), [], `at ${width} pixels`);
    await page.context().close();
  }
});

test("ticks say what they stand for", () => {
  const ticks = [0, 1.5e-7, 2e-7, 0.0015, 0.25, 12, 1.5e4, 2.5e6].map(tick);
  assert.deepEqual(ticks, ["0", "1.5e-7", "2e-7", "0.0015", "0.25", "12", "15 k", "2.5 M"]);
});

test("techniques that a plot shows differ in color, wherever in the run they are", async () => {
  // Sixteen techniques at one place; the filter lets the first and the ninth pass.
  const made = (record, k) => ({
    ...record,
    technique: `made_${k}`,
    label: `${k % 8 === 0 ? "kept" : "other"} ${k}`,
    job: k.toString(16).padStart(16, "0"),
    place: k,
  });
  const is_source = ({ scene, light, path, settings }) =>
    scene === "fence" && light === "point" && path === "" && settings === "resolution=64";
  const sixteen = (record) => (is_source(record) ? Array.from({ length: 16 }, (_, k) => made(record, k)) : []);
  const dir = changedRun("sixteen", sixteen);
  gnomon(["report", dir, "--no-pictures"]);
  const page = await open(join(dir, "report.html"));
  assert.equal((await shownRows(page)).length, 16);
  await page.locator("input[type=search]").fill("kept");
  await page.locator(".card.front").scrollIntoViewIfNeeded();
  await settled(page);
  const points = page.locator(".card.front svg g[data-mark=dot]").locator("path, circle");
  const colors = await points.evaluateAll((all) => all.map((point) => getComputedStyle(point).stroke));
  assert.equal(colors.length, 2);
  assert.notEqual(colors[0], colors[1]);
  assert.deepEqual(page.troubles, []);
  await page.context().close();
});

test("plots: a front that nothing beats, times by stage, growth, frames of the path", async () => {
  const page = await open(report);
  await page.locator("#plots").scrollIntoViewIfNeeded();
  for (const name of ["front", "cost", "scaling", "frames"]) await page.locator(`.card.${name} figure svg[role=img]`).waitFor();
  const front = page.locator(".card.front");
  const { rows, columns, groups } = await dataOf(page);
  const fence = groups.findIndex((group) => group.scene === "fence" && group.light === "point" && !group.path);
  await front.locator("select[name=where]").selectOption(String(fence));
  const measured = rows.filter((row) => row.group === fence && row.status === "ok" && row.costs.light);
  await settled(page);
  assert.equal(await front.locator("svg g[data-mark=dot] path, svg g[data-mark=dot] circle").count(), measured.length);
  // The front's line has a corner for every contender that no other beats in both, and one more between each two.
  const [error, constant] = ["error", "constant_error"].map((name) => columns.findIndex((column) => column.name === name));
  const points = measured
    .filter((row) => row.role === "contender" && row.values[error] < row.values[constant])
    .map((row) => ({ x: row.costs.light[0], y: row.values[error] }));
  const best = points.filter((p) => !points.some((q) => q !== p && q.x <= p.x && q.y <= p.y));
  const line = await front.locator("svg g[data-mark=line] path").getAttribute("d");
  assert.equal(line.split(/[MLHV]/).length - 2, 2 * (best.length - 1), line);

  const frames = rows.find((row) => row.path === "camera_slide" && row.status === "ok");
  const count = frames.frames.wrong_rate.length;
  await page.locator(".card.frames select[name=metric]").selectOption("wrong_rate");
  await settled(page);
  assert.equal(
    await page.locator(".card.frames svg g[data-mark=dot] path, .card.frames svg g[data-mark=dot] circle").count(),
    count,
  );
  assert.deepEqual(page.troubles, []);
  await page.locator("#plots").screenshot({ path: saved("plots.png") });
  await page.context().close();
});
