// The image comparer: one scene and light, two answers side by side, over each other, or against each other.

import { blob, colors } from "./blobs.js";
import * as compose from "./compose.js";
import { data, groupName, isOk } from "./data.js";
import { Divider } from "./divider.js";
import { chooser, h, toggle } from "./dom.js";
import { legendOf } from "./picture_legend.js";
import { Viewport } from "./viewport.js";

const modes = [
  { name: "wipe", text: "Wipe", a: true, b: true },
  { name: "flicker", text: "Flicker", a: true, b: true },
  { name: "difference", text: "Difference", a: true, b: true },
  { name: "error", text: "Error", a: true, b: false },
  { name: "causes", text: "Error causes", a: true, b: false },
  { name: "classes", text: "Pixel classes", a: false, b: false },
];
const referenceChoice = "reference";
const flickerPeriod = 650;
const words = (name) => name.replaceAll("_", " ");

function canvasOf(image) {
  const canvas = document.createElement("canvas");
  canvas.width = image.width;
  canvas.height = image.height;
  canvas.getContext("2d").putImageData(image, 0, 0);
  return canvas;
}

class Comparer {
  constructor(section, groups) {
    this.mode = modes[0];
    this.is_shaded = true;
    this.shows_b = false;
    this.is_running = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    const load = () => this.load();
    this.where = chooser(
      "scene and light",
      groups.map((group) => ({ value: String(group), text: groupName(group) })),
      () => this.choose(),
      { name: "picture" },
    );
    this.a = chooser("A", [], load, { name: "a" });
    this.b = chooser("B", [], load, { name: "b" });
    this.divider = new Divider(() => this.view?.draw());
    this.view = new Viewport({
      paint: (context, view) => this.paint(context, view),
      onpixel: (pixel) => this.read(pixel),
      label: "Picture. Arrow keys choose a pixel, plus and minus zoom, 0 fits, 1 shows pixels one to one.",
    });
    this.view.onzoom = () => (this.zoomed.textContent = `${Math.round(100 * this.view.zoom)} %`);
    this.zoomed = h("output", { class: "zoom" }, "");
    this.labels = h("div", { class: "labels", "aria-hidden": "true" });
    this.pause = h("button", { type: "button", onclick: () => this.setRunning(!this.is_running) });
    this.swap = h("button", { type: "button", onclick: () => this.flip() }, "Swap");
    this.flickers = h("span", { class: "group" }, this.pause, this.swap);
    this.legend = h("ul", { class: "swatches", "aria-label": "Colors of the picture" });
    this.readout = h("dl", { class: "readout", "aria-live": "polite" });
    this.problem = h("p", { class: "notice", hidden: true });
    this.view.element.append(this.divider.element, this.labels);
    section.append(...this.bars(), this.problem, this.view.element, this.readout, this.legend);
    this.setRunning(this.is_running);
    this.setMode(modes[0]);
    this.choose();
    setInterval(() => this.mode.name === "flicker" && this.is_running && this.flip(), flickerPeriod);
  }

  bars() {
    const mode = (info) => {
      const input = h("input", {
        type: "radio",
        name: "mode",
        value: info.name,
        checked: info === this.mode,
        onchange: () => this.setMode(info),
      });
      return h("label", {}, input, h("span", {}, info.text));
    };
    const zoom = (text, label, act) => h("button", { type: "button", title: label, "aria-label": label, onclick: act }, text);
    return [
      h("div", { class: "bar" }, this.where.element, this.a.element, this.b.element),
      h(
        "div",
        { class: "bar" },
        h("fieldset", { class: "modes" }, h("legend", { class: "hidden" }, "How to compare"), modes.map(mode)),
        this.flickers,
        toggle("shaded", true, (on) => ((this.is_shaded = on), this.load())),
        h(
          "span",
          { class: "group zooms" },
          zoom("\u2212", "Zoom out", () => this.view.zoomAtPixel(1 / 1.5)),
          this.zoomed,
          zoom("+", "Zoom in", () => this.view.zoomAtPixel(1.5)),
          zoom("Fit", "Fit the whole picture", () => this.view.fit()),
          zoom("1:1", "One to one", () => this.view.zoomTo(1)),
          zoom("8:1", "Pixels as squares of eight", () => this.view.zoomTo(8)),
        ),
      ),
    ];
  }

  get group() {
    return Number(this.where.value);
  }

  rows(group = this.group) {
    return data.rows.filter((row) => row.group === group && row.pictures);
  }

  /** Another scene and light: its rows to choose from, the chosen ones kept where they are there too. */
  choose(a = null) {
    const titles = (list) => list.select.selectedOptions[0]?.textContent;
    const before = { a: titles(this.a), b: titles(this.b) };
    const rows = this.rows();
    const options = [
      { value: referenceChoice, text: "reference" },
      ...rows.map((row) => ({ value: String(row.index), text: row.title })),
    ];
    const find = (title) => options.find((option) => option.text === title)?.value;
    const contender = rows.find((row) => row.role === "contender") ?? rows[0];
    this.a.set(options, a !== null ? String(a) : (find(before.a) ?? String(contender.index)));
    this.b.set(options, a !== null ? referenceChoice : (find(before.b) ?? referenceChoice));
    this.load();
  }

  /** Shows a row against the reference. */
  open(row) {
    this.where.value = String(row.group);
    this.choose(row.index);
  }

  setMode(mode) {
    this.mode = mode;
    this.a.select.disabled = !mode.a;
    this.b.select.disabled = !mode.b;
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

  /** Reads what the choices need; the last choice wins when several are under way. */
  async load() {
    const turn = (this.turn = (this.turn ?? 0) + 1);
    const group = this.group,
      { width, height, pictures, has_area } = data.groups[group];
    try {
      const [lit, dark, area, irradiance, classes] = await Promise.all([
        colors(pictures.lit),
        colors(pictures.dark),
        blob(pictures.reference),
        pictures.irradiance === null ? null : blob(pictures.irradiance),
        blob(pictures.classes),
      ]);
      const side = async (list) => {
        if (list.value === referenceChoice) return { title: "reference", mask: area, reference: area, causes: null, row: null };
        const row = data.rows[Number(list.value)];
        const [mask, causes] = await Promise.all([
          blob(row.pictures.mask),
          row.pictures.causes === null ? null : blob(row.pictures.causes),
        ]);
        const reference = (row.estimates === "irradiance" && irradiance) || area;
        return { title: row.title, mask, reference, causes, row };
      };
      const sides = await Promise.all([side(this.a), side(this.b)]);
      if (turn !== this.turn) return;
      this.frame = { width, height, is_soft: has_area, lit, dark, classes };
      [this.sideA, this.sideB] = sides;
      this.problem.hidden = true;
      this.view.setSize(width, height);
      this.compose();
    } catch (error) {
      if (turn !== this.turn) return;
      this.problem.hidden = false;
      this.problem.textContent = `This picture cannot be shown: ${error.message}`;
    }
  }

  /** Makes the pictures that the mode shows. */
  compose() {
    if (!this.frame) return;
    const { frame, sideA, sideB } = this,
      name = this.mode.name;
    const plain = this.is_shaded ? compose.shaded : compose.maskOnly;
    let made = null;
    if (name === "difference") made = compose.difference(frame, sideA.mask, sideB.mask);
    if (name === "error") made = compose.errors(frame, sideA, null);
    if (name === "causes") made = compose.errors(frame, sideA, sideA.causes);
    if (name === "classes") made = compose.classes(frame);
    this.pictures = made ? [canvasOf(made.image)] : [sideA, sideB].map((side) => canvasOf(plain(frame, side.mask)));
    this.showLegend(made);
    this.label();
    this.read(this.view.pixel);
    this.view.draw();
  }

  label() {
    if (!this.frame) return;
    const tags = {
      wipe: [`A  ${this.sideA.title}`, `B  ${this.sideB.title}`],
      flicker: [this.shows_b ? `B  ${this.sideB.title}` : `A  ${this.sideA.title}`],
      difference: [`A  ${this.sideA.title}  less  B  ${this.sideB.title}`],
      error: [`${this.sideA.title}  less the reference`],
      causes: [this.sideA.title],
      classes: [],
    }[this.mode.name];
    this.labels.replaceChildren(...tags.map((tag) => h("span", {}, tag)));
  }

  showLegend(made) {
    const entries = legendOf(this.mode.name, this.frame, this.sideA, made);
    this.legend.replaceChildren(...entries);
    this.legend.hidden = entries.length === 0;
  }

  /** What there is to know about one pixel. */
  read(pixel) {
    const dash = "-";
    const values = [
      ["pixel", dash],
      ["A", dash],
      ["B", dash],
      ["reference", dash],
      ["class", dash],
      ["cause in A", dash],
    ];
    if (pixel && this.frame) {
      const i = pixel.y * this.frame.width + pixel.x;
      const value = (mask) => (mask[i] / 255).toFixed(2);
      const info = data.classes[this.frame.classes[i]];
      const cause = this.sideA.causes?.[i]
        ? words(data.causes[this.sideA.causes[i] - 1].name)
        : this.sideA.causes
          ? "none"
          : dash;
      // Under a light with area how far it is off, else whether it is wrong.
      const judged = (side) => {
        const share = (side.mask[i] - side.reference[i]) / 255;
        if (this.frame.is_soft) return share === 0 ? "" : ` (${share > 0 ? "+" : "\u2212"}${Math.abs(share).toFixed(2)})`;
        return compose.isWrong(this.frame, side, i) ? " wrong" : "";
      };
      values[0][1] = `${pixel.x}, ${pixel.y}`;
      values[1][1] = value(this.sideA.mask) + judged(this.sideA);
      values[2][1] = value(this.sideB.mask) + judged(this.sideB);
      values[3][1] = value(this.sideA.reference);
      values[4][1] = `${info.name} ${info.word}`;
      values[5][1] = cause;
    }
    this.readout.replaceChildren(...values.map(([name, text]) => h("div", {}, h("dt", {}, name), h("dd", {}, text))));
  }

  paint(context, view) {
    if (!this.pictures) return;
    const { scale, x, y, width, height } = view;
    const whole = (picture) => context.drawImage(picture, x, y, scale * picture.width, scale * picture.height);
    if (this.mode.name !== "wipe") return whole(this.pictures[this.mode.name === "flicker" && this.shows_b ? 1 : 0]);
    const split = Math.round(this.divider.share * width);
    const clipped = (from, to, picture) => {
      context.save();
      context.beginPath();
      context.rect(from, 0, to - from, height);
      context.clip();
      whole(picture);
      context.restore();
    };
    clipped(0, split, this.pictures[0]);
    clipped(split, width, this.pictures[1]);
  }
}

/** Builds the section; `open(row)` of what it returns shows a row. */
export function showComparer(section) {
  const groups = data.groups.map((_, index) => index).filter((index) => data.groups[index].pictures);
  if (groups.length > 0) return new Comparer(section, groups);
  const why = data.notes.length > 0 ? data.notes : ["no row of this run has a mask"];
  section.append(
    h("p", { class: "notice" }, "There are no pictures to compare."),
    h(
      "ul",
      { class: "why-not" },
      why.map((note) => h("li", {}, note)),
    ),
  );
  return { open() {} };
}
