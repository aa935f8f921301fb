// A picture to look at closely: zoom by wheel, keys, buttons and two fingers, pan by dragging; pixels stay sharp squares.

import { clamp } from "./data.js";
import { h, screenRatio } from "./dom.js";

const largest = 64; // CSS pixels of a picture's pixel, at most

/**
 * `paint(context, view)` draws in screen pixels, view = {scale, x, y, width, height}: the picture's pixel (0, 0) is at x, y.
 * Calls `onpixel(pixel)` with the pixel {x, y} under the pointer, or null. A click or an arrow key keeps a pixel, which is the one
 * after the pointer has left; `onkeep(pixel)` is called with it. A `tool` takes the drags of one pointer unless Shift is held, and
 * keys of its own (see LineTool). `name` is the class of its element.
 */
export class Viewport {
  constructor({ paint, onpixel, label, name = "viewport" }) {
    this.paint = paint;
    this.onpixel = onpixel;
    this.size = { width: 1, height: 1 };
    this.canvas = h("canvas", { tabindex: "0", role: "img", "aria-label": label });
    this.element = h("div", { class: name }, this.canvas);
    this.pointers = new Map();
    this.pixel = null;
    this.kept = null;
    this.tool = null;
    this.listen();
    new ResizeObserver(() => this.resized()).observe(this.element);
  }

  /** A picture of another size; the same size keeps zoom and place. */
  setSize(width, height) {
    if (this.size.width === width && this.size.height === height) return;
    this.size = { width, height };
    this.pixel = this.kept = null; // those of another picture
    this.canvas.style.aspectRatio = `${width} / ${height}`;
    this.resized();
    this.is_resizing = true;
    this.fit();
    this.is_resizing = false;
  }

  resized() {
    const { clientWidth, clientHeight } = this.canvas;
    const [width, height] = [clientWidth, clientHeight].map((size) => Math.max(1, Math.round(size * screenRatio())));
    if (this.canvas.width === width && this.canvas.height === height) return;
    const was_fit = !this.view || this.is_fit;
    const [right, down] = [width - this.canvas.width, height - this.canvas.height];
    Object.assign(this.canvas, { width, height });
    this.is_resizing = true; // nobody zoomed
    if (was_fit) this.fit();
    else this.place(this.view.scale, this.view.x + right / 2, this.view.y + down / 2); // the same middle
    this.is_resizing = false;
  }

  get fitScale() {
    return Math.min(this.canvas.width / this.size.width, this.canvas.height / this.size.height);
  }

  /** CSS pixels of one picture pixel. */
  get zoom() {
    return this.view.scale / screenRatio();
  }

  /** The nearest scale that the picture may have. */
  scaleNear(scale) {
    return Math.min(Math.max(scale, this.fitScale), Math.max(largest * screenRatio(), this.fitScale));
  }

  fit() {
    this.place(this.fitScale, 0, 0);
  }

  /** Sets scale and origin, limited so that the picture fills the canvas. */
  place(wanted, left, top) {
    const { width, height } = this.canvas;
    const scale = this.scaleNear(wanted);
    this.is_fit = scale <= this.fitScale * 1.0001;
    const limited = (origin, room, extent) => (extent <= room ? (room - extent) / 2 : clamp(origin, room - extent, 0));
    const x = limited(left, width, scale * this.size.width);
    const y = limited(top, height, scale * this.size.height);
    this.view = { scale, x, y, width, height };
    this.canvas.classList.toggle("zoomed", !this.is_fit);
    this.onzoom?.();
    this.draw();
  }

  /** Zooms by a factor about the canvas point (x, y), by default the middle. */
  zoomBy(factor, x = this.canvas.width / 2, y = this.canvas.height / 2) {
    const { scale, x: left, y: top } = this.view;
    const next = this.scaleNear(scale * factor);
    this.place(next, x - ((x - left) / scale) * next, y - ((y - top) / scale) * next);
  }

  /** Shows a picture pixel on `zoom` CSS pixels. */
  zoomTo(zoom) {
    this.zoomAtPixel((zoom * screenRatio()) / this.view.scale);
  }

  /** What `showAt` takes: CSS pixels of a picture's pixel, and the point of the picture in the middle. */
  get middle() {
    const { scale, x, y, width, height } = this.view;
    return { zoom: this.zoom, x: (width / 2 - x) / scale, y: (height / 2 - y) / scale };
  }

  /** Shows the picture's point (x, y) in the middle, its pixels on `zoom` CSS pixels. */
  showAt({ zoom, x, y }) {
    const scale = this.scaleNear(zoom * screenRatio());
    this.place(scale, this.canvas.width / 2 - x * scale, this.canvas.height / 2 - y * scale);
  }

  /** Zooms about the pixel under the pointer, without one about the middle. */
  zoomAtPixel(factor) {
    const at = this.pixel && this.onCanvas(this.pixel);
    this.zoomBy(factor, at?.x, at?.y);
  }

  onCanvas({ x, y }) {
    return { x: this.view.x + (x + 0.5) * this.view.scale, y: this.view.y + (y + 0.5) * this.view.scale };
  }

  /** Canvas coordinates of a pointer event. */
  position(event) {
    const box = this.canvas.getBoundingClientRect();
    return {
      x: ((event.clientX - box.left) * this.canvas.width) / box.width,
      y: ((event.clientY - box.top) * this.canvas.height) / box.height,
    };
  }

  point(pixel) {
    const { width, height } = this.size;
    this.pixel = pixel && pixel.x >= 0 && pixel.y >= 0 && pixel.x < width && pixel.y < height ? pixel : null;
    this.onpixel(this.pixel);
    this.draw();
  }

  pixelAt({ x, y }) {
    return { x: Math.floor((x - this.view.x) / this.view.scale), y: Math.floor((y - this.view.y) / this.view.scale) };
  }

  pointAt(event) {
    this.point(this.pixelAt(this.position(event)));
  }

  keep(pixel) {
    this.kept = pixel;
    this.onkeep?.(pixel);
  }

  /** The picture's pixel that is nearest to a pixel's place, which may be outside. */
  inside({ x, y }) {
    return { x: clamp(x, 0, this.size.width - 1), y: clamp(y, 0, this.size.height - 1) };
  }

  /** Whether the tool takes the drag that begins here. */
  grab(event) {
    if (!this.tool || event.shiftKey || this.pointers.size > 1) return false;
    const at = this.position(event);
    const near = (pixel) => {
      const there = this.onCanvas(pixel);
      return Math.hypot(there.x - at.x, there.y - at.y) / screenRatio();
    };
    return this.tool.grab(this.inside(this.pixelAt(at)), near);
  }

  /** Ends the drag of the tool; a second finger cancels it. */
  drop(is_given_up = false) {
    if (this.is_grabbed) this.tool?.drop(is_given_up);
    this.is_grabbed = false;
  }

  draw() {
    if (this.is_waiting) return;
    this.is_waiting = true;
    requestAnimationFrame(() => {
      this.is_waiting = false;
      if (!this.view) return; // without a picture yet
      const context = this.canvas.getContext("2d");
      context.clearRect(0, 0, this.canvas.width, this.canvas.height);
      context.imageSmoothingEnabled = this.view.scale < 1;
      this.paint(context, this.view);
      this.outline(context);
    });
  }

  /** Outlines the pixel under the pointer once pixels are large enough. */
  outline(context) {
    if (!this.pixel || this.view.scale < 6) return;
    const { scale } = this.view;
    const [x, y] = [this.view.x + this.pixel.x * scale, this.view.y + this.pixel.y * scale];
    for (const [color, inset] of [["#000", 0.5], ["#fff", 1.5]]) {
      context.strokeStyle = color;
      context.lineWidth = 1;
      context.strokeRect(x + inset, y + inset, scale - 2 * inset, scale - 2 * inset);
    }
  }

  listen() {
    const { canvas } = this;
    canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    canvas.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      canvas.setPointerCapture(event.pointerId);
      this.pointers.set(event.pointerId, this.position(event));
      this.pressed = this.pointers.size === 1 ? event : null;
      this.drop(true);
      this.is_grabbed = this.grab(event);
      this.pointAt(event);
    });
    canvas.addEventListener("pointermove", (event) => {
      const before = this.pointers.get(event.pointerId);
      if (this.is_grabbed) this.tool.drag(this.inside(this.pixelAt(this.position(event))));
      else if (before) this.drag(event, before);
      if (this.pointers.size < 2) this.pointAt(event);
    });
    for (const end of ["pointerup", "pointercancel"])
      canvas.addEventListener(end, (event) => {
        this.drop(end === "pointercancel");
        this.pointers.delete(event.pointerId);
        if (end === "pointerup") this.click(event);
      });
    canvas.addEventListener("pointerleave", (event) => event.pointerType === "mouse" && this.point(this.kept));
    canvas.addEventListener("dblclick", (event) => {
      if (this.tool) return;
      const { x, y } = this.position(event);
      this.zoomBy(2, x, y);
    });
    canvas.addEventListener("keydown", (event) => this.key(event));
  }

  /** A click keeps its pixel; one on the kept pixel, or beside the picture, keeps none. */
  click(event) {
    const { pressed, pixel, kept } = this;
    this.pressed = null;
    if (!pressed || Math.hypot(event.clientX - pressed.clientX, event.clientY - pressed.clientY) > 3) return;
    this.keep(pixel && kept && pixel.x === kept.x && pixel.y === kept.y ? null : pixel);
  }

  /** Zooms once the picture has the focus: a page that scrolls under the pointer must not start to zoom. */
  wheel(event) {
    if (document.activeElement !== this.canvas && !event.ctrlKey && !event.metaKey) return;
    event.preventDefault();
    const { x, y } = this.position(event);
    const lines = event.deltaMode === 1 ? 16 : 1;
    this.zoomBy(2 ** (-clamp(event.deltaY * lines, -120, 120) / 160), x, y);
    this.pointAt(event);
  }

  /** One pointer pans; two pan by their middle and zoom by their distance. */
  drag(event, before) {
    const now = this.position(event);
    const other = [...this.pointers].find(([id]) => id !== event.pointerId)?.[1];
    this.pointers.set(event.pointerId, now);
    const { scale, x, y } = this.view;
    if (!other) return this.place(scale, x + now.x - before.x, y + now.y - before.y);
    const apart = (p) => Math.hypot(p.x - other.x, p.y - other.y);
    this.place(scale, x + (now.x - before.x) / 2, y + (now.y - before.y) / 2);
    this.zoomBy(apart(now) / Math.max(1, apart(before)), (now.x + other.x) / 2, (now.y + other.y) / 2);
  }

  /** Arrows move the pixel that is read out; the picture follows. */
  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    if (event.key in steps) {
      const [dx, dy] = steps[event.key].map((step) => step * (event.shiftKey ? 10 : 1));
      const { width, height } = this.size;
      const from = this.pixel ?? { x: Math.floor(width / 2) - dx, y: Math.floor(height / 2) - dy };
      this.point(this.inside({ x: from.x + dx, y: from.y + dy }));
      this.keep(this.pixel);
      this.follow();
    } else if (this.tool?.key(event.key, this.pixel)) this.draw();
    else if (event.key === "+" || event.key === "=") this.zoomAtPixel(1.5);
    else if (event.key === "-") this.zoomAtPixel(1 / 1.5);
    else if (event.key === "0") this.fit();
    else if (event.key === "1") this.zoomTo(1);
    else return;
    event.preventDefault();
  }

  follow() {
    const at = this.onCanvas(this.pixel);
    const { scale, width, height } = this.view;
    const out = (value, room) => Math.min(0, value - scale) + Math.max(0, value + scale - room);
    this.place(scale, this.view.x - out(at.x, width), this.view.y - out(at.y, height));
  }
}

/** Buttons that zoom a view, around what says its zoom. */
export function zoomButtons(view, zoomed) {
  const button = (text, label, act) => h("button", { type: "button", title: label, "aria-label": label, onclick: act }, text);
  return [
    button("\u2212", "Zoom out", () => view.zoomAtPixel(1 / 1.5)),
    zoomed,
    button("+", "Zoom in", () => view.zoomAtPixel(1.5)),
    button("Fit", "Fit the whole picture", () => view.fit()),
    button("1:1", "One to one", () => view.zoomTo(1)),
    button("8:1", "Pixels as squares of eight", () => view.zoomTo(8)),
  ];
}
