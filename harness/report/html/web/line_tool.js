// The line of the profile over the picture: drawn with the mouse or a finger, or end by end with a key.

import { screenRatio } from "./dom.js";

const reach = 12; // CSS pixels in which an end is caught

/**
 * `line` is null or two pixels {x, y}. Calls `onchange()` after every change. A tool of a Viewport: `grab(pixel, near)` begins
 * a drag at a pixel of the picture and returns whether the tool takes it. `near(pixel)` is a pixel's distance on the screen.
 */
export class LineTool {
  constructor(onchange) {
    this.onchange = onchange;
    this.line = null;
    this.marked = null;
    this.is_on = false;
    this.next = 0;
  }

  set(line) {
    this.line = line;
    this.onchange();
  }

  /** An end moves; elsewhere a new line begins. */
  grab(pixel, near) {
    const end = this.line ? this.line.findIndex((end) => near(end) <= reach) : -1;
    this.end = end >= 0 ? end : 1;
    this.before = this.line;
    if (end < 0) this.set([pixel, pixel]);
    return true;
  }

  drag(pixel) {
    const line = [...this.line];
    line[this.end] = pixel;
    this.set(line);
  }

  /** A click is no line. */
  drop(is_given_up) {
    const [from, to] = this.line;
    if (is_given_up || (from.x === to.x && from.y === to.y)) this.set(this.before);
  }

  /** P puts the ends at the pixel, in turn. Returns whether the tool took the key. */
  key(name, pixel) {
    if (name !== "p" || !pixel) return false;
    const line = this.line ? [...this.line] : [pixel, pixel];
    line[this.next] = pixel;
    this.next = 1 - this.next;
    this.set(line);
    return true;
  }

  draw(context, view) {
    if (!this.line) return;
    const ratio = screenRatio();
    const place = ({ x, y }) => [view.x + (x + 0.5) * view.scale, view.y + (y + 0.5) * view.scale];
    const ends = this.line.map(place);
    context.save();
    context.lineCap = "round";
    for (const [color, width] of [["#000", 4], ["#fff", 2]]) {
      context.strokeStyle = color;
      context.lineWidth = width * ratio;
      context.beginPath();
      context.moveTo(...ends[0]);
      context.lineTo(...ends[1]);
      context.stroke();
    }
    const disc = ([x, y], radius, fill) => {
      context.beginPath();
      context.arc(x, y, radius * ratio, 0, 2 * Math.PI);
      context.fillStyle = fill;
      context.fill();
      context.lineWidth = 1.5 * ratio;
      context.strokeStyle = fill === "#000" ? "#fff" : "#000";
      context.stroke();
    };
    disc(ends[0], 5, "#fff"); // where distances begin
    disc(ends[1], 5, "#000");
    if (this.marked) disc(place(this.marked), 4, "#ffe100");
    context.restore();
  }
}
