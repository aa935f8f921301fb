// A profile: masks along a line over the picture, against the distance from its start.

import { areaY, lineY, plot, pointerX, ruleX, ruleY, tip } from "@observablehq/plot";

import { acrossOptions, describe, frame as plotFrame, unname, upOptions } from "./axes.js";
import { isFacing } from "./compose.js";
import { clamp, data, distinct, joined } from "./data.js";
import { chooser, h, onWidth } from "./dom.js";
import { pixelsOn } from "./line_pixels.js";

/** Standard errors to each side of an estimate that contain the true value 95 times of 100. */
const standardErrors = 1.96;

/** Sides that are drawn: {side, name, color} of techniques, and the truths that they are compared with. */
function seriesOf(sideA, sideB) {
  const techniques = [
    { side: sideA, name: "A", color: "var(--series-1)" },
    { side: sideB, name: "B", color: "var(--series-3)" },
  ].filter(({ side }) => side.row);
  const shown = techniques.length > 0 ? techniques.map(({ side }) => side.truth) : [sideA.truth];
  return { techniques, truths: distinct(shown) };
}

/**
 * The card below the picture. Calls `onpoint(pixel)` with the pixel of the line that the pointer is at in the plot, or null, and
 * `onchoice()` when the reader chooses what it is of.
 */
export class Profile {
  constructor(onpoint, onchoice) {
    this.onpoint = onpoint;
    const choices = [
      { value: "visibility", text: "visibility" },
      { value: "difference", text: "difference to the reference" },
    ];
    this.shows = chooser("profile", choices, () => { this.redraw(); onchoice(); }, "profile of");
    this.figure = h("figure");
    this.key = h("ul", { class: "swatches", "aria-label": "Lines of the profile" });
    this.lead = h("p", { class: "lead" });
    this.element = h(
      "article",
      { class: "card profile", hidden: true },
      h("h3", {}, "Profile"),
      this.lead,
      h("div", { class: "bar" }, this.shows.element),
      this.key,
      this.figure,
    );
    this.width = 0;
    onWidth(this.figure, (width) => { this.width = width; this.redraw(); });
  }

  /** `line` of two pixels, null for none. */
  set(frame, sideA, sideB, line) {
    this.content = line && { frame, sideA, sideB, line };
    this.element.hidden = !line;
    this.redraw();
  }

  redraw() {
    if (!this.content || this.width === 0) return;
    const { frame, sideA, sideB, line } = this.content;
    const series = seriesOf(sideA, sideB);
    const samples = pixelsOn(line, frame.width);
    const is_difference = this.shows.value === "difference";
    const [from, to] = line;
    this.lead.textContent = `From pixel ${from.x}, ${from.y} to ${to.x}, ${to.y}: ${samples.at(-1).distance.toFixed(1)} pixels.`;
    this.key.replaceChildren(...keyOf(series, is_difference));
    const made = profilePlot(frame, samples, series, is_difference, this.width);
    made.addEventListener("input", () => this.onpoint(made.value ? { x: made.value.x, y: made.value.y } : null));
    const svg = describe(made, "Profile along the line; the picture's arrow keys read its pixels out");
    // At each move of the pointer the library draws rule and tip anew, with their names.
    new MutationObserver(() => unname(svg)).observe(svg, { childList: true, subtree: true });
    this.figure.replaceChildren(made, h("figcaption", {}, captionOf(frame, samples, series)));
  }
}

function keyOf({ techniques, truths }, is_difference) {
  const stroke = (color) => h("i", { class: "stroke", style: { background: color } });
  const has_band = truths.some(({ error }) => error);
  const band = `${is_difference ? "the reference's" : "its"} 95 % band (\u00b1${standardErrors} standard errors)`;
  return [
    ...techniques.map(({ side, name, color }) => h("li", {}, stroke(color), `${name}  ${side.title}`)),
    !is_difference && h("li", {}, stroke("var(--ink)"), "reference"),
    has_band && h("li", {}, h("i", { class: "band" }), band),
  ].filter(Boolean);
}

/** A value of a sample is a gap, no number, where nothing faces the light. */
function profilePlot(frame, samples, { techniques, truths }, is_difference, width) {
  const at = (values) => (sample) => (isFacing(frame, sample.i) ? values(sample.i) : NaN);
  const x = "distance";
  const share = (value) => (is_difference ? value : clamp(value, 0, 1));
  const center = (truth, i) => (is_difference ? 0 : truth.mask[i]);
  const end = (truth, errors) => at((i) => share(center(truth, i) + errors * truth.error[i]));
  const banded = truths.filter(({ error }) => error);
  const bands = banded.map((truth) => ({ y1: end(truth, -standardErrors), y2: end(truth, standardErrors) }));
  const values = ({ side }) => at((i) => side.mask[i] - (is_difference ? side.truth.mask[i] : 0));
  const lines = techniques.map((technique) => ({ y: values(technique), color: technique.color }));
  const sizes = (of) => samples.map((sample) => Math.abs(of(sample))).filter(Number.isFinite);
  const largest = Math.max(0.001, ...lines.flatMap(({ y }) => sizes(y)), ...bands.flatMap(({ y2 }) => sizes(y2)));
  const domain = is_difference ? [-1.05 * largest, 1.05 * largest] : [-0.02, 1.02];
  const edge = { stroke: "var(--ink)", strokeOpacity: 0.45, strokeWidth: 0.75 };
  const inkOf = (k) => ({ stroke: "var(--ink)", strokeWidth: 1.6, strokeDasharray: k ? "5 4" : null });
  const y = at((i) => center(truths[0], i));
  const title = (sample) => saysOf(frame, sample, techniques, truths).join("\n");
  const label = is_difference ? "share of the light, less the reference's" : "share of the light that is seen";
  return plot({
    ...plotFrame(width, clamp(width * 0.4, 260, 360)),
    x: acrossOptions("distance along the line (pixels)", { domain: [0, samples.at(-1).distance || 1] }),
    y: upOptions(`\u2191 ${label}`, { domain }),
    marks: [
      ruleY([0], { stroke: "var(--ink)", strokeOpacity: is_difference ? 0.9 : 0.35 }),
      bands.map((band) => areaY(samples, { x, ...band, fill: "var(--ink)", fillOpacity: 0.22 })),
      bands.map(({ y1, y2 }) => [y1, y2].map((y) => lineY(samples, { x, y, ...edge }))),
      is_difference ? null : truths.map(({ mask }, k) => lineY(samples, { x, y: at((i) => mask[i]), ...inkOf(k) })),
      lines.map(({ y, color }) => lineY(samples, { x, y, stroke: color, strokeWidth: 1.8 })),
      ruleX(samples, pointerX({ x, stroke: "var(--ink)", strokeOpacity: 0.5 })),
      tip(samples, pointerX({ x, y, title, fontSize: 12, lineWidth: 30 })),
    ],
  });
}

function saysOf(frame, { x, y, i, distance }, techniques, truths) {
  const info = data.classes[frame.classes[i]];
  const text = (value) => value.toFixed(frame.is_soft ? 4 : 2);
  const signed = (value) => (value < 0 ? "\u2212" : "+") + text(Math.abs(value));
  const ofTechnique = ({ side, name }) => `${name}: ${text(side.mask[i])} (${signed(side.mask[i] - side.truth.mask[i])})`;
  const ofTruth = ({ name, mask, error }) =>
    `${name}: ${text(mask[i])}${error ? ` \u00b1 ${text(standardErrors * error[i])}` : ""}`;
  const place = `${distance.toFixed(1)} pixels: ${x}, ${y} (${info.word})`;
  return [place, ...techniques.map(ofTechnique), ...truths.map(ofTruth)];
}

function captionOf(frame, samples, { truths }) {
  return joined([
    "One value for each pixel on the line.",
    samples.some(({ i }) => !isFacing(frame, i)) && "Gaps: background, or a surface turned away from the light.",
    truths.length > 1 && "Dashed: the reference of B, which estimates the other number.",
    !truths.some(({ error }) => error) && "The reference of a light without area is exact but for class U.",
  ]);
}
