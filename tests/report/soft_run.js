// A run under a light with area and one without, by techniques of many samples and few.

import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";

import { gnomon, home, open, settled } from "./browser.js";

// From straight above a floor 8.284 m wide: a card 2 m wide and 1 m above it, a disc 4 m above it and a bulb at the same place.
export const scene = `
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
const run = join(home, "run");
export const report = join(run, "report.html");

export function makeSoftRun() {
  writeFileSync(join(home, "card.toml"), scene);
  writeFileSync(
    join(home, "soft.toml"),
    `
width = 160
height = 90
processes = 2
repetitions = 1
warmups = 1
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
techniques = ["area_rays:samples={4,16}", "area_rays:samples={4,16},pattern=random,seed={1,2,3}", "center_ray", "exact_area"]
`,
  );
  gnomon(["run", join(home, "soft.toml"), "--out", run, "--quiet"]);
  assert.equal(gnomon(["report", run]).trim(), report);
}

/** The number of a row. */
export const rowOf = (data, title, light = "lamp") =>
  data.rows.findIndex((row) => row.title === title && data.groups[row.group].light === light);

/** A page on the comparer, showing the lamp's shadow by `a`. */
export async function openPictures(a, { of = report, scene = "card.toml" } = {}) {
  const page = await open(of);
  const pictures = page.locator("#pictures");
  await pictures.scrollIntoViewIfNeeded();
  await pictures.locator("select[name=picture]").selectOption({ label: `${scene} \u00b7 lamp` });
  await pictures.locator("select[name=a]").selectOption({ label: a });
  await settled(page);
  return page;
}
