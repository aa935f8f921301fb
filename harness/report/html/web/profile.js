// A profile: masks along a line over the picture, against the distance from its start.

import { areaY, lineY, plot, pointerX, ruleX, ruleY, tip } from "@observablehq/plot";

import { frame as plotFrame } from "./axes.js";
import { isFacing } from "./compose.js";
import { data } from "./data.js";
import { chooser, h } from "./dom.js";
import { pixelsOn } from "./line_pixels.js";

/** Standard errors to each side that hold the right answer 95 times of 100. */
const standardErrors = 1.96;

const signed = (value, digits) => (value < 0 ? "\u2212" : "+") + Math.abs(value).toFixed(digits);

/** What is drawn: {name, color, mask, truth} of techniques, and the truths that they are compared with. */
function seriesOf(sideA, sideB) {
  const techniques = [
    { side: sideA, name: "A", color: "var(--series-5)" },
    { side: sideB, name: "B", color: "var(--series-3)" },
  ].filter(({ side }) => side.row);
  const shown = techniques.length > 0 ? techniques.map(({ side }) => side.truth) : [sideA.truth];
  return { techniques, truths: [...new Set(shown)] };
}

/**
 * The card below the picture. `onpoint(pixel)` is told which pixel of the line is pointed at in the plot, null when none is;
 * `redraw()` draws it again at another width or with other choices.
 */
export class Profile {
  constructor({ onpoint }) {
    this.onpoint = onpoint;
    this.shows = chooser(
      "profile of",
      [
        { value: "visibility", text: "visibility" },
        { value: "difference", text: "difference to the reference" },
      ],
      () => this.redraw(),
      { name: "profile" },
    );
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
    new ResizeObserver(() => {
      if (this.width === this.figure.clientWidth) return;
      this.width = this.figure.clientWidth;
      this.redraw();
    }).observe(this.figure);
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
    const series = seriesOf(sideA, sideB),
      samples = pixelsOn(line, frame.width);
    const is_difference = this.shows.value === "difference";
    const [from, to] = line;
    this.lead.textContent = `From pixel ${from.x}, ${from.y} to ${to.x}, ${to.y}: ${samples.at(-1).distance.toFixed(1)} pixels.`;
    this.key.replaceChildren(...keyOf(series, is_difference));
    const made = profilePlot(frame, samples, series, is_difference, this.width);
    made.addEventListener("input", () => this.onpoint(made.value ? { x: made.value.x, y: made.value.y } : null));
    const svg = made.localName === "svg" ? made : made.querySelector("svg:last-of-type");
    const unname = () => {
      for (const part of svg.querySelectorAll("[aria-label]")) {
        part.dataset.mark = part.getAttribute("aria-label");
        part.removeAttribute("aria-label");
      }
    };
    unname();
    // What follows the pointer is drawn anew at each of its moves, with its name.
    new MutationObserver(unname).observe(svg, { childList: true, subtree: true });
    svg.setAttribute("role", "img");
    svg.setAttribute("aria-label", "Profile along the line; the picture's arrow keys read its pixels out");
    this.figure.replaceChildren(made, h("figcaption", {}, captionOf(frame, samples, series)));
  }
}

function keyOf({ techniques, truths }, is_difference) {
  const stroke = (color) => h("i", { class: "stroke", style: { background: color } });
  const has_band = truths.some(({ error }) => error);
  return [
    ...techniques.map(({ side, name, color }) => h("li", {}, stroke(color), `${name}  ${side.title}`)),
    !is_difference && h("li", {}, stroke("var(--ink)"), "reference"),
    has_band &&
      h(
        "li",
        {},
        h("i", { class: "band" }),
        `${is_difference ? "the reference's" : "its"} 95 % band (\u00b1${standardErrors} standard errors)`,
      ),
  ].filter(Boolean);
}

/** The values of a sample in the terms of the plot; no number where nothing faces the light, which leaves a gap. */
function profilePlot(frame, samples, { techniques, truths }, is_difference, width) {
  const at = (values) => (sample) => (isFacing(frame, sample.i) ? values(sample.i) : NaN);
  const x = "distance";
  const share = (value) => (is_difference ? value : Math.min(1, Math.max(0, value)));
  const center = (truth, i) => (is_difference ? 0 : truth.mask[i]);
  const bands = truths
    .filter(({ error }) => error)
    .map((truth) => ({
      y1: at((i) => share(center(truth, i) - standardErrors * truth.error[i])),
      y2: at((i) => share(center(truth, i) + standardErrors * truth.error[i])),
    }));
  const lines = techniques.map(({ side, color }) => ({
    color,
    y: at((i) => side.mask[i] - (is_difference ? side.truth.mask[i] : 0)),
  }));
  const largest = Math.max(
    0.001,
    ...[...lines.map(({ y }) => y), ...bands.map(({ y2 }) => y2)].flatMap((of) =>
      samples.map((sample) => Math.abs(of(sample))).filter(Number.isFinite),
    ),
  );
  const domain = is_difference ? [-1.05 * largest, 1.05 * largest] : [-0.02, 1.02];
  const edge = { stroke: "var(--ink)", strokeOpacity: 0.45, strokeWidth: 0.75 };
  const inkOf = (k) => ({ stroke: "var(--ink)", strokeWidth: 1.6, strokeDasharray: k ? "5 4" : null });
  return plot({
    ...plotFrame(width),
    height: Math.max(260, Math.min(360, width * 0.4)),
    x: {
      label: "distance along the line (pixels) \u2192",
      labelAnchor: "right",
      labelArrow: "none",
      grid: true,
      domain: [0, samples.at(-1).distance || 1],
    },
    y: {
      label: is_difference ? "\u2191 share of the light, less the reference's" : "\u2191 share of the light that is seen",
      labelArrow: "none",
      grid: true,
      domain,
    },
    marks: [
      ruleY([0], { stroke: "var(--ink)", strokeOpacity: is_difference ? 0.9 : 0.35 }),
      ...bands.map((band) => areaY(samples, { x, ...band, fill: "var(--ink)", fillOpacity: 0.22 })),
      ...bands.flatMap(({ y1, y2 }) => [y1, y2].map((y) => lineY(samples, { x, y, ...edge }))),
      ...(is_difference ? [] : truths.map(({ mask }, k) => lineY(samples, { x, y: at((i) => mask[i]), ...inkOf(k) }))),
      ...lines.map(({ y, color }) => lineY(samples, { x, y, stroke: color, strokeWidth: 1.8 })),
      ruleX(samples, pointerX({ x, stroke: "var(--ink)", strokeOpacity: 0.5 })),
      tip(
        samples,
        pointerX({
          x,
          y: at((i) => (is_difference ? 0 : truths[0].mask[i])),
          title: (sample) => saysOf(frame, sample, techniques, truths).join("\n"),
          fontSize: 12,
          lineWidth: 30,
        }),
      ),
    ],
  });
}

function saysOf(frame, { x, y, i, distance }, techniques, truths) {
  const info = data.classes[frame.classes[i]];
  const digits = frame.is_soft ? 4 : 2;
  return [
    `${distance.toFixed(1)} pixels: ${x}, ${y} (${info.word})`,
    ...techniques.map(
      ({ side, name }) => `${name}: ${side.mask[i].toFixed(digits)} (${signed(side.mask[i] - side.truth.mask[i], digits)})`,
    ),
    ...truths.map(
      ({ name, mask, error }) =>
        `${name}: ${mask[i].toFixed(digits)}${error ? ` \u00b1 ${(standardErrors * error[i]).toFixed(digits)}` : ""}`,
    ),
  ];
}

function captionOf(frame, samples, { truths }) {
  return [
    "One value for each pixel on the line.",
    samples.some(({ i }) => !isFacing(frame, i)) && "Gaps: background, or a surface turned away from the light.",
    truths.length > 1 && "Dashed: the reference of B, which estimates the other number.",
    !truths.some(({ error }) => error) && "The reference of a light without area is exact but for class U.",
  ]
    .filter(Boolean)
    .join(" ");
}
