// A picture to look at closely: zoom by wheel, keys, buttons and two fingers, pan by dragging; pixels stay sharp squares.

import { h } from "./dom.js";

const largest = 64; // screen pixels a picture's pixel may take

/**
 * `paint(context, view)` draws in screen pixels, view = {scale, x, y, width, height, at(pixel)}: the picture's pixel (0, 0) lies
 * at x, y. `onpixel(pixel)` is told which pixel {x, y} is pointed at, null when none is. A `tool` takes one pointer's drags for
 * itself, unless Shift is held, and keys of its own (see LineTool).
 */
export class Viewport {
  constructor({ paint, onpixel, label }) {
    this.paint = paint;
    this.onpixel = onpixel;
    this.size = { width: 1, height: 1 };
    this.canvas = h("canvas", { tabindex: "0", role: "img", "aria-label": label });
    this.element = h("div", { class: "viewport" }, this.canvas);
    this.pointers = new Map();
    this.pixel = null;
    this.tool = null;
    this.listen();
    new ResizeObserver(() => this.resized()).observe(this.element);
  }

  /** A picture of another size; the same size keeps zoom and place. */
  setSize(width, height) {
    if (this.size.width === width && this.size.height === height) return;
    this.size = { width, height };
    this.canvas.style.aspectRatio = `${width} / ${height}`;
    this.resized();
    this.fit();
  }

  resized() {
    const ratio = devicePixelRatio || 1;
    const width = Math.max(1, Math.round(this.canvas.clientWidth * ratio)),
      height = Math.max(1, Math.round(this.canvas.clientHeight * ratio));
    if (this.canvas.width === width && this.canvas.height === height) return;
    const was_fit = !this.view || this.is_fit;
    this.canvas.width = width;
    this.canvas.height = height;
    if (was_fit) this.fit();
    else this.place(this.view.scale, this.view.x, this.view.y);
  }

  get fitScale() {
    return Math.min(this.canvas.width / this.size.width, this.canvas.height / this.size.height);
  }

  /** Screen pixels of one picture pixel, in CSS pixels. */
  get zoom() {
    return this.view.scale / (devicePixelRatio || 1);
  }

  fit() {
    this.place(this.fitScale, 0, 0);
  }

  /** Sets scale and origin, kept where the picture fills the canvas. */
  place(scale, x, y) {
    const { width, height } = this.canvas;
    const smallest = this.fitScale;
    const s = Math.min(Math.max(scale, smallest), Math.max(largest * (devicePixelRatio || 1), smallest));
    this.is_fit = s <= smallest * 1.0001;
    const kept = (origin, room, extent) =>
      extent <= room ? (room - extent) / 2 : Math.min(0, Math.max(room - extent, origin));
    this.view = { scale: s, x: kept(x, width, s * this.size.width), y: kept(y, height, s * this.size.height), width, height };
    this.canvas.classList.toggle("zoomed", !this.is_fit);
    this.onzoom?.();
    this.draw();
  }

  /** Zooms by a factor, the canvas point (x, y) staying where it is; the middle unless given. */
  zoomBy(factor, x = this.canvas.width / 2, y = this.canvas.height / 2) {
    const { scale, x: left, y: top } = this.view;
    const smallest = this.fitScale,
      most = Math.max(largest * (devicePixelRatio || 1), smallest);
    const next = Math.min(Math.max(scale * factor, smallest), most);
    this.place(next, x - ((x - left) / scale) * next, y - ((y - top) / scale) * next);
  }

  /** One picture pixel on `zoom` CSS pixels, about the middle or the pixel that is pointed at. */
  zoomTo(zoom) {
    const at = this.pixel && this.onCanvas(this.pixel);
    this.zoomBy((zoom * (devicePixelRatio || 1)) / this.view.scale, at?.x, at?.y);
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
    const is_inside = pixel && pixel.x >= 0 && pixel.y >= 0 && pixel.x < this.size.width && pixel.y < this.size.height;
    this.pixel = is_inside ? pixel : null;
    this.onpixel(this.pixel);
    this.draw();
  }

  pixelAt({ x, y }) {
    return { x: Math.floor((x - this.view.x) / this.view.scale), y: Math.floor((y - this.view.y) / this.view.scale) };
  }

  pointAt(event) {
    this.point(this.pixelAt(this.position(event)));
  }

  /** The nearest pixel of the picture. */
  pixelNear(at) {
    const { x, y } = this.pixelAt(at),
      { width, height } = this.size;
    return { x: Math.min(Math.max(x, 0), width - 1), y: Math.min(Math.max(y, 0), height - 1) };
  }

  /** Whether the tool takes the drag that begins here. */
  grab(event) {
    if (!this.tool || event.shiftKey || this.pointers.size > 1) return false;
    const at = this.position(event),
      ratio = devicePixelRatio || 1;
    const near = (pixel) => {
      const there = this.onCanvas(pixel);
      return Math.hypot(there.x - at.x, there.y - at.y) / ratio;
    };
    return this.tool.grab(this.pixelNear(at), near);
  }

  /** The drag of the tool ends; a second finger gives it up. */
  drop(is_given_up = false) {
    if (this.is_grabbed) this.tool?.drop(is_given_up);
    this.is_grabbed = false;
  }

  draw() {
    if (this.is_waiting) return;
    this.is_waiting = true;
    requestAnimationFrame(() => {
      this.is_waiting = false;
      const context = this.canvas.getContext("2d");
      context.clearRect(0, 0, this.canvas.width, this.canvas.height);
      context.imageSmoothingEnabled = this.view.scale < 1;
      this.paint(context, this.view);
      this.outline(context);
    });
  }

  /** The pixel that is pointed at, once one can see it. */
  outline(context) {
    if (!this.pixel || this.view.scale < 6) return;
    const { scale } = this.view,
      x = this.view.x + this.pixel.x * scale,
      y = this.view.y + this.pixel.y * scale;
    for (const [color, inset] of [
      ["#000", 0.5],
      ["#fff", 1.5],
    ]) {
      context.strokeStyle = color;
      context.lineWidth = 1;
      context.strokeRect(x + inset, y + inset, scale - 2 * inset, scale - 2 * inset);
    }
  }

  listen() {
    const { canvas } = this;
    // A page that scrolls under the pointer must not start to zoom: the wheel zooms once the picture has the focus.
    canvas.addEventListener(
      "wheel",
      (event) => {
        if (document.activeElement !== canvas && !event.ctrlKey && !event.metaKey) return;
        event.preventDefault();
        const { x, y } = this.position(event);
        const lines = event.deltaMode === 1 ? 16 : 1;
        this.zoomBy(2 ** (-Math.max(-120, Math.min(120, event.deltaY * lines)) / 160), x, y);
        this.pointAt(event);
      },
      { passive: false },
    );
    canvas.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      canvas.setPointerCapture(event.pointerId);
      this.pointers.set(event.pointerId, this.position(event));
      this.drop(true);
      this.is_grabbed = this.grab(event);
      this.pointAt(event);
    });
    canvas.addEventListener("pointermove", (event) => {
      const before = this.pointers.get(event.pointerId);
      if (this.is_grabbed) this.tool.drag(this.pixelNear(this.position(event)));
      else if (before) this.drag(event, before);
      if (this.pointers.size < 2) this.pointAt(event);
    });
    for (const end of ["pointerup", "pointercancel"])
      canvas.addEventListener(end, (event) => {
        this.drop(end === "pointercancel");
        this.pointers.delete(event.pointerId);
      });
    canvas.addEventListener("pointerleave", (event) => event.pointerType === "mouse" && this.point(null));
    canvas.addEventListener("dblclick", (event) => {
      if (this.tool) return;
      const { x, y } = this.position(event);
      this.zoomBy(2, x, y);
    });
    canvas.addEventListener("keydown", (event) => this.key(event));
  }

  /** One pointer pans; two pan by their middle and zoom by their distance. */
  drag(event, before) {
    const now = this.position(event);
    const other = [...this.pointers].find(([id]) => id !== event.pointerId)?.[1];
    this.pointers.set(event.pointerId, now);
    if (!other) return this.place(this.view.scale, this.view.x + now.x - before.x, this.view.y + now.y - before.y);
    const apart = (p) => Math.hypot(p.x - other.x, p.y - other.y);
    const middle = { x: (now.x + other.x) / 2, y: (now.y + other.y) / 2 };
    this.place(this.view.scale, this.view.x + (now.x - before.x) / 2, this.view.y + (now.y - before.y) / 2);
    this.zoomBy(apart(now) / Math.max(1, apart(before)), middle.x, middle.y);
  }

  /** Arrows move the pixel that is pointed at; the picture follows. */
  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    if (event.key in steps) {
      const [dx, dy] = steps[event.key].map((step) => step * (event.shiftKey ? 10 : 1));
      const { width, height } = this.size;
      const from = this.pixel ?? { x: Math.floor(width / 2) - dx, y: Math.floor(height / 2) - dy };
      const clamp = (value, end) => Math.min(Math.max(value, 0), end - 1);
      this.point({ x: clamp(from.x + dx, width), y: clamp(from.y + dy, height) });
      this.follow();
    } else if (this.tool?.key(event.key, this.pixel)) this.draw();
    else if (event.key === "+" || event.key === "=") this.zoomAtPixel(1.5);
    else if (event.key === "-") this.zoomAtPixel(1 / 1.5);
    else if (event.key === "0") this.fit();
    else if (event.key === "1") this.zoomTo(1);
    else return;
    event.preventDefault();
  }

  zoomAtPixel(factor) {
    const at = this.pixel && this.onCanvas(this.pixel);
    this.zoomBy(factor, at?.x, at?.y);
  }

  follow() {
    const at = this.onCanvas(this.pixel),
      { scale, width, height } = this.view;
    const out = (value, room) => Math.min(0, value - scale) + Math.max(0, value + scale - room);
    this.place(scale, this.view.x - out(at.x, width), this.view.y - out(at.y, height));
  }
}
