// The course of one pixel in time: what a technique and the reference say of it at every frame.

import { dot, line, plot, pointerX, ruleX, tip } from "@observablehq/plot";

import { acrossOptions, describe, frame as plotFrame, unname, upOptions } from "./axes.js";
import { clamp } from "./data.js";
import { h, onWidth } from "./dom.js";

const stroke = (color) => h("i", { class: "stroke", style: { background: color } });
const color = "var(--series-1)";

/** The values of a pixel by frame; NaN, a gap, where it does not face the light. */
function samplesOf(film, { x, y }) {
  const i = y * film.width + x;
  return film.numbers.map((number, k) => {
    const is_facing = film.alphaAt(k)[i] > 0;
    const share = (bytes) => (is_facing ? bytes[i] / 255 : NaN);
    const at = film.start === null ? number : film.start + film.secondsTo(k);
    return { k, number, at, mask: share(film.maskAt(k)), reference: share(film.referenceAt(k)) };
  });
}

/** The card below the player's picture. Calls `onframe(k)` with the frame that is clicked in the plot. */
export class Course {
  constructor(onframe) {
    this.onframe = onframe;
    this.figure = h("figure");
    this.key = h("ul", { class: "swatches", "aria-label": "Lines of the course" });
    this.lead = h("p", { class: "lead" });
    this.element = h("div", { class: "course", hidden: true }, h("h4", {}, "Course of a pixel"), this.lead, this.key, this.figure);
    this.width = 0;
    onWidth(this.figure, (width) => { this.width = width; this.redraw(); });
  }

  /** Null for no pixel. */
  set(film, pixel) {
    this.content = film && pixel ? { film, pixel, samples: samplesOf(film, pixel) } : null;
    this.element.hidden = !this.content;
    this.redraw();
  }

  /** Marks a frame. */
  setFrame(number) {
    this.number = number;
    this.mark?.(number);
  }

  redraw() {
    this.mark = null;
    if (!this.content || this.width === 0) return;
    const { film, pixel, samples } = this.content;
    this.lead.textContent = `Pixel ${pixel.x}, ${pixel.y}, ${film.row.title}`;
    this.key.replaceChildren(
      h("li", {}, stroke(color), "technique, in steps of 1/255"),
      h("li", {}, stroke("var(--ink)"), "reference, in steps of 1/255"),
    );
    const made = this.plotOf(samples, film.start === null ? "frame" : "time (s)");
    const svg = describe(made, "Course of the pixel over the frames");
    // At each move of the pointer the library draws the tip anew, with its names.
    new MutationObserver(() => unname(svg)).observe(svg, { childList: true, subtree: true });
    made.addEventListener("click", () => made.value && this.onframe(made.value.k));
    const gaps = samples.some(({ mask }) => Number.isNaN(mask)) ? " Gaps: the pixel shows nothing that faces the light." : "";
    const kept = film.count <= film.numbers.at(-1) ? ` Of ${film.numbers.at(-1) + 1} frames ${film.count} are kept.` : "";
    this.figure.replaceChildren(made, h("figcaption", {}, `Both are read from the pictures of the frames, of 8 bits.${kept}${gaps}`));
    this.setFrame(this.number ?? 0);
  }

  plotOf(samples, label) {
    const height = clamp(this.width * 0.3, 200, 300);
    const whole = label === "frame" ? { tickFormat: (value) => (Number.isInteger(value) ? String(value) : "") } : {};
    const made = plot({
      ...plotFrame(this.width, height),
      x: acrossOptions(label, { grid: false, ...whole }),
      y: upOptions("\u2191 share of the light that is seen", { domain: [-0.02, 1.02] }),
      marks: [
        line(samples, { x: "at", y: "reference", stroke: "var(--ink)", strokeWidth: 1.6 }),
        line(samples, { x: "at", y: "mask", stroke: color, strokeWidth: 1.8 }),
        dot(samples, { x: "at", y: "reference", fill: "var(--ink)", r: 2 }),
        dot(samples, { x: "at", y: "mask", fill: color, r: 2 }),
        ruleX(samples, pointerX({ x: "at", stroke: "var(--ink)", strokeOpacity: 0.4 })),
        tip(samples, pointerX({ x: "at", y: "mask", title: saysOf, fontSize: 12 })),
      ],
    });
    const across = made.scale("x");
    const rule = document.createElementNS("http://www.w3.org/2000/svg", "line");
    for (const [name, value] of Object.entries({ class: "now", y1: 20, y2: height - 46 })) rule.setAttribute(name, value);
    (made.localName === "svg" ? made : made.querySelector("svg")).append(rule);
    this.mark = (number) => {
      const place = across.apply(samples[clamp(number, 0, samples.length - 1)].at);
      for (const end of ["x1", "x2"]) rule.setAttribute(end, place);
    };
    return made;
  }
}

function saysOf({ number, mask, reference }) {
  if (Number.isNaN(mask)) return `frame ${number}: does not face the light`;
  const off = mask - reference;
  const signed = `${off < 0 ? "\u2212" : "+"}${Math.abs(off).toFixed(3)}`;
  return [`frame ${number}`, `technique: ${mask.toFixed(3)} (${signed})`, `reference: ${reference.toFixed(3)}`].join("\n");
}
