// Rows of several lights in the page: all together, and each alone.

import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";

import { sharesOf } from "./blobs.js";
import { choose, closeBrowser, dataOf, gnomon, home, open, openBrowser, saved, settled } from "./browser.js";

// A card over a floor between two lamps of equal strength at the same height: left of the middle the left one gives more.
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
name = "left"
kind = "point"
position = [-3, 4, 0]
[[light]]
name = "right"
kind = "disc"
center = [3, 4, 0]
normal = [0, -1, 0]
radius = 0.3
[[view]]
name = "above"
eye = [0, 6, 6]
target = [0, 0.3, 0]
`;
const run = join(home, "run"),
  report = join(run, "report.html");

before(async () => {
  writeFileSync(join(home, "lamps.toml"), scene);
  const rows = ["--scene", join(home, "lamps.toml"), "--light", "all+,left", "--technique", "shadow_map:resolution=64"];
  const small = ["--processes", "1", "--repetitions", "1", "--warmups", "1", "--size", "160x90", "--quiet"];
  gnomon(["run", ...rows, "--technique", "unshadowed", ...small, "--out", run]);
  assert.equal(gnomon(["report", run]).trim(), report);
  await openBrowser();
});
after(closeBrowser);

test("the pictures of several lights are all together, and each alone", async () => {
  const page = await open(report);
  const data = await dataOf(page);
  const pictures = page.locator("#pictures");
  await pictures.scrollIntoViewIfNeeded();
  const choices = await pictures.locator("select[name=picture] option").allTextContents();
  assert.deepEqual(choices, [
    "lamps.toml \u00b7 all+",
    "lamps.toml \u00b7 all+: left alone",
    "lamps.toml \u00b7 all+: right alone",
    "lamps.toml \u00b7 left",
  ]);
  const row = data.rows.findIndex((one) => one.title === "unshadowed" && data.groups[one.group].light === "all+");
  const group = data.groups[data.rows[row].group];
  assert.equal(group.answer, "received");
  const { pictures: all } = group;
  assert.deepEqual(
    all.lights.map((light) => [light.name, light.is_fraction]),
    [
      ["left", false],
      ["right", true],
    ],
  );
  // Of two lamps what is left in a shadow of one is between nothing and all.
  const together = await sharesOf(page, all.reference, all.bits);
  assert.ok(together.some((share) => share > 0.2 && share < 0.8));
  for (const label of choices) {
    await pictures.locator("select[name=picture]").selectOption({ label });
    for (const mode of ["error", "causes", "classes", "difference", "wipe"])
      await choose(page, mode);
    await settled(page);
    assert.equal(await pictures.locator(".notice:visible").count(), 0, label);
  }
  assert.deepEqual(page.troubles, []);
  await pictures.screenshot({ path: saved("lights.png") });
  await page.context().close();
});

test("the legend says the error of all together, and none of one light's", async () => {
  const page = await open(report);
  const pictures = page.locator("#pictures");
  await pictures.locator("select[name=picture]").selectOption({ label: "lamps.toml \u00b7 all+" });
  await pictures.locator("select[name=a]").selectOption({ label: "unshadowed" });
  await settled(page); // the modes of the picture that was chosen are there
  await choose(page, "error");
  await settled(page);
  const legend = pictures.locator('ul[aria-label="Colors of the picture"]');
  await legend.filter({ hasText: /error [\d.]+ %, floor [\d.]+ %/ }).waitFor();
  await pictures.locator("select[name=picture]").selectOption({ label: "lamps.toml \u00b7 all+: left alone" });
  await legend.filter({ hasText: /false lit/ }).filter({ hasNotText: /error [\d.]+ %, floor/ }).waitFor();
  assert.deepEqual(page.troubles, []);
  await page.context().close();
});

test("the table keeps several lights apart by their own columns", async () => {
  const page = await open(report);
  const data = await dataOf(page);
  const column = (name) => data.columns.findIndex((info) => info.name === name);
  const of = (light) => data.rows.find((row) => row.title.startsWith("shadow_map") && data.groups[row.group].light === light);
  assert.equal(of("all+").values[column("light_count")], 2);
  assert.equal(of("all+").support, "approximate");
  assert.match(of("all+").reason, /no shadows of right/);
  assert.ok(of("all+").values[column("light_error_max")] > 0);
  assert.equal(of("left").values[column("light_error_max")], null);
  assert.deepEqual(page.troubles, []);
  await page.context().close();
});
