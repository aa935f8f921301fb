// The legend of the comparer's picture.

import * as compose from "./compose.js";
import { levels } from "./contours.js";
import { columnNamed, data, sum, textOf, valueOf } from "./data.js";
import { measured, percent, tick } from "./digits.js";
import { h, rgb, swatch, words } from "./dom.js";
import { falseColor } from "./tone.js";

const line = (text) => h("li", {}, text);
const entry = (color, text, title) => h("li", { title }, swatch(rgb(color)), text);
const pixels = (count, all, what) => `${count.toLocaleString("en")} px, ${percent(all ? count / all : 0)} of ${what}`;

/** Colors from end to end with numbers below, between two words. */
function ramp(colors, numbers, [before, behind]) {
  const [first, last] = [numbers[0], numbers.at(-1)];
  const shown = h(
    "span",
    { class: "ramp", role: "img", "aria-label": `Colors from ${first} to ${last}` },
    swatch(`linear-gradient(to right, ${colors.map(rgb).join()})`),
    h("span", { class: "ticks" }, numbers.map((number) => h("span", {}, number))),
  );
  return h("li", { class: "scale" }, h("span", {}, before), shown, h("span", {}, behind));
}

/** The colors of signed differences. */
function signedScale(scale) {
  const sign = (share) => (share < 0 ? "\u2212" : share > 0 ? "+" : "");
  const numbers = [-1, -0.5, 0, 0.5, 1].map((share) => sign(share) + tick(Math.abs(share * scale)));
  return ramp(data.signed.colors, numbers, ["A darker", "A lighter"]);
}

/** What visibility is shown as, unless that is as usual. */
export function toneLegend({ gain, is_false }) {
  const shares = [0, 0.25, 0.5, 0.75, 1];
  const colors = Array.from({ length: 33 }, (_, k) => falseColor(k / 32));
  return [
    is_false && ramp(colors, shares.map((share) => tick(share / gain)), ["dark", gain > 1 ? "or more" : "lit"]),
    is_false && line("Dark gray: background, or turned away from the light."),
    gain !== 1 && line(`exposure: ${tick(gain)} times the light`),
  ].filter(Boolean);
}

const signed = (value) => (value < 0 ? "\u2212" : "+") + measured(Math.abs(value));

/** The scale, and the sizes and numbers of the differences. */
function ofDifference(frame, { counts, mean, size }, scale) {
  const least = frame.is_soft ? " by 0.01 or more" : "";
  const count = (name, number) => line(`${name}${least} ${pixels(number, frame.width * frame.height, "the picture")}`);
  return [
    signedScale(scale),
    mean !== null && line(`tested pixels: mean ${signed(mean)}, mean size ${measured(size)}`),
    count("A darker", counts.darker),
    count("A lighter", counts.lighter),
    counts.beyond > 0 && line(`beyond the scale ${counts.beyond.toLocaleString("en")} px`),
    line("Dark gray: background, or turned away from the light."),
  ].filter(Boolean);
}

/** The masks whose lines are drawn, and the visibilities. `list` may contain a mask several times. */
export function contourLegend(list) {
  const sample = (ink, dash) => {
    const [core, casing] = [ink.core, ink.casing].map(rgb);
    const stroke = (color, width, dashes) =>
      `<path d='M1 5H33' fill='none' stroke='${color}' stroke-width='${width}' stroke-dasharray='${dashes.join(" ")}'/>`;
    const strokes = stroke(casing, ink.widths[0], []) + stroke(core, ink.widths[1], dash);
    const svg = `<svg xmlns='http://www.w3.org/2000/svg' width='34' height='10'>${strokes}</svg>`;
    return h("img", { class: "line", alt: "", src: `data:image/svg+xml,${encodeURIComponent(svg)}` });
  };
  const once = [...new Map(list.map((item) => [item.mask, item])).values()];
  return [
    ...once.map(({ title, ink }) => h("li", {}, sample(ink, []), `contours of ${title}`)),
    ...levels.map(({ value, dash }) => h("li", {}, sample(once[0].ink, dash), `V = ${value}`)),
  ];
}

const testedOf = (frame) => frame.classes.reduce((sum, c) => sum + (c === data.classes.length - 1), 0);

/** The meaning of the strengths of a color, under a light with area. */
function scale(frame, color) {
  if (!frame.is_soft) return [];
  const steps = compose.scaleOf(color);
  const last = steps.length - 1;
  const text = (least, k) => `${k === 0 ? "off by " : ""}${tick(100 * least)} %${k === last ? " or more" : ""}`;
  return steps.map(([least, over], k) => entry(over, text(least, k), "Of the light's visible share, 0 to 100 %"));
}

/** The row's error and its floor, as in the table; nothing for one of several lights. */
function means(frame, { row }) {
  if (!frame.is_soft || !row || frame.is_one_of_several) return [];
  const says = (name) => `${textOf(row, columnNamed(name))} %`;
  const has_floor = valueOf(row, "error_floor") !== null;
  return [line(`error ${says("error")}${has_floor ? `, floor ${says("error_floor")}` : ""}`)];
}

function ofErrors(frame, side, { counts, errors }) {
  if (!frame.is_soft) {
    if (counts.darker + counts.lighter === 0) return [line("No tested pixel is wrong.")];
    const share = (count) => pixels(count, testedOf(frame), "the tested pixels");
    return [
      entry(compose.darker, `false dark ${share(counts.darker)}`),
      entry(compose.lighter, `false lit ${share(counts.lighter)}`),
    ];
  }
  const total = errors.darker + errors.lighter;
  if (total === 0) return [...means(frame, side), line("No tested pixel is off.")];
  return [
    ...means(frame, side),
    entry(compose.darker, `too dark ${percent(errors.darker / total)} of the error`),
    entry(compose.lighter, `too light ${percent(errors.lighter / total)} of the error`),
    ...scale(frame, errors.darker > errors.lighter ? compose.darker : compose.lighter),
  ];
}

/** Causes by their shares of the tested pixels, under a light with area by those of the error. */
function ofCauses(frame, side, { counts, errors }) {
  const { is_soft } = frame;
  const parts = is_soft ? errors : counts;
  const whole = is_soft ? sum(errors) : testedOf(frame);
  const entries = data.causes.flatMap(({ name, color, sentence }, k) => {
    const text = `${words(name)} ${percent(parts[k] / whole)}${is_soft ? " of the error" : ""}`;
    return parts[k] > 0 ? [entry(color, text, sentence)] : [];
  });
  if (entries.length === 0) return [...means(frame, side), line(`No tested pixel is ${is_soft ? "off" : "wrong"}.`)];
  const strongest = data.causes[parts.indexOf(Math.max(...parts))];
  return [...means(frame, side), ...entries, ...scale(frame, strongest.color)];
}

/**
 * Entries of the legend of a mode. `side` is A. `made` is the result of compose.js for the mode, with counts of pixels; null
 * where it has none. The colors of differences end at `ends`.
 */
export function legendOf(mode, frame, side, made, ends) {
  if (mode === "difference") return ofDifference(frame, made, ends);
  if (mode === "error" || (mode === "causes" && !side.causes)) return ofErrors(frame, side, made);
  if (mode === "causes") return ofCauses(frame, side, made);
  if (mode !== "classes") return [];
  const share = (count) => percent(count / (frame.width * frame.height));
  return data.classes.map((info, k) => entry(info.color, `${info.name} ${info.word} ${share(made.counts[k])}`, info.sentence));
}
