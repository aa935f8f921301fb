// A small run with rows of every kind: right, wrong, approximate, failed, on a path.

import { copyFileSync, cpSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

import { faults, gnomon, here, home } from "./browser.js";

export const run = join(home, "run");
export const report = join(run, "report.html");

const suite = `
width = 160
height = 90
processes = 2
repetitions = 1
warmups = 1
[[group]]
scenes = ["${join(home, "slope.toml")}"]
techniques = ["embree_rays", "unshadowed", "planar_projected", "throws", "shadow_map:resolution={64,256,1024}"]
[[group]]
scenes = ["fence"]
lights = ["point", "sun"]
techniques = ["embree_rays", "unshadowed", "planar_projected", "throws", "shadow_map:resolution={64,256,1024}"]
[[group]]
scenes = ["fence"]
lights = ["point"]
paths = ["camera_slide"]
techniques = ["shadow_map"]
`;

/** Makes the run and returns what `gnomon report` says of it. */
export function makeRun() {
  copyFileSync(join(here, "slope.toml"), join(home, "slope.toml"));
  writeFileSync(join(home, "small.toml"), suite);
  gnomon(["--plugin", faults, "run", join(home, "small.toml"), "--out", run, "--quiet"], { status: 1 });
  return gnomon(["report", run]);
}

/** A copy of the run whose records went through `change`, which returns one or a list. */
export function changedRun(name, change) {
  const dir = join(home, name);
  mkdirSync(dir);
  for (const folder of ["masks", "frames"]) cpSync(join(run, folder), join(dir, folder), { recursive: true });
  const records = readFileSync(join(run, "records.jsonl"), "utf8").trim().split("\n").map((line) => JSON.parse(line));
  writeFileSync(join(dir, "records.jsonl"), records.flatMap(change).map((record) => JSON.stringify(record) + "\n").join(""));
  return dir;
}
