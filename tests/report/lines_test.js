// What the page computes without a browser: lines of one value, and lines of pixels.

import assert from "node:assert/strict";
import { test } from "node:test";

import { isolines } from "../../harness/report/html/web/isolines.js";
import { pixelsOn, suggestedLine } from "../../harness/report/html/web/line_pixels.js";

const everywhere = () => true;
const nearly = (points, wanted) => {
  assert.equal(points.length, wanted.length, JSON.stringify(points));
  points.forEach((point, k) => point.forEach((c, axis) => assert.ok(Math.abs(c - wanted[k][axis]) < 1e-6, JSON.stringify(points))));
};

test("a ramp's line lies where the ramp has the value, through all rows", () => {
  // V = x / 4 at centers x + 0.5: 0.3 is reached at x = 1.2 after the first center.
  const size = { width: 5, height: 3 },
    mask = Array.from({ length: 15 }, (_, i) => (i % 5) / 4);
  const lines = isolines(size, mask, 0.3, everywhere);
  assert.equal(lines.length, 1);
  const [line] = lines;
  nearly(line[0][1] < line[2][1] ? line : line.reverse(), [
    [1.7, 0.5],
    [1.7, 1.5],
    [1.7, 2.5],
  ]);
});

test("one lit pixel has a closed line half way to its neighbors", () => {
  const size = { width: 3, height: 3 },
    mask = [0, 0, 0, 0, 1, 0, 0, 0, 0];
  const lines = isolines(size, mask, 0.25, everywhere);
  assert.equal(lines.length, 1);
  assert.deepEqual(lines[0][0], lines[0].at(-1), "it ends where it begins");
  // From 0 to 1 the value 1/4 is a quarter of the way from each neighbor's center, 3/4 from the middle one's at 1.5.
  const places = lines[0].slice(1).map(String).sort();
  assert.deepEqual(places, ["0.75,1.5", "1.5,0.75", "1.5,2.25", "2.25,1.5"]);
});

test("in a cell with two crossings the mean says what hangs together", () => {
  const size = { width: 2, height: 2 };
  // Upper left and lower right are lit. Mean 0.5: above 0.4 both are one, and lines cut off the dark corners, at 0.4 from each
  // dark center; at 0.6 each is alone, cut off at 0.4 from its own.
  const corners = (level) => {
    const lines = isolines(size, [1, 0, 0, 1], level, everywhere);
    assert.equal(lines.length, 2);
    return lines.map((line) => (line.some(([x, y]) => y === 0.5) && line.some(([x]) => x === 0.5) ? "upper left" : "other"));
  };
  assert.ok(!corners(0.4).includes("upper left"));
  assert.ok(corners(0.6).includes("upper left"));
});

test("no line runs through pixels that are not shown", () => {
  const size = { width: 5, height: 3 },
    mask = Array.from({ length: 15 }, (_, i) => (i % 5) / 4);
  const lines = isolines(size, mask, 0.3, (i) => i >= 5); // not the first row
  assert.equal(lines.length, 1);
  assert.deepEqual(lines[0].map(([, y]) => y).sort(), [1.5, 2.5]);
});

test("a line of pixels has one for each step along its longer side, and distances in pixels", () => {
  // 6 to the right and 8 down are 10 pixels: nine pixels 1.25 apart.
  const samples = pixelsOn(
    [
      { x: 1, y: 2 },
      { x: 7, y: 10 },
    ],
    20,
  );
  assert.deepEqual(
    samples.map(({ y }) => y),
    [2, 3, 4, 5, 6, 7, 8, 9, 10],
  );
  assert.deepEqual(
    samples.map(({ distance }) => distance),
    [0, 1.25, 2.5, 3.75, 5, 6.25, 7.5, 8.75, 10],
  );
  assert.deepEqual([samples[4].x, samples[4].i], [4, 6 * 20 + 4]);
  const point = { x: 3, y: 3 };
  assert.deepEqual(pixelsOn([point, point], 20), [{ ...point, i: 63, distance: 0 }]);
});

test("the line that is suggested runs where much happens", () => {
  const width = 50,
    mask = new Float32Array(50 * 4).fill(1);
  mask.fill(0, 2 * width + 20, 2 * width + 30); // in the third row a shadow from 20 to 29: changes at 20 and at 30
  mask.fill(0, width + 40, 2 * width); // in the second one change
  const size = { width, height: 4 };
  // 6 % of the width, 3 pixels, on each side.
  assert.deepEqual(suggestedLine(size, mask, everywhere), [
    { x: 17, y: 2 },
    { x: 33, y: 2 },
  ]);
  const [from, to] = suggestedLine(size, new Float32Array(200).fill(1), everywhere);
  assert.ok(from.x < to.x && from.y === to.y && to.x < width, "where nothing happens, too, there is a line");
});
