// Pictures from masks: what the comparer shows, as ImageData. A frame is {width, height, is_soft, lit, dark, classes}, a side what
// is compared: {mask, reference, causes}; `reference` is what its mask is judged by.

import { data } from "./data.js";

const tested = data.classes.findIndex((info) => info.name === "T");
const firstFacing = data.classes.findIndex((info) => info.name === "G");

/** Signed differences: the first picture darker, lighter (Okabe and Ito: apart for color-blind readers). */
export const darker = [213, 94, 0];
export const lighter = [86, 180, 233];

const linear = Float32Array.from({ length: 256 }, (_, value) => {
  const x = value / 255;
  return x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4;
});
const srgb = (x) => 255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);

/** Whether a side is wrong there: off by more than one half, and the pixel faces the light. */
export const isWrong = (frame, side, i) =>
  frame.classes[i] >= firstFacing && Math.abs(side.mask[i] - side.reference[i]) > 127.5;

/** How strong the color of a difference of 8 bits is, 0 .. 1: under a light with area by its size, in steps. */
const steps = data.error_steps;
const strengths = Float32Array.from({ length: 256 }, (_, difference) =>
  steps.reduce((weight, [least, stronger]) => (difference / 255 >= least ? stronger : weight), 0),
);

/** The colors of the steps over gray, [least, color] each. */
export const scaleOf = (color) => steps.map(([least, weight]) => [least, color.map((c) => 128 + weight * (c - 128))]);

const mix = (color, over, weight) => over.forEach((value, c) => (color[c] += weight * (value - color[c])));

function painted({ width, height }, paint) {
  const image = new ImageData(width, height);
  const color = [0, 0, 0];
  for (let i = 0; i < width * height; ++i) {
    paint(i, color);
    image.data[4 * i] = color[0];
    image.data[4 * i + 1] = color[1];
    image.data[4 * i + 2] = color[2];
    image.data[4 * i + 3] = 255;
  }
  return image;
}

/** The scene under this mask: exact at 0 and 1, mixed in linear light between. */
export function shaded(frame, mask) {
  const { lit, dark } = frame;
  return painted(frame, (i, color) => {
    const v = mask[i] / 255;
    for (let c = 0; c < 3; ++c) {
      const k = 3 * i + c;
      color[c] = v === 1 ? lit[k] : v === 0 ? dark[k] : srgb(v * linear[lit[k]] + (1 - v) * linear[dark[k]]);
    }
  });
}

export const maskOnly = (frame, mask) => painted(frame, (i, color) => color.fill(mask[i]));

/** The scene in gray, behind what matters: tested pixels lighter than the rest. */
function ghost(frame, i) {
  const k = 3 * i,
    gray = (2 * frame.lit[k] + 5 * frame.lit[k + 1] + frame.lit[k + 2]) / 8;
  return frame.classes[i] === tested ? 70 + gray * 0.4 : 20 + gray * 0.2;
}

export function difference(frame, a, b) {
  const counts = { darker: 0, lighter: 0 };
  const image = painted(frame, (i, color) => {
    color.fill(ghost(frame, i));
    const size = Math.abs(a[i] - b[i]);
    const weight = frame.is_soft ? strengths[size] : size && 0.35 + (0.65 * size) / 255;
    if (weight === 0) return;
    const is_darker = a[i] < b[i];
    ++counts[is_darker ? "darker" : "lighter"];
    mix(color, is_darker ? darker : lighter, weight);
  });
  return { image, counts };
}

/**
 * Tested pixels that differ from the reference: wrong ones too dark or too light, under a light with area every one as strongly
 * as it is off. With `causes` in the color of their cause. `counts` are pixels by cause, or by side {darker, lighter}; `errors`
 * the sums of what they are off by.
 */
export function errors(frame, side, cause) {
  const { mask, reference } = side;
  const zeros = () => (cause ? data.causes.map(() => 0) : { darker: 0, lighter: 0 });
  const counts = zeros(),
    sums = zeros();
  const image = painted(frame, (i, color) => {
    color.fill(ghost(frame, i));
    if (frame.classes[i] !== tested) return;
    const size = Math.abs(mask[i] - reference[i]);
    const is_dark = mask[i] < reference[i];
    const kind = cause ? cause[i] - 1 : is_dark ? "darker" : "lighter";
    if (kind === -1) return;
    sums[kind] += size / 255;
    const weight = frame.is_soft ? strengths[size] : cause || isWrong(frame, side, i) ? 1 : 0;
    if (weight === 0) return;
    ++counts[kind];
    mix(color, cause ? data.causes[kind].color : is_dark ? darker : lighter, weight);
  });
  return { image, counts, errors: sums };
}

export function classes(frame) {
  const counts = data.classes.map(() => 0);
  const image = painted(frame, (i, color) => {
    const k = 3 * i,
      gray = (2 * frame.lit[k] + 5 * frame.lit[k + 1] + frame.lit[k + 2]) / 8;
    const info = data.classes[frame.classes[i]].color;
    ++counts[frame.classes[i]];
    // The scene shows through, so that one sees what is where.
    for (let c = 0; c < 3; ++c) color[c] = frame.classes[i] === 0 ? info[c] : 0.62 * info[c] + 0.38 * gray;
  });
  return { image, counts };
}
