// The image comparer: two answers under one scene and light, beside each other, in turn, or as their difference.

import { Beside, noChoice } from "./beside.js";
import { ComparerAddress } from "./comparer_address.js";
import * as compose from "./compose.js";
import { drawContours, inks } from "./contours.js";
import { data, distinct } from "./data.js";
import { Divider } from "./divider.js";
import { canvasOf, chooser, h, list, toggle } from "./dom.js";
import { suggestedLine } from "./line_pixels.js";
import { LineTool } from "./line_tool.js";
import { contourLegend, legendOf, toneLegend } from "./picture_legend.js";
import { placesOf, readPlace, rowsOf } from "./place_pictures.js";
import { Profile } from "./profile.js";
import { readOut } from "./read_out.js";
import { Tone } from "./tone.js";
import { Viewport, zoomButtons } from "./viewport.js";

const modes = [
  { name: "wipe", text: "Wipe", a: true, b: true },
  { name: "flicker", text: "Flicker", a: true, b: true },
  { name: "beside", text: "Side by side", a: true, b: true },
  { name: "difference", text: "Difference", a: true, b: true },
  { name: "error", text: "Error", a: true, b: false },
  { name: "causes", text: "Error causes", a: true, b: false },
  { name: "classes", text: "Pixel classes", a: false, b: false },
];
const referenceChoice = "reference";
const flickerPeriod = 650;

class Comparer {
  constructor(section, groups) {
    this.mode = modes[0];
    this.is_shaded = true;
    this.shows_all_light = false;
    this.shows_b = false;
    this.has_contours = false;
    this.switches = {};
    this.is_running = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    const load = () => this.load();
    this.where = chooser("picture", groups.flatMap(placesOf), () => this.choose(), "scene and light");
    this.a = chooser("a", [], load, "A");
    this.b = chooser("b", [], load, "B");
    const scales = data.signed.scales.map((scale) => ({ value: String(scale), text: `\u00b1${scale}` }));
    this.scale = chooser("scale", scales, () => this.compose(), "colors end at");
    this.tone = new Tone(() => this.compose());
    this.divider = new Divider(() => {
      this.view?.draw();
      this.address?.keep();
    });
    this.line = new LineTool(() => this.profileLine());
    this.profile = new Profile((pixel) => this.mark(pixel), () => this.address?.keep());
    this.view = new Viewport({
      paint: (context, view) => this.paint(context, view),
      onpixel: (pixel) => (this.beside ? this.beside.choose(this.view, pixel) : this.read(pixel)),
      label:
        "Picture. Arrow keys choose a pixel, plus and minus zoom, 0 fits, 1 shows pixels one to one. " +
        "With the profile on, P puts the ends of its line in turn.",
    });
    this.beside = new Beside(this.view, {
      paint: (k, context, view) => this.paintOne(k, context, view),
      read: (pixel) => this.read(pixel),
      load,
      onkeep: () => this.address?.keep(),
    });
    this.view.onzoom = () => {
      this.beside.follow(this.view);
      this.zoomed.textContent = `${Math.round(100 * this.view.zoom)} %`;
      this.address?.keep();
    };
    this.zoomed = h("output", { class: "zoom" }, "");
    this.labels = h("div", { class: "labels", "aria-hidden": "true" });
    this.pause = h("button", { type: "button", onclick: () => this.setRunning(!this.is_running) });
    this.swap = h("button", { type: "button", onclick: () => this.flip() }, "Swap");
    this.flickers = h("span", { class: "group" }, this.pause, this.swap);
    this.legend = h("ul", { class: "swatches", "aria-label": "Colors of the picture" });
    this.readout = h("dl", { class: "readout", "aria-live": "polite" });
    this.problem = h("p", { class: "notice", hidden: true });
    this.view.element.append(this.divider.element, this.labels);
    section.append(...this.bars(), this.problem, this.beside.element, this.readout, this.legend, this.profile.element);
    this.setRunning(this.is_running);
    this.setMode(modes[0]);
    this.choose();
    this.address = new ComparerAddress(this, modes);
    setInterval(() => this.mode.name === "flicker" && this.is_running && this.flip(), flickerPeriod);
  }

  bars() {
    const mode = (info) => {
      const choice = { value: info.name, checked: info === this.mode, onchange: () => this.setMode(info) };
      return h("label", {}, h("input", { type: "radio", name: "mode", ...choice }), h("span", {}, info.text));
    };
    const switchOf = (member, label) => {
      const change = (on) => {
        this[member] = on;
        this.setMode(this.mode);
      };
      return (this.switches[member] = toggle(label, change, this[member]));
    };
    const has_all_light = data.rows.some((row) => row.pictures?.global !== undefined);
    return [
      h("div", { class: "bar" }, this.where.element, this.a.element, this.b.element, this.beside.lists.map((list) => list.element)),
      h(
        "div",
        { class: "bar" },
        (this.modes = h("fieldset", { class: "modes" }, h("legend", { class: "hidden" }, "How to compare"), modes.map(mode))),
        this.scale.element,
        this.flickers,
        switchOf("is_shaded", "shaded"),
        this.tone.elements,
        has_all_light && switchOf("shows_all_light", "all light"),
        switchOf("has_contours", "contours"),
        (this.profiled = toggle("profile", (on) => this.setProfile(on))),
        h("span", { class: "group zooms" }, zoomButtons(this.view, this.zoomed)),
      ),
    ];
  }

  get group() {
    return Number(this.where.value.split(":")[0]);
  }

  /** Which of several lights is shown alone; null: all together. */
  get light() {
    const [, light] = this.where.value.split(":");
    return light === undefined ? null : Number(light);
  }

  /** Offers the rows of another scene and light. Keeps the chosen titles where they are available, too, unless `a` is a row. */
  choose(a = null) {
    const rows = rowsOf(this.group);
    const optionOf = (row) => ({ value: String(row.index), text: row.title });
    const options = [{ value: referenceChoice, text: "reference" }, ...rows.map(optionOf)];
    const kept = ({ select }) => options.find(({ text }) => text === select.selectedOptions[0]?.textContent)?.value;
    const contender = rows.find((row) => row.role === "contender") ?? rows[0];
    this.a.set(options, String(a ?? kept(this.a) ?? contender.index));
    this.beside.offer(options);
    this.b.set(options, a !== null ? referenceChoice : (kept(this.b) ?? referenceChoice));
    this.load();
  }

  /** Shows a row against the reference. */
  open(row) {
    this.where.value = String(row.group);
    this.choose(row.index);
  }

  /** Turns a switch as a click would, but shows nothing yet. */
  setSwitch(member, is_on) {
    this[member] = is_on;
    const box = this.switches[member]?.querySelector("input");
    if (box) box.checked = is_on;
  }

  setMode(mode) {
    this.mode = mode;
    this.modes.querySelector(`input[value=${mode.name}]`).checked = true;
    // Contours are those of the compared sides, and of A over other pictures; the profile is of both.
    this.a.select.disabled = !mode.a && !this.has_contours && !this.line.is_on;
    this.b.select.disabled = !mode.b && !this.line.is_on;
    this.scale.element.hidden = mode.name !== "difference";
    this.divider.element.hidden = mode.name !== "wipe";
    this.flickers.hidden = mode.name !== "flicker";
    this.compose();
  }

  setRunning(is_running) {
    this.is_running = is_running;
    this.pause.textContent = is_running ? "Pause" : "Run";
  }

  flip() {
    this.shows_b = !this.shows_b;
    this.label();
    this.view.draw();
  }

  /** Shows or hides the line and its profile. */
  setProfile(is_on) {
    this.line.is_on = this.profiled.querySelector("input").checked = is_on;
    this.view.tool = is_on ? this.line : null;
    this.view.element.classList.toggle("drawing", is_on);
    this.setMode(this.mode);
    this.profileLine();
  }

  /** Shows the profile of the line. A place without a line gets the suggested one. */
  profileLine() {
    const { frame, line } = this;
    if (!frame) return;
    if (line.is_on && (!line.line || line.place !== frame.place)) {
      line.place = frame.place;
      line.line = suggestedLine(frame, this.sideA.reference, (i) => compose.isFacing(frame, i));
    }
    this.mark(null);
    this.profile.set(frame, this.sideA, this.sideB, line.is_on ? line.line : null);
    this.address?.keep();
  }

  /** Marks and reads the pixel of the line that is under the pointer in the profile. */
  mark(pixel) {
    this.line.marked = pixel;
    this.view.draw();
    if (pixel) this.read(pixel);
  }

  /** Reads the pictures of the choices; when several loads are under way, the last one is shown. */
  async load() {
    const turn = (this.turn = (this.turn ?? 0) + 1);
    const further = this.beside.lists.filter(({ value }) => value !== noChoice);
    const choices = [this.a, this.b, ...further].map(({ value }) => (value === referenceChoice ? null : data.rows[Number(value)]));
    try {
      const { frame, sides } = await readPlace(this.group, this.light, choices);
      if (turn !== this.turn) return;
      this.frame = frame;
      [this.sideA, this.sideB] = sides;
      this.further = sides.slice(2);
      this.problem.hidden = true;
      this.view.setSize(frame.width, frame.height);
      this.address?.showView(this.view);
      this.compose();
      this.profileLine();
    } catch (error) {
      if (turn !== this.turn) return;
      this.problem.hidden = false;
      this.problem.textContent = `This picture cannot be shown: ${error.message}`;
    }
  }

  /** Makes the pictures that the mode shows. */
  compose() {
    if (!this.frame) return;
    const { frame, sideA, sideB } = this;
    const { gain, is_false } = this.tone;
    const plain = is_false ? compose.inFalseColors : this.is_shaded ? compose.shaded : compose.maskOnly;
    const make = {
      difference: () => compose.difference(frame, sideA.mask, sideB.mask, Number(this.scale.value)),
      error: () => compose.errors(frame, sideA, null),
      causes: () => compose.errors(frame, sideA, sideA.causes),
      classes: () => compose.classes(frame),
    }[this.mode.name];
    const made = make?.() ?? null;
    const show = (side) => (this.isInAllLight(side) ? compose.colored(frame, side.global, gain) : plain(frame, side.mask, gain));
    this.tone.offer(!made);
    const sides = [sideA, sideB, ...(this.mode.name === "beside" ? this.further : [])];
    this.pictures = made ? [canvasOf(made.image)] : sides.map((side) => canvasOf(show(side)));
    this.showLegend(made);
    this.label();
    this.read(this.view.pixel);
    this.view.draw();
    this.address?.keep();
  }

  /** Whether a side is shown in all light: the toggle is on, false colors are not, and the side has that picture. */
  isInAllLight(side) {
    return this.shows_all_light && !this.tone.is_false && Boolean(side.global);
  }

  label() {
    if (!this.frame) return;
    // The reference's title names the share that its mask is; its picture of all light is no share.
    const shown = (side) => (this.isInAllLight(side) ? `${side.row?.title ?? "reference"}, all light` : side.title);
    const tags = {
      wipe: [`A  ${shown(this.sideA)}`, `B  ${shown(this.sideB)}`],
      beside: [`A  ${shown(this.sideA)}`],
      flicker: [this.shows_b ? `B  ${shown(this.sideB)}` : `A  ${shown(this.sideA)}`],
      difference: [`A  ${this.sideA.title}  less  B  ${this.sideB.title}`],
      error: [`${this.sideA.title}  less the reference`],
      causes: [this.sideA.title],
      classes: [],
    }[this.mode.name];
    const others = this.mode.name === "beside" ? [this.sideB, ...this.further] : [];
    this.beside.show(others.map(shown), this.frame.width, this.frame.height);
    this.labels.replaceChildren(...tags.map((tag) => h("span", {}, tag)));
  }

  showLegend(made) {
    const entries = [
      ...(made ? legendOf(this.mode.name, this.frame, this.sideA, made, Number(this.scale.value)) : toneLegend(this.tone)),
      ...(this.has_contours ? contourLegend(this.contoured().flat()) : []),
    ];
    this.legend.replaceChildren(...entries);
    this.legend.hidden = entries.length === 0;
  }

  /** Shows the values at a pixel. */
  read(pixel) {
    const values = readOut(pixel, this.frame, this.sideA, this.sideB, this.mode.name === "beside" ? this.further : []);
    this.readout.replaceChildren(...values.map(([name, text]) => h("div", {}, h("dt", {}, name), h("dd", {}, text))));
  }

  /** The masks with contours over the pictures, one list for each picture: the references' below those of techniques. */
  contoured() {
    const ofTruth = ({ name, mask }) => ({ title: name, mask, ink: inks.reference });
    const ofSide = (side) => ({ title: side.title, mask: side.mask, ink: side === this.sideA ? inks.a : inks.b });
    const of = (...sides) => [
      ...distinct(sides.map(({ truth }) => truth)).map(ofTruth),
      ...sides.filter(({ row }) => row).map(ofSide),
    ];
    if (this.pictures.length > 1) return [this.sideA, this.sideB, ...this.further].map((side) => of(side));
    return [this.mode.b ? of(this.sideA, this.sideB) : of(this.sideA)];
  }

  /** Draws one of the pictures with its contours. */
  paintOne(k, context, view) {
    const picture = this.pictures?.[k];
    if (!picture) return;
    context.drawImage(picture, view.x, view.y, view.scale * picture.width, view.scale * picture.height);
    const contours = this.has_contours ? (this.contoured()[k] ?? []) : [];
    for (const { mask, ink } of contours) drawContours(context, view, this.frame, mask, ink);
  }

  paint(context, view) {
    if (!this.pictures) return;
    const { width, height } = view;
    const whole = (k) => this.paintOne(k, context, view);
    const clipped = (from, to, k) => {
      context.save();
      context.beginPath();
      context.rect(from, 0, to - from, height);
      context.clip();
      whole(k);
      context.restore();
    };
    if (this.mode.name === "wipe") {
      const split = Math.round(this.divider.share * width);
      clipped(0, split, 0);
      clipped(split, width, 1);
    } else whole(this.mode.name === "flicker" && this.shows_b ? 1 : 0);
    if (this.line.is_on) this.line.draw(context, view);
  }
}

/** Builds the section; `open(row)` of what it returns shows a row. */
export function showComparer(section) {
  const groups = data.groups.map((_, index) => index).filter((index) => data.groups[index].pictures);
  if (groups.length > 0) return new Comparer(section, groups);
  const why = data.notes.length > 0 ? data.notes : ["no row of this run has a mask"];
  section.append(h("p", { class: "notice" }, "There are no pictures to compare."), list({ class: "why-not" }, why));
  return { open() {} };
}
