// Pictures of all light in the page: those of techniques that have one, and of the reference, where a run requested them.

import assert from "node:assert/strict";
import { join } from "node:path";
import { after, before, test } from "node:test";

import { closeBrowser, dataOf, gnomon, home, open, openBrowser, saved, settled } from "./browser.js";

const run = join(home, "run"),
  report = join(run, "report.html");

before(async () => {
  const rows = ["--scene", "cornell_box", "--light", "ceiling", "--view", "front", "--technique", "center_ray"];
  const radiosity = ["--technique", "radiosity:bounces=all,patch_size=0.2,levels=0"];
  const small = ["--processes", "1", "--repetitions", "1", "--warmups", "1", "--size", "80x80", "--global-samples", "64", "--quiet"];
  gnomon(["run", ...rows, ...radiosity, ...small, "--out", run]);
  assert.equal(gnomon(["report", run]).trim(), report);
  await openBrowser();
});
after(closeBrowser);

/** Mean color of what the view shows in a part of its width. */
const meanOf = (page, from, to) =>
  page.locator("#pictures canvas").first().evaluate(
    (canvas, [from, to]) => {
      const left = Math.round(from * canvas.width),
        { data } = canvas.getContext("2d").getImageData(left, 0, Math.round(to * canvas.width) - left, canvas.height);
      const sum = [0, 0, 0];
      for (let i = 0; i < data.length; i += 4) for (let c = 0; c < 3; ++c) sum[c] += data[i + c];
      return sum.map((value) => value / (data.length / 4));
    },
    [from, to],
  );

test("all light is shown where both have a picture of it, and else the shaded scene", async () => {
  const page = await open(report);
  const data = await dataOf(page);
  const withPicture = data.rows.filter((row) => row.pictures?.global !== undefined);
  assert.deepEqual(
    withPicture.map((row) => row.title),
    ["radiosity:patch_size=0.2,levels=0,bounces=all"],
  );
  const pictures = page.locator("#pictures");
  await pictures.scrollIntoViewIfNeeded();
  await pictures.locator("select[name=a]").selectOption({ label: withPicture[0].title });
  await settled(page);
  const left = [0.3, 0.49],
    right = [0.51, 0.7];
  const shaded = await meanOf(page, ...left);
  await pictures.getByText("all light", { exact: true }).click();
  await settled(page);
  const [a, b] = [await meanOf(page, ...left), await meanOf(page, ...right)];
  assert.ok(
    a.some((value, c) => Math.abs(value - shaded[c]) > 3),
    `${a} is as shaded: ${shaded}`,
  );
  // The room is nearly alike on both sides of the middle, and so are technique and reference.
  assert.ok(
    a.every((value, c) => Math.abs(value - b[c]) < 40),
    `${a} against ${b}`,
  );
  await pictures.getByText(`A  ${withPicture[0].title}, all light`).waitFor();
  await pictures.getByText("B  reference, all light").waitFor();
  await page.screenshot({ path: saved("global.png") });
  // A technique that has none is shown as ever.
  await pictures.locator("select[name=a]").selectOption({ label: "center_ray" });
  await settled(page);
  const hard = await meanOf(page, ...left);
  await pictures.getByText("all light", { exact: true }).click();
  await settled(page);
  assert.deepEqual(await meanOf(page, ...left), hard);
});

test("a run that did not ask for it has no such choice", async () => {
  const plain = join(home, "plain");
  const rows = ["--scene", "cornell_box", "--light", "ceiling", "--technique", "center_ray"];
  gnomon(["run", ...rows, "--processes", "1", "--repetitions", "1", "--warmups", "1", "--size", "40x40", "--quiet", "--out", plain]);
  gnomon(["report", plain]);
  const page = await open(join(plain, "report.html"));
  assert.equal(await page.locator("#pictures").getByText("all light").count(), 0);
});
