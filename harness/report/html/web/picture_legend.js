// What the colors of the comparer's picture stand for.

import * as compose from "./compose.js";
import { columnNamed, data, textOf } from "./data.js";
import { percent, tick } from "./digits.js";
import { h, rgb } from "./dom.js";

const entry = (color, text, title) => h("li", { title }, h("i", { style: { background: rgb(color) } }), text);

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

/** The row's mean error and the reference's own, as the table has them. */
function means(frame, { row }) {
  if (!frame.is_soft || !row) return [];
  const says = (name) => `${textOf(row, columnNamed(name))} %`;
  return [h("li", {}, `mean error ${says("error")}, the reference's own ${says("reference_error_mean")}`)];
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
 * it counts none.
 */
export function legendOf(mode, frame, side, made) {
  const pixels = frame.width * frame.height;
  if (mode === "difference") return [...sides(made.counts, ["A darker", "A lighter"], pixels, "the picture"), ...scale(frame)];
  if (mode === "error" || (mode === "causes" && !side.causes)) return ofErrors(frame, side, made);
  if (mode === "causes") return ofCauses(frame, side, made);
  if (mode !== "classes") return [];
  return data.classes.map((info, k) =>
    entry(info.color, `${info.name} ${info.word} ${percent(made.counts[k] / pixels)}`, info.sentence),
  );
}
