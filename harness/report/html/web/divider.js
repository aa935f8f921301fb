// The divider of the wipe: dragged, or moved by keys as any slider.

import { h } from "./dom.js";

export class Divider {
  constructor(onmove) {
    this.onmove = onmove;
    this.share = 0.5;
    const slider = { "aria-orientation": "horizontal", "aria-valuemin": "0", "aria-valuemax": "100" };
    this.element = h(
      "div",
      { class: "divider", role: "slider", tabindex: "0", "aria-label": "Divider between A and B", ...slider },
      h("span", { "aria-hidden": "true" }, "\u25c2 \u25b8"),
    );
    this.element.addEventListener("pointerdown", (event) => {
      this.element.setPointerCapture(event.pointerId);
      event.preventDefault();
      this.element.focus();
    });
    this.element.addEventListener("pointermove", (event) => {
      if (!this.element.hasPointerCapture(event.pointerId)) return;
      const box = this.element.parentElement.getBoundingClientRect();
      this.set((event.clientX - box.left) / box.width);
    });
    this.element.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: -0.01, ArrowRight: 0.01, PageDown: -0.1, PageUp: 0.1, Home: -1, End: 1 }[event.key];
      if (!step) return;
      event.preventDefault();
      this.set(this.share + step);
    });
    this.set(0.5);
  }

  set(share) {
    this.share = Math.min(1, Math.max(0, share));
    this.element.style.left = `${100 * this.share}%`;
    this.element.setAttribute("aria-valuenow", String(Math.round(100 * this.share)));
    this.onmove();
  }
}
