// The comparer's pictures, made from masks as ImageData. A frame is {width, height, is_soft, lit, dark, bright, white, classes},
// a side of the comparison {mask, reference, causes}; the mask's errors are differences from `reference`. Masks are shares of
// the light, 0 .. 1.

import { clamp, data } from "./data.js";
import { falseColor } from "./tone.js";

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

/** Whether the pixel shows a surface that faces the light. */
export const isFacing = (frame, i) => frame.classes[i] >= firstFacing;

/** Whether the pixel counts in errors. */
export const isTested = (frame, i) => frame.classes[i] === tested;

/** Whether a side is wrong there: off by more than one half, and the pixel faces the light. */
export const isWrong = (frame, { mask, reference }, i) => {
  const over = mask[i] - reference[i];
  return isFacing(frame, i) && (reference[i] > 0.5 ? over <= -0.5 : over > 0.5);
};

/** How strong the color of an error is, 0 .. 1: under a light with area by its size, in steps. */
const steps = data.error_steps;
const strengthOf = (size) => steps.reduce((weight, [least, stronger]) => (size >= least ? stronger : weight), 0);

/** The colors of the steps over gray, [least, color] each. */
export const scaleOf = (color) => steps.map(([least, weight]) => [least, color.map((c) => 128 + weight * (c - 128))]);

const mix = (color, over, weight) => over.forEach((value, c) => (color[c] += weight * (value - color[c])));

function painted({ width, height }, paint) {
  const image = new ImageData(width, height);
  const { data: bytes } = image;
  const color = [0, 0, 0];
  for (let i = 0, at = 0; i < width * height; ++i) {
    paint(i, color);
    for (let c = 0; c < 3; ++c) bytes[at++] = color[c];
    bytes[at++] = 255;
  }
  return image;
}

/** A byte of a picture with so many times the light. */
const exposed = (byte, gain) => (gain === 1 ? byte : srgb(Math.min(1, gain * linear[byte])));

/**
 * The scene under this mask in so many times the light: exact at 0 and 1, mixed in linear light between; `bright` has the light
 * that `lit` cuts off.
 */
export function shaded(frame, mask, gain = 1) {
  const { lit, dark, bright, white } = frame;
  const full = (k) => (lit[k] < 255 || !bright ? linear[lit[k]] : white * linear[bright[k]]);
  const mixed = (v, k) => srgb(Math.min(1, gain * (v * full(k) + (1 - v) * linear[dark[k]])));
  return painted(frame, (i, color) => {
    const v = mask[i];
    for (let c = 0; c < 3; ++c) {
      const k = 3 * i + c;
      color[c] = v === 1 && gain === 1 ? lit[k] : v === 0 ? exposed(dark[k], gain) : mixed(v, k);
    }
  });
}

/** A picture of colors in so many times its light. */
export const colored = (frame, rgb, gain = 1) =>
  painted(frame, (i, color) => {
    for (let c = 0; c < 3; ++c) color[c] = exposed(rgb[3 * i + c], gain);
  });

export const maskOnly = (frame, mask, gain = 1) => painted(frame, (i, color) => color.fill(255 * Math.min(1, gain * mask[i])));

/** Visibility in false colors where the surface faces the light, the rest dark. */
export const inFalseColors = (frame, mask, gain) =>
  painted(frame, (i, color) => {
    const shown = isFacing(frame, i) ? falseColor(gain * mask[i]) : [ghost(frame, i), ghost(frame, i), ghost(frame, i)];
    for (let c = 0; c < 3; ++c) color[c] = shown[c];
  });

/** The gray of the lit scene, 0 .. 255. */
const grayOf = ({ lit }, i) => (2 * lit[3 * i] + 5 * lit[3 * i + 1] + lit[3 * i + 2]) / 8;

/** The scene in gray, as a background: tested pixels are lighter than the rest. */
const ghost = (frame, i) => (isTested(frame, i) ? 70 + grayOf(frame, i) * 0.4 : 20 + grayOf(frame, i) * 0.2);

/** The scene in light gray under colors on white: the difference from white. */
const shadeOf = (frame, i) => 36 * (1 - grayOf(frame, i) / 255);

/** The color of a signed difference, given as a share of the scale, -1 .. 1. */
function signedColor(share, color) {
  const { colors } = data.signed;
  const place = ((colors.length - 1) * (1 + clamp(share, -1, 1))) / 2;
  const below = Math.min(Math.floor(place), colors.length - 2);
  for (let c = 0; c < 3; ++c) color[c] = colors[below][c] + (place - below) * (colors[below + 1][c] - colors[below][c]);
}

/**
 * `a` less `b` where the surface faces the light, in colors that end at +-`scale`; the scene shows a little where both are alike,
 * the rest is dark. `counts` are pixels that are darker and lighter, under a light with area by 0.01 or more, and those beyond
 * the scale; `mean` and `size` means of the difference and of its size over tested pixels, null where there are none.
 */
export function difference(frame, a, b, scale) {
  const counts = { darker: 0, lighter: 0, beyond: 0 };
  const least = frame.is_soft ? 0.01 : 0;
  let [sum, sizes, pixels] = [0, 0, 0];
  const image = painted(frame, (i, color) => {
    if (!isFacing(frame, i)) return color.fill(ghost(frame, i));
    const off = a[i] - b[i];
    const size = Math.abs(off);
    signedColor(off / scale, color);
    const shade = shadeOf(frame, i) * (1 - Math.min(1, size / scale));
    for (let c = 0; c < 3; ++c) color[c] -= shade;
    if (size > least) ++counts[off < 0 ? "darker" : "lighter"];
    if (size > scale * 1.0001) ++counts.beyond;
    if (!isTested(frame, i)) return;
    sum += off;
    sizes += size;
    ++pixels;
  });
  return { image, counts, mean: pixels ? sum / pixels : null, size: pixels ? sizes / pixels : null };
}

/**
 * Tested pixels that differ from the reference: wrong ones too dark or too light, under a light with area every one as strongly
 * as it is off. With `causes` in the color of their cause. `counts` are pixels by cause, or by side {darker, lighter}; `errors`
 * the sums of what they are off by.
 */
export function errors(frame, side, cause) {
  const { mask, reference } = side;
  const zeros = () => (cause ? data.causes.map(() => 0) : { darker: 0, lighter: 0 });
  const [counts, sums] = [zeros(), zeros()];
  const image = painted(frame, (i, color) => {
    color.fill(ghost(frame, i));
    if (!isTested(frame, i)) return;
    const size = Math.abs(mask[i] - reference[i]);
    const is_dark = mask[i] < reference[i];
    const kind = cause ? cause[i] - 1 : is_dark ? "darker" : "lighter";
    if (kind === -1) return;
    sums[kind] += size;
    const weight = frame.is_soft ? strengthOf(size) : cause || isWrong(frame, side, i) ? 1 : 0;
    if (weight === 0) return;
    ++counts[kind];
    mix(color, cause ? data.causes[kind].color : is_dark ? darker : lighter, weight);
  });
  return { image, counts, errors: sums };
}

export function classes(frame) {
  const counts = data.classes.map(() => 0);
  const image = painted(frame, (i, color) => {
    const k = frame.classes[i];
    const of_class = data.classes[k].color;
    ++counts[k];
    // The scene shows through, so that its objects can be recognized.
    for (let c = 0; c < 3; ++c) color[c] = k === 0 ? of_class[c] : 0.62 * of_class[c] + 0.38 * grayOf(frame, i);
  });
  return { image, counts };
}
