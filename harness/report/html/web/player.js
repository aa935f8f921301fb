// The player: a row on a path, frame by frame, with its errors and the course of one pixel in time.

import { frames as framesOf } from "./blobs.js";
import * as compose from "./compose.js";
import { Course } from "./course.js";
import { clamp, data, groupName, isOk, isSoft } from "./data.js";
import { chooser, h } from "./dom.js";
import { legendOf } from "./picture_legend.js";
import { Viewport } from "./viewport.js";

const shown = [
  { value: "mask", text: "technique" },
  { value: "reference", text: "reference" },
  { value: "difference", text: "technique less reference" },
];
const speeds = [1, 1 / 2, 1 / 4, 1 / 8, 1 / 16].map((speed) => ({
  value: String(speed),
  text: speed === 1 ? "1" : `1/${1 / speed}`,
}));

/** A pixel's class from the reference's alpha, of which the program writes three values. */
const classNumber = (name) => data.classes.findIndex((info) => info.name === name);
const classOfAlpha = { 0: classNumber("B"), 128: classNumber("G"), 255: classNumber("T") };

/** A row's frames, unpacked: shares of frame `k` are bytes of 1/255. */
class Film {
  constructor(row, mask, reference) {
    const { width, height } = data.groups[row.group];
    const { numbers, start, frame_rate } = row.kept_frames;
    Object.assign(this, { row, width, height, numbers, start, frame_rate, mask, reference });
    this.pixels = width * height;
    this.count = numbers.length;
  }

  /** The bytes of one frame. */
  maskAt(k) {
    return this.mask.subarray(k * this.pixels, (k + 1) * this.pixels);
  }
  referenceAt(k) {
    return this.reference.subarray(2 * k * this.pixels, (2 * k + 1) * this.pixels);
  }
  alphaAt(k) {
    return this.reference.subarray((2 * k + 1) * this.pixels, (2 * k + 2) * this.pixels);
  }

  /** Seconds from frame 0 to the frame. */
  secondsTo(k) {
    return this.numbers[k] / this.frame_rate;
  }

  /** The last frame that is no later than so many seconds after frame 0. */
  frameAt(seconds) {
    const next = this.numbers.findIndex((number) => number / this.frame_rate > seconds + 1e-9);
    return next === -1 ? this.count - 1 : Math.max(0, next - 1);
  }

  /** How long the whole takes; the last frame is shown as long as one frame lasts. */
  get seconds() {
    return (this.numbers.at(-1) + 1) / this.frame_rate;
  }

  /** A frame as compose.js takes it: of what is shown nothing is there but its class. */
  frame(k) {
    const alpha = this.alphaAt(k);
    const classes = Uint8Array.from(alpha, (value) => classOfAlpha[value] ?? classOfAlpha[0]);
    const lit = (this.white ??= new Uint8Array(3 * this.pixels).fill(255));
    return { width: this.width, height: this.height, is_soft: isSoft(this.row), lit, classes };
  }
}

const shares = (bytes) => Float32Array.from(bytes, (value) => value / 255);

class Player {
  constructor(section, rows) {
    this.rows = rows;
    this.number = 0;
    this.picked = null;
    const nameOf = (row) => `${groupName(row.group)} \u00b7 ${row.title}`;
    this.which = chooser("played", rows.map((row) => ({ value: String(row.index), text: nameOf(row) })), () => this.load(), "row");
    this.shows = chooser("frames-of", shown, () => this.draw(), "shows");
    this.ends = chooser(
      "frames-scale",
      data.signed.scales.map((scale) => ({ value: String(scale), text: `\u00b1${scale}` })),
      () => this.draw(),
      "colors end at",
    );
    this.speed = chooser("speed", speeds, () => this.restart(), "speed");
    const button = (text, label, act) => h("button", { type: "button", "aria-label": label, title: label, onclick: act }, text);
    this.play = h("button", { type: "button", class: "play", onclick: () => this.setPlaying(!this.is_playing) }, "Play");
    this.slider = h("input", { type: "range", min: 0, step: 1, "aria-label": "Frame", oninput: () => this.scrub() });
    this.place = h("output", { class: "time" }, "");
    const steps = [
      this.play,
      button("\u2039", "One frame back", () => this.step(-1)),
      button("\u203a", "One frame on", () => this.step(1)),
    ];
    this.view = new Viewport({
      name: "screen",
      paint: (context, view) => this.paint(context, view),
      onpixel: (pixel) => this.read(pixel),
      label:
        "Frame. Space plays and pauses, comma and period step, Home and End go to the first and the last frame. " +
        "Arrow keys choose a pixel, a click, too; plus and minus zoom, 0 fits.",
    });
    this.values = h("p", { class: "values", "aria-live": "off" });
    this.legend = h("ul", { class: "swatches", "aria-label": "Colors of the frame", hidden: true });
    this.course = new Course((k) => this.go(k));
    this.reason = h("p", { class: "why-not", hidden: true });
    this.content = h(
      "div",
      {},
      h("div", { class: "bar" }, this.shows.element, this.ends.element, this.speed.element),
      h("div", { class: "bar" }, h("span", { class: "group" }, steps), this.slider, this.place),
      this.view.element,
      this.values,
      this.legend,
      this.course.element,
    );
    this.which.element.classList.add("wide");
    const bar = h("div", { class: "bar" }, this.which.element);
    const lead = h("p", { class: "lead" }, "What a row answers from frame to frame, beside the reference.");
    section.append(h("article", { class: "card player" }, h("h3", {}, "Frames"), lead, bar, this.reason, this.content));
    this.content.addEventListener("keydown", (event) => this.key(event));
    this.listenForPicks();
    this.ends.element.hidden = true;
    this.read(null);
    this.prepare();
    // Frames are large: they are read when they come into view.
    const watch = new IntersectionObserver((entries) => {
      if (!entries.some((entry) => entry.isIntersecting)) return;
      watch.disconnect();
      if (!this.turn) this.load();
    });
    watch.observe(this.content);
  }

  get row() {
    return data.rows[Number(this.which.value)];
  }

  /** Shows another row, if it is on a path. */
  open(row) {
    if (!this.rows.includes(row)) return;
    this.which.value = String(row.index);
    this.load();
  }

  refuse(reason) {
    this.reason.hidden = !reason;
    this.content.hidden = Boolean(reason);
    this.reason.textContent = reason ? `There are no frames to play: ${reason}.` : "";
  }

  /** Shows why there are no frames, or has room for them, so that nothing moves when they are there. Returns whether there are some. */
  prepare() {
    const { width, height } = data.groups[this.row.group];
    this.refuse(this.row.kept_frames.reason);
    if (!this.row.kept_frames.reason) this.view.setSize(width, height);
    return !this.row.kept_frames.reason;
  }

  /** Reads the frames of the chosen row; when several loads are under way, the last one is shown. */
  async load() {
    const turn = (this.turn = (this.turn ?? 0) + 1);
    const { row } = this;
    this.setPlaying(false);
    this.film = null;
    if (!this.prepare()) return;
    const { mask, reference } = row.kept_frames;
    const { width, height } = data.groups[row.group];
    try {
      const films = await Promise.all([framesOf(mask, width * height), framesOf(reference, 2 * width * height)]);
      if (turn !== this.turn) return;
      this.film = new Film(row, ...films);
      this.slider.max = this.film.count - 1;
      const inside = ({ x, y }) => x < width && y < height;
      this.picked = this.picked && inside(this.picked) ? this.picked : null;
      this.go(Math.min(this.number, this.film.count - 1));
      this.showCourse();
    } catch (error) {
      if (turn === this.turn) this.refuse(`they cannot be read: ${error.message}`);
    }
  }

  /** Shows a frame. */
  go(number) {
    if (!this.film) return;
    this.number = clamp(number, 0, this.film.count - 1);
    this.slider.value = this.number;
    const { film } = this;
    const seconds = film.start === null ? "" : `, ${(film.start + film.secondsTo(this.number)).toFixed(3)} s`;
    this.place.textContent = `frame ${film.numbers[this.number]}${seconds}`;
    this.slider.setAttribute("aria-valuetext", this.place.textContent);
    this.course.setFrame(this.number);
    this.draw();
  }

  step(by) {
    this.setPlaying(false);
    this.go(this.number + by);
  }

  scrub() {
    this.setPlaying(false);
    this.go(Number(this.slider.value));
  }

  setPlaying(is_playing) {
    this.is_playing = is_playing && Boolean(this.film);
    this.play.textContent = this.is_playing ? "Pause" : "Play";
    cancelAnimationFrame(this.next);
    if (this.is_playing) this.restart();
  }

  /** Plays on from the present frame, by the clock: where drawing is slow, frames are passed over. The last one is followed by the first. */
  restart() {
    if (!this.is_playing) return;
    cancelAnimationFrame(this.next);
    const { film } = this;
    const speed = Number(this.speed.value);
    const begun = performance.now() - (1000 * film.secondsTo(this.number)) / speed;
    const tick = () => {
      const k = film.frameAt((((performance.now() - begun) / 1000) * speed) % film.seconds);
      if (k !== this.number) this.go(k);
      this.next = requestAnimationFrame(tick);
    };
    this.next = requestAnimationFrame(tick);
  }

  /** Makes the picture of the frame. */
  draw() {
    const { film, number } = this;
    if (!film) return;
    const mode = this.shows.value;
    this.ends.element.hidden = mode !== "difference";
    const frame = film.frame(number);
    const ends = Number(this.ends.value);
    const [mask, reference] = [film.maskAt(number), film.referenceAt(number)].map(shares);
    const made = mode === "difference" ? compose.difference(frame, mask, reference, ends) : null;
    const image = made?.image ?? compose.maskOnly(frame, mode === "mask" ? mask : reference);
    this.picture ??= h("canvas");
    if (this.picture.width !== film.width || this.picture.height !== film.height)
      Object.assign(this.picture, { width: film.width, height: film.height });
    this.picture.getContext("2d").putImageData(image, 0, 0);
    this.legend.replaceChildren(...(made ? legendOf("difference", frame, null, made, ends) : []));
    this.legend.hidden = !made;
    this.read(this.view.pixel);
    this.view.draw();
  }

  /** Shows the values at a pixel. */
  read(pixel) {
    const { film, number } = this;
    const at = pixel ?? this.picked;
    if (!film || !at) return void (this.values.textContent = "Click a pixel for its course in time.");
    const i = at.y * film.width + at.x;
    const [v, reference] = [film.maskAt(number)[i], film.referenceAt(number)[i]].map((value) => (value / 255).toFixed(3));
    const alpha = film.alphaAt(number)[i];
    const what = alpha === 255 ? "tested" : alpha === 128 ? "not tested" : "does not face the light";
    this.values.textContent = `pixel ${at.x}, ${at.y}: technique ${v}, reference ${reference}, ${what}`;
  }

  /** A click picks a pixel, and so do the keys that choose one; a drag moves the picture. */
  listenForPicks() {
    const { canvas } = this.view;
    let from = null;
    canvas.addEventListener("pointerdown", (event) => (from = { x: event.clientX, y: event.clientY }));
    canvas.addEventListener("click", (event) => {
      const is_drag = from && Math.hypot(event.clientX - from.x, event.clientY - from.y) > 4;
      if (!is_drag) this.pick(this.view.pixelAt(this.view.position(event)));
    });
    canvas.addEventListener("keydown", (event) => event.key.startsWith("Arrow") && this.pick(this.view.pixel));
  }

  pick(pixel) {
    if (!this.film || !pixel) return;
    this.picked = this.view.inside(pixel);
    this.read(this.picked);
    this.showCourse();
    this.view.draw();
  }

  showCourse() {
    this.course.set(this.film, this.picked);
    this.course.setFrame(this.number);
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const is_control = ["BUTTON", "SELECT"].includes(event.target.tagName);
    const act = {
      " ": !is_control && (() => this.setPlaying(!this.is_playing)),
      ",": () => this.step(-1),
      ".": () => this.step(1),
      Home: () => this.step(-Infinity),
      End: () => this.step(Infinity),
    }[event.key];
    if (!act || (event.target.tagName === "SELECT" && event.key.length > 1)) return;
    event.preventDefault();
    act();
  }

  paint(context, { scale, x, y }) {
    if (!this.picture || !this.film) return;
    context.drawImage(this.picture, x, y, scale * this.picture.width, scale * this.picture.height);
    if (!this.picked) return;
    const side = Math.max(scale, 8);
    const [left, top] = [x + (this.picked.x + 0.5) * scale - side / 2, y + (this.picked.y + 0.5) * scale - side / 2];
    for (const [color, outset] of [["#000", 1.5], ["#fff", 0.5]]) {
      context.strokeStyle = color;
      context.lineWidth = 1;
      context.strokeRect(left - outset, top - outset, side + 2 * outset, side + 2 * outset);
    }
  }
}

/** Adds the player where rows are on paths; `open(row)` of what it returns shows a row. */
export function showPlayer(section) {
  const rows = data.rows.filter((row) => isOk(row) && row.kept_frames);
  return rows.length > 0 ? new Player(section, rows) : { open() {} };
}
