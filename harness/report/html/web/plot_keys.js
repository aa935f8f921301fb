// Plots by keyboard: with the focus on a plot, arrow keys go from point to point, and the plot tells the point as it tells the
// one under the pointer.

import { h } from "./dom.js";

const marks = "[data-mark=dot], [data-mark=bar]";

/** Middles of the points on the screen, from left to right, of equal ones from top to bottom. */
function pointsOf(plot) {
  const parts = [...plot.querySelectorAll(marks)].flatMap((group) => [...group.querySelectorAll("path, circle, rect")]);
  const places = parts.map((part) => {
    const box = part.getBoundingClientRect();
    return { x: box.left + box.width / 2, y: box.top + box.height / 2 };
  });
  return places.sort((p, q) => p.x - q.x || p.y - q.y);
}

/** The lines of a tip. The plotting library begins each with a space without width, and those that it wrapped with none. */
const textOf = (tip) =>
  [...(tip?.querySelectorAll("tspan") ?? [])]
    .map((line) => line.textContent)
    .join(" ")
    .split("\u200b")
    .map((line) => line.trim())
    .filter(Boolean)
    .join("; ");

/** Listens on the plot's picture, an SVG element that gets the focus, and tells in `said`. */
export function followKeys(picture, said) {
  let at = -1;
  picture.setAttribute("tabindex", "0");
  const tell = ({ x, y }) => {
    const place = { clientX: x, clientY: y, pointerType: "mouse", bubbles: true };
    picture.dispatchEvent(new PointerEvent("pointerenter", place));
    picture.dispatchEvent(new PointerEvent("pointermove", place));
    requestAnimationFrame(() => {
      const tip = picture.querySelector("[data-mark=tip], [aria-label=tip]");
      said.textContent = textOf(tip);
    });
  };
  picture.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const points = pointsOf(picture);
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    const end = { Home: 0, End: points.length - 1 }[event.key];
    if (points.length === 0 || (step === undefined && end === undefined)) return;
    event.preventDefault();
    at = end ?? (at < 0 ? (step > 0 ? 0 : points.length - 1) : (at + step + points.length) % points.length);
    tell(points[at]);
  });
  picture.addEventListener("blur", () => {
    at = -1;
    said.textContent = "";
    picture.dispatchEvent(new PointerEvent("pointerleave", { pointerType: "mouse" }));
  });
}

/** Where plots tell their points to those who have the page read to them. */
export const teller = () => h("output", { class: "hidden", "aria-live": "polite" });
