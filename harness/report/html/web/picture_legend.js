// What the colors of the comparer's picture stand for.

import * as compose from "./compose.js";
import { levels } from "./contours.js";
import { columnNamed, data, textOf, valueOf } from "./data.js";
import { measured, percent, tick } from "./digits.js";
import { h, rgb } from "./dom.js";

const entry = (color, text, title) => h("li", { title }, h("i", { style: { background: rgb(color) } }), text);

/** The colors of signed differences from end to end, with numbers. */
function signedScale(scale) {
  const sign = (share) => (share < 0 ? "\u2212" : share > 0 ? "+" : "");
  const numbers = [-1, -0.5, 0, 0.5, 1].map((share) => sign(share) + tick(Math.abs(share * scale)));
  return h(
    "li",
    { class: "scale" },
    h("span", {}, "A darker"),
    h(
      "span",
      { class: "ramp", role: "img", "aria-label": `Colors from \u2212${scale} to +${scale}` },
      h("i", { style: { background: `linear-gradient(to right, ${data.signed.colors.map(rgb).join()})` } }),
      h(
        "span",
        { class: "ticks" },
        numbers.map((number) => h("span", {}, number)),
      ),
    ),
    h("span", {}, "A lighter"),
  );
}

const signed = (value) => (value < 0 ? "\u2212" : "+") + measured(Math.abs(value));

/** The scale and what the difference amounts to. */
function ofDifference(frame, { counts, mean, size }, scale) {
  const least = frame.is_soft ? " by 0.01 or more" : "",
    pixels = frame.width * frame.height;
  const count = (name, number) =>
    h("li", {}, `${name}${least} ${number.toLocaleString("en")} px, ${percent(number / pixels)} of the picture`);
  return [
    signedScale(scale),
    mean !== null && h("li", {}, `tested pixels: mean ${signed(mean)}, mean size ${measured(size)}`),
    count("A darker", counts.darker),
    count("A lighter", counts.lighter),
    counts.beyond > 0 && h("li", {}, `beyond the scale ${counts.beyond.toLocaleString("en")} px`),
    h("li", {}, "Dark gray: background, or turned away from the light."),
  ].filter(Boolean);
}

/** Whose lines are drawn, and at which visibilities. `list` may name one mask several times. */
export function contourLegend(list) {
  const line = (ink, dash) => {
    const [core, casing] = [ink.core, ink.casing].map(rgb);
    const stroke = (color, width, dashes) =>
      `<path d='M1 5H33' fill='none' stroke='${color}' stroke-width='${width}' stroke-dasharray='${dashes.join(" ")}'/>`;
    const strokes = stroke(casing, ink.widths[0], []) + stroke(core, ink.widths[1], dash);
    const svg = `<svg xmlns='http://www.w3.org/2000/svg' width='34' height='10'>${strokes}</svg>`;
    return h("img", { class: "line", alt: "", src: `data:image/svg+xml,${encodeURIComponent(svg)}` });
  };
  const once = [...new Map(list.map((item) => [item.mask, item])).values()];
  return [
    ...once.map(({ title, ink }) => h("li", {}, line(ink, []), `contours of ${title}`)),
    ...levels.map(({ value, dash }) => h("li", {}, line(once[0].ink, dash), `V = ${value}`)),
  ];
}

const testedOf = (frame) => frame.classes.reduce((sum, c) => sum + (c === data.classes.length - 1), 0);

/** Pixels that are darker and lighter, by name, as a share of `of`, which is `what`. */
const sides = ({ darker, lighter }, [dark, light], of, what) =>
  [
    [compose.darker, dark, darker],
    [compose.lighter, light, lighter],
  ].map(([color, name, count]) =>
    entry(color, `${name} ${count.toLocaleString("en")} px, ${percent(of ? count / of : 0)} of ${what}`),
  );

/** What the strengths of colors stand for, under a light with area. */
function scale(frame, color = compose.lighter) {
  if (!frame.is_soft) return [];
  const steps = compose.scaleOf(color),
    last = steps.length - 1;
  const text = (least, k) => `${k === 0 ? "off by " : ""}${tick(100 * least)} %${k === last ? " or more" : ""}`;
  return steps.map(([least, over], k) => entry(over, text(least, k), "Of the light's visible share, 0 to 100 %"));
}

/** The row's error and its floor, as the table has them; it has none of one light of several. */
function means(frame, { row }) {
  if (!frame.is_soft || !row || frame.is_one_of_several) return [];
  const says = (name) => `${textOf(row, columnNamed(name))} %`;
  const has_floor = valueOf(row, "error_floor") !== null;
  return [h("li", {}, `error ${says("error")}${has_floor ? `, floor ${says("error_floor")}` : ""}`)];
}

function ofErrors(frame, side, { counts, errors }) {
  if (!frame.is_soft) {
    if (counts.darker + counts.lighter === 0) return [h("li", {}, "No tested pixel is wrong.")];
    return sides(counts, ["false dark", "false lit"], testedOf(frame), "the tested pixels");
  }
  const sum = errors.darker + errors.lighter;
  if (sum === 0) return [...means(frame, side), h("li", {}, "No tested pixel is off.")];
  return [
    ...means(frame, side),
    entry(compose.darker, `too dark ${percent(errors.darker / sum)} of the error`),
    entry(compose.lighter, `too light ${percent(errors.lighter / sum)} of the error`),
    ...scale(frame, errors.darker > errors.lighter ? compose.darker : compose.lighter),
  ];
}

/** Causes by pixels, under a light with area by how much of the error they hold. */
function ofCauses(frame, side, { counts, errors }) {
  const { is_soft } = frame;
  const parts = is_soft ? errors : counts,
    whole = is_soft ? errors.reduce((sum, part) => sum + part, 0) : testedOf(frame);
  const entries = data.causes
    .map((cause, k) => ({ cause, part: parts[k] }))
    .filter(({ part }) => part > 0)
    .map(({ cause, part }) => {
      const text = `${cause.name.replaceAll("_", " ")} ${percent(part / whole)}${is_soft ? " of the error" : ""}`;
      return entry(cause.color, text, cause.sentence);
    });
  if (entries.length === 0) return [...means(frame, side), h("li", {}, `No tested pixel is ${is_soft ? "off" : "wrong"}.`)];
  const strongest = data.causes[parts.indexOf(Math.max(...parts))];
  return [...means(frame, side), ...entries, ...scale(frame, strongest.color)];
}

/**
 * Entries of the legend of a mode. `side` is A, `made` what compose.js made for the mode, with counts of pixels; undefined where
 * it counts none; `ends` is where the colors of differences end.
 */
export function legendOf(mode, frame, side, made, ends) {
  const pixels = frame.width * frame.height;
  if (mode === "difference") return ofDifference(frame, made, ends);
  if (mode === "error" || (mode === "causes" && !side.causes)) return ofErrors(frame, side, made);
  if (mode === "causes") return ofCauses(frame, side, made);
  if (mode !== "classes") return [];
  return data.classes.map((info, k) =>
    entry(info.color, `${info.name} ${info.word} ${percent(made.counts[k] / pixels)}`, info.sentence),
  );
}
