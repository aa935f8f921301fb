// Pictures from masks: what the comparer shows, as ImageData. A frame is {width, height, is_soft, lit, dark, bright, white,
// classes}, a side what is compared: {mask, reference, causes}; `reference` is what its mask is judged by. Masks are shares of the
// light, 0 .. 1.

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

/** Whether the pixel shows a surface that faces the light. */
export const isFacing = (frame, i) => frame.classes[i] >= firstFacing;

/** Whether the pixel counts in errors. */
export const isTested = (frame, i) => frame.classes[i] === tested;

/** Whether a side is wrong there: off by more than one half, and the pixel faces the light. */
export const isWrong = (frame, side, i) => {
  const over = side.mask[i] - side.reference[i];
  return isFacing(frame, i) && (side.reference[i] > 0.5 ? over <= -0.5 : over > 0.5);
};

/** How strong the color of an error is, 0 .. 1: under a light with area by its size, in steps. */
const steps = data.error_steps;
const strengthOf = (size) => steps.reduce((weight, [least, stronger]) => (size >= least ? stronger : weight), 0);

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

/** The scene under this mask: exact at 0 and 1, mixed in linear light between; `bright` has what `lit` cuts off above white. */
export function shaded(frame, mask) {
  const { lit, dark, bright, white } = frame;
  const full = (k) => (lit[k] < 255 || !bright ? linear[lit[k]] : white * linear[bright[k]]);
  const mixed = (v, k) => srgb(Math.min(1, v * full(k) + (1 - v) * linear[dark[k]]));
  return painted(frame, (i, color) => {
    const v = mask[i];
    for (let c = 0; c < 3; ++c) {
      const k = 3 * i + c;
      color[c] = v === 1 ? lit[k] : v === 0 ? dark[k] : mixed(v, k);
    }
  });
}

/** A picture of colors as it is. */
export const colored = (frame, rgb) =>
  painted(frame, (i, color) => {
    for (let c = 0; c < 3; ++c) color[c] = rgb[3 * i + c];
  });

export const maskOnly = (frame, mask) => painted(frame, (i, color) => color.fill(255 * mask[i]));

/** The scene in gray, behind what matters: tested pixels lighter than the rest. */
function ghost(frame, i) {
  const k = 3 * i,
    gray = (2 * frame.lit[k] + 5 * frame.lit[k + 1] + frame.lit[k + 2]) / 8;
  return frame.classes[i] === tested ? 70 + gray * 0.4 : 20 + gray * 0.2;
}

/** The scene in light gray, for what is drawn in colors on white: how much darker than white. */
const shadeOf = (frame, i) => {
  const k = 3 * i;
  return 36 * (1 - (2 * frame.lit[k] + 5 * frame.lit[k + 1] + frame.lit[k + 2]) / 2040);
};

/** The color of a signed difference, which is given as a share of the scale, -1 .. 1. */
function signedColor(share, color) {
  const colors = data.signed.colors,
    place = ((colors.length - 1) * (1 + Math.max(-1, Math.min(1, share)))) / 2;
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
  let sum = 0,
    sizes = 0,
    pixels = 0;
  const image = painted(frame, (i, color) => {
    if (!isFacing(frame, i)) return color.fill(ghost(frame, i));
    const off = a[i] - b[i],
      size = Math.abs(off);
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
  const counts = zeros(),
    sums = zeros();
  const image = painted(frame, (i, color) => {
    color.fill(ghost(frame, i));
    if (frame.classes[i] !== tested) return;
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
    const k = 3 * i,
      gray = (2 * frame.lit[k] + 5 * frame.lit[k + 1] + frame.lit[k + 2]) / 8;
    const info = data.classes[frame.classes[i]].color;
    ++counts[frame.classes[i]];
    // The scene shows through, so that one sees what is where.
    for (let c = 0; c < 3; ++c) color[c] = frame.classes[i] === 0 ? info[c] : 0.62 * info[c] + 0.38 * gray;
  });
  return { image, counts };
}
