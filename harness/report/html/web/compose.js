// Pictures from masks: what the comparer shows, as ImageData. A frame is {width, height, lit, dark, reference, classes}.

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

/** Whether a mask is wrong there: off by more than one half, and the pixel faces the light. */
export const isWrong = (frame, mask, i) => frame.classes[i] >= firstFacing && Math.abs(mask[i] - frame.reference[i]) > 127.5;

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

const set = (color, [r, g, b]) => ((color[0] = r), (color[1] = g), (color[2] = b));

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
    const share = (a[i] - b[i]) / 255;
    if (share === 0) return;
    ++counts[share < 0 ? "darker" : "lighter"];
    const over = share < 0 ? darker : lighter,
      weight = 0.35 + 0.65 * Math.abs(share);
    for (let c = 0; c < 3; ++c) color[c] += weight * (over[c] - color[c]);
  });
  return { image, counts };
}

/** Wrong pixels by cause; by false dark and false lit where causes are not known. */
export function causes(frame, mask, cause) {
  const counts = cause ? data.causes.map(() => 0) : { darker: 0, lighter: 0 };
  const image = painted(frame, (i, color) => {
    color.fill(ghost(frame, i));
    if (cause) {
      if (cause[i] === 0) return;
      ++counts[cause[i] - 1];
      set(color, data.causes[cause[i] - 1].color);
    } else if (frame.classes[i] === tested && isWrong(frame, mask, i)) {
      const is_dark = mask[i] < frame.reference[i];
      ++counts[is_dark ? "darker" : "lighter"];
      set(color, is_dark ? darker : lighter);
    }
  });
  return { image, counts };
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
