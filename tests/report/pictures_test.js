// The image comparer, used as a person uses it.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import { choose as chooseMode, closeBrowser, colorAt, dataOf, open, openBrowser, readOut, screenshot, settled } from "./browser.js";
import { makeRun, report } from "./small_run.js";

// Of slope.toml, at 160 x 90: 90 pixels see 8.284 m, so a meter is 10.864 pixels. The shadow's middle, x = -1, is 10.9 pixels
// left of the middle 80; the pixel from 69 to 70 lies at x = -0.97, well inside. As far to the right nothing is in the way.
const shadow = { x: 69, y: 45 };
const lit = { x: 90, y: 45 };

before(async () => {
  assert.equal(makeRun().trim(), report);
  await openBrowser();
});
after(closeBrowser);

/** A page on the comparer, showing the slope by `a` and the reference. */
async function openPictures(a, options = {}) {
  const page = await open(report, options);
  const pictures = page.locator("#pictures");
  await pictures.scrollIntoViewIfNeeded();
  const group = await pictures.locator("select[name=picture] option", { hasText: "slope" }).first().getAttribute("value");
  await pictures.locator("select[name=picture]").selectOption(group);
  await pictures.locator("select[name=a]").selectOption({ label: a });
  await pictures.locator("select[name=b]").selectOption({ label: "reference" });
  await settled(page);
  return page;
}

/** Where a pixel of the picture lies in the window, the whole picture being fit. */
async function placeOf(page, { x, y }) {
  const canvas = page.locator(".viewport canvas");
  await canvas.scrollIntoViewIfNeeded();
  const box = await canvas.boundingBox();
  const scale = Math.min(box.width / 160, box.height / 90);
  return {
    x: box.x + (box.width - 160 * scale) / 2 + (x + 0.5) * scale,
    y: box.y + (box.height - 90 * scale) / 2 + (y + 0.5) * scale,
  };
}

test("wipes: what is left of the divider is A, right of it B", async () => {
  const page = await openPictures("unshadowed");
  const handle = page.locator(".divider span");
  await placeOf(page, shadow);
  const box = await handle.boundingBox(),
    canvas = await page.locator(".viewport canvas").boundingBox();
  const bright = (color) => color[0] + color[1] + color[2];
  const drag = async (share) => {
    const from = await handle.boundingBox();
    await page.mouse.move(from.x + from.width / 2, from.y + from.height / 2);
    await page.mouse.down();
    await page.mouse.move(canvas.x + share * canvas.width, from.y + from.height / 2, { steps: 4 });
    await page.mouse.up();
  };
  assert.ok(Math.abs(box.x + box.width / 2 - (canvas.x + canvas.width / 2)) < 2, "the divider starts in the middle");
  const as_a = await colorAt(page, shadow.x, shadow.y);
  await drag(0.2);
  const as_b = await colorAt(page, shadow.x, shadow.y);
  assert.ok(bright(as_a) > bright(as_b) + 150, `${as_a} is lit, ${as_b} in shadow`);
  await drag(0.8);
  assert.deepEqual(await colorAt(page, shadow.x, shadow.y), as_a);
  await page.locator(".divider").focus();
  await page.keyboard.press("Home");
  assert.deepEqual(await colorAt(page, shadow.x, shadow.y), as_b);
  await page.context().close();
});

test("zooms to a pixel and reads it out", async () => {
  const page = await openPictures("unshadowed");
  const at = await placeOf(page, shadow);
  await page.mouse.move(at.x, at.y);
  const wanted = {
    pixel: "69, 45",
    A: "1.00 wrong",
    B: "0.00",
    reference: "0.00",
    class: "T tested",
    "cause in A": "missing caster",
  };
  assert.deepEqual(await readOut(page), wanted);

  const zoom = async () => Number((await page.locator(".zoom").textContent()).replace(" %", ""));
  const fit = await zoom();
  await page.mouse.wheel(0, -240);
  await settled(page);
  assert.equal(await zoom(), fit, "the wheel is the page's until the picture has the focus");
  const again = await placeOf(page, shadow);
  await page.mouse.click(again.x, again.y);
  for (let k = 0; k < 5; ++k) await page.mouse.wheel(0, -120);
  await settled(page);
  assert.ok((await zoom()) > 3 * fit, "the wheel zooms");
  assert.equal((await readOut(page)).pixel, "69, 45", "what is under the pointer stays there");
  await screenshot(page, "zoomed");

  await page.keyboard.press("ArrowRight");
  assert.equal((await readOut(page)).pixel, "70, 45");
  await page.keyboard.press("Shift+ArrowRight");
  await page.keyboard.press("Shift+ArrowRight");
  assert.deepEqual(await readOut(page), {
    pixel: "90, 45",
    A: "1.00",
    B: "1.00",
    reference: "1.00",
    class: "T tested",
    "cause in A": "none",
  });

  const box = await page.locator(".viewport canvas").boundingBox();
  await page.mouse.move(box.x + 300, box.y + 200);
  const before = (await readOut(page)).pixel;
  await page.mouse.down();
  await page.mouse.move(box.x + 400, box.y + 200, { steps: 3 });
  await page.mouse.up();
  assert.equal((await readOut(page)).pixel, before, "dragging takes the picture along");
  await page.mouse.move(box.x + 300, box.y + 200);
  assert.notEqual((await readOut(page)).pixel, before, "and other pixels lie where it was");

  await page.locator("button", { hasText: "8:1" }).click();
  assert.equal(await zoom(), 800);
  await page.locator("button", { hasText: "Fit" }).click();
  assert.equal(await zoom(), fit);
  await page.context().close();
});

test("two fingers zoom", async () => {
  const page = await openPictures("unshadowed", { hasTouch: true });
  await placeOf(page, shadow);
  const box = await page.locator(".viewport canvas").boundingBox();
  const zoom = async () => Number((await page.locator(".zoom").textContent()).replace(" %", ""));
  const fit = await zoom();
  const session = await page.context().newCDPSession(page);
  const touch = (type, apart) =>
    session.send("Input.dispatchTouchEvent", {
      type,
      touchPoints:
        apart === null
          ? []
          : [-1, 1].map((side, id) => ({ x: box.x + box.width / 2 - 200 + side * apart, y: box.y + box.height / 2, id })),
    });
  await touch("touchStart", 30);
  for (const apart of [45, 60, 75, 90, 105, 120]) await touch("touchMove", apart);
  await touch("touchEnd", null);
  await settled(page);
  assert.ok((await zoom()) > 2 * fit, `${await zoom()} from ${fit}`);
  await page.context().close();
});

test("flicker, difference, causes and classes", async () => {
  const page = await openPictures("unshadowed");
  const choose = async (name) => {
    await chooseMode(page, name);
    await settled(page);
  };
  await choose("flicker");
  const first = await colorAt(page, shadow.x, shadow.y);
  await page.waitForTimeout(1000); // longer than a turn
  assert.deepEqual(await colorAt(page, shadow.x, shadow.y), first, "it rests when motion is not wanted");
  await page.locator("button", { hasText: "Swap" }).click();
  assert.notDeepEqual(await colorAt(page, shadow.x, shadow.y), first);
  await page.locator("button", { hasText: "Run" }).click();
  const seen = new Set();
  for (const end = Date.now() + 60_000; seen.size < 2 && Date.now() < end; ) seen.add(String(await colorAt(page, shadow.x, shadow.y)));
  for (let k = 0; k < 12; ++k) seen.add(String(await colorAt(page, shadow.x, shadow.y)));
  assert.equal(seen.size, 2);

  await choose("difference");
  assert.deepEqual(await colorAt(page, shadow.x, shadow.y), [8, 45, 100], "A lit, B dark: the end of the scale");
  assert.match(await page.locator("#pictures > .swatches").textContent(), /A darker 0 px/);
  await screenshot(page, "difference");

  await choose("causes");
  const { causes, rows, groups } = await dataOf(page);
  const missing = causes.find((cause) => cause.name === "missing_caster");
  assert.deepEqual(await colorAt(page, shadow.x, shadow.y), missing.color);
  const row = rows.find((r) => r.technique === "unshadowed" && groups[r.group].scene.includes("slope"));
  const wrong = row.causes.filter((count) => count > 0).length;
  assert.equal(await page.locator("#pictures > .swatches li").count(), wrong, "one entry for each cause that occurs");

  await choose("classes");
  const colors = [await colorAt(page, shadow.x, shadow.y), await colorAt(page, lit.x, lit.y)];
  assert.ok(
    colors.every(([r, g]) => g > r),
    "both are tested: green",
  );
  await screenshot(page, "classes");
  assert.deepEqual(page.troubles, []);
  await page.context().close();
});

test("a row's button opens its picture", async () => {
  const page = await open(report);
  const { rows } = await dataOf(page);
  const index = rows.findIndex((row) => row.pictures && row.title.includes("256") && row.light === "sun");
  await page.locator(`tr[data-row="${index}"] .picture`).click();
  assert.equal(await page.locator("#pictures select[name=a]").inputValue(), String(index));
  assert.equal(await page.locator("#pictures select[name=picture]").inputValue(), String(rows[index].group));
  await page.context().close();
});

test("up to four pictures beside one another zoom and choose pixels as one", async () => {
  const page = await openPictures("unshadowed");
  assert.equal(await page.locator(".further:visible").count(), 0);
  await chooseMode(page, "beside");
  assert.equal(await page.locator(".further:visible").count(), 1);
  for (const [name, title] of [["c", "planar_projected"], ["d", "shadow_map:resolution=64"]])
    await page.locator(`#pictures select[name=${name}]`).selectOption({ label: title });
  await settled(page);
  assert.equal(await page.locator(".further:visible").count(), 3);
  const labels = await page.locator("#pictures .labels:visible").allTextContents();
  assert.deepEqual(labels, ["A  unshadowed", "B  reference", "C  planar_projected", "D  shadow_map:resolution=64"]);
  // Zoomed with the keys of the third picture: all show the middle, eight times as large, and read the same pixel.
  const third = page.locator(".further canvas").nth(1);
  await third.focus();
  await page.keyboard.press("ArrowRight");
  for (let k = 0; k < 4; ++k) await page.keyboard.press("+");
  await settled(page);
  const [sizes, before] = [await page.locator(".zoom").textContent(), await page.locator(".readout").textContent()];
  assert.ok(Number.parseInt(sizes) > 500, sizes);
  assert.match(before, /C.*D.*reference/);
  const colors = await page.locator("#pictures .pictures canvas").evaluateAll((all) =>
    all.map((canvas) => [...canvas.getContext("2d").getImageData(canvas.width - 9, canvas.height - 9, 1, 1).data]),
  );
  assert.deepEqual(colors[0], colors[2], "lit in every picture");
  assert.deepEqual(page.troubles, []);
  await page.context().close();
});

test("a link shows the chosen pixel and the line of the profile", async () => {
  const page = await openPictures("shadow_map:resolution=64");
  await chooseMode(page, "beside");
  const profile = page.locator("#pictures .toggle", { hasText: "profile" }).locator("input");
  await profile.check();
  const canvas = page.locator(".viewport canvas");
  await canvas.focus();
  // The line from 60, 45 to 70, 45; the pixel 70, 45 is chosen, as the read-out says when the pointer has left, and outlined.
  await page.keyboard.press("ArrowRight"); // the middle, 80, 45
  for (const [times, key] of [[2, "Shift+ArrowLeft"], [1, "p"], [1, "Shift+ArrowRight"], [1, "p"], [6, "+"]])
    for (let k = 0; k < times; ++k) await page.keyboard.press(key);
  await page.locator("select[name=profile]").selectOption("difference");
  const parts = ["pixel=70-45", "line=60-45-70-45", "profile=difference"];
  await page.waitForFunction((parts) => parts.every((part) => location.hash.includes(part)), parts);
  await canvas.evaluate((element) => element.blur());
  await page.waitForTimeout(300); // longer than an address lags behind
  const again = await open(page.url().slice("file://".length));
  const seen = async (of) => {
    await of.locator(".card.profile svg[role=img]").waitFor();
    await settled(of);
    const canvases = of.locator("#pictures .pictures > div:not([hidden]) canvas");
    const pictures = await canvases.evaluateAll((all) => all.map((one) => one.toDataURL()));
    const paths = of.locator(".card.profile svg[role=img] [data-mark=line] path");
    const lines = await paths.evaluateAll((all) => all.map((line) => line.getAttribute("d")));
    return { pictures, lines, says: await readOut(of), lead: await of.locator(".card.profile .lead").textContent() };
  };
  const [there, here] = [await seen(page), await seen(again)];
  assert.equal(here.says.pixel, "70, 45");
  assert.equal(here.lead, "From pixel 60, 45 to 70, 45: 10.0 pixels.");
  assert.ok(here.pictures.length === 2 && here.lines.length > 0);
  assert.deepEqual(here, there);
  assert.deepEqual(again.troubles, []);
  await again.context().close();
  // Pixels outside the picture are left out.
  const wrong = await open(`${report}#?a=0&pixel=999-1&line=1-2-3&profile=x`);
  await settled(wrong);
  assert.equal((await readOut(wrong)).pixel, "-");
  assert.ok(await wrong.locator(".card.profile").isVisible());
  assert.deepEqual(wrong.troubles, []);
  await wrong.context().close();
  await profile.uncheck();
  await page.waitForFunction(() => !location.hash.includes("line="));
  await page.context().close();
});

test("a click keeps its pixel when the pointer leaves, another one lets it go", async () => {
  const page = await openPictures("shadow_map:resolution=64");
  const { x, y } = await placeOf(page, shadow);
  const leave = () => page.mouse.move(2, y);
  await page.mouse.move(x, y);
  assert.equal((await readOut(page)).pixel, "69, 45");
  await leave();
  assert.equal((await readOut(page)).pixel, "-");
  await page.mouse.click(x, y);
  await leave();
  assert.equal((await readOut(page)).pixel, "69, 45");
  await page.mouse.click(x, y);
  await leave();
  assert.equal((await readOut(page)).pixel, "-");
  await page.context().close();
});

test("a link shows what was seen", async () => {
  const page = await openPictures("shadow_map:resolution=64");
  await chooseMode(page, "causes");
  const canvas = page.locator(".viewport canvas");
  await canvas.focus();
  for (let k = 0; k < 3; ++k) await page.keyboard.press("+");
  await page.waitForFunction(() => location.hash.includes("mode=causes") && location.hash.includes("zoom="));
  await settled(page);
  const seen = (of) => of.locator(".viewport canvas").evaluate((canvas) => canvas.toDataURL());
  await page.waitForTimeout(300); // longer than an address lags behind
  const again = await open(page.url().slice("file://".length));
  await settled(again);
  assert.equal(await again.locator("#pictures select[name=a] option:checked").textContent(), "shadow_map:resolution=64");
  assert.ok(await again.locator(".modes input[value=causes]").isChecked());
  assert.equal(await seen(again), await seen(page));
  assert.deepEqual(again.troubles, []);
  await again.context().close();
  // What the run lacks is left out.
  const wrong = await open(`${report}#?a=9999&b=x&where=77&mode=none&zoom=-3&x=1&y=1`);
  await settled(wrong);
  assert.deepEqual(wrong.troubles, []);
  await wrong.context().close();
  await page.context().close();
});
