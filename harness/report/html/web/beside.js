// Up to four pictures beside one another, which zoom, pan and choose pixels as one.

import { chooser, h } from "./dom.js";
import { Viewport } from "./viewport.js";

/** Of the sides beyond A: B always, C and D where they are chosen. */
const names = ["B", "C", "D"];
export const noChoice = "none";

/**
 * Views of further pictures beside `main`, all in `element`. `paint(k, context, view)` draws picture k, from 1 on; `read(pixel)`
 * reads a pixel; `load()` follows a choice of C or D; `onkeep()` a pixel that a click or a key keeps.
 */
export class Beside {
  constructor(main, { paint, read, load, onkeep }) {
    this.main = main;
    this.read = read;
    this.labels = names.map(() => h("div", { class: "labels", "aria-hidden": "true" }));
    this.views = names.map(
      (name, k) =>
        new Viewport({
          paint: (context, view) => paint(k + 1, context, view),
          onpixel: (pixel) => this.choose(this.views[k], pixel),
          name: "further",
          label: `Picture ${name}, which zooms with the others. Arrow keys choose a pixel, plus and minus zoom, 0 fits.`,
        }),
    );
    this.views.forEach((view, k) => {
      view.element.append(this.labels[k]);
      view.onzoom = () => (view.is_resizing ? this.align([view], this.main) : this.follow(view));
    });
    this.onkeep = onkeep;
    for (const view of [main, ...this.views]) view.onkeep = (pixel) => this.keep(pixel);
    this.lists = names.slice(1).map((name) => chooser(name.toLowerCase(), [], load, name));
    this.element = h("div", { class: "pictures" }, main.element, this.views.map(({ element }) => element));
    this.show([]);
  }

  /** Offers these options for C and D, after none of them. */
  offer(options) {
    for (const list of this.lists) list.set([{ value: noChoice, text: "none" }, ...options], list.value || noChoice);
    for (const list of this.lists) if (list.select.selectedIndex < 0) list.value = noChoice;
  }

  /** Shows the pictures of these titles beside the main one; none: the main one alone. */
  show(titles, width = 1, height = 1) {
    const is_on = titles.length > 0;
    this.is_on = is_on;
    this.element.classList.toggle("many", is_on);
    for (const list of this.lists) list.element.hidden = !is_on;
    this.views.forEach((view, k) => {
      view.element.hidden = k >= titles.length;
      if (view.element.hidden) return;
      this.labels[k].replaceChildren(h("span", {}, `${names[k]}  ${titles[k]}`));
      view.setSize(width, height);
      view.draw();
    });
    if (is_on) this.follow(this.main);
  }

  /** All others show what this one shows. */
  follow(leader) {
    this.align([this.main, ...this.views].filter((view) => view !== leader), leader);
  }

  align(views, leader) {
    if (!this.is_on || this.is_aligning || !leader.view) return;
    this.is_aligning = true;
    for (const view of views) {
      if (view.element.hidden || !view.view) continue;
      if (leader.is_fit) view.fit();
      else view.showAt(leader.middle);
    }
    this.is_aligning = false;
  }

  /** Chooses the pixel in all of them. */
  choose(leader, pixel) {
    if (this.is_choosing) return;
    this.is_choosing = true;
    if (this.is_on) for (const view of [this.main, ...this.views]) if (view !== leader && !view.element.hidden) view.point(pixel);
    this.is_choosing = false;
    this.read(pixel);
  }

  /** Keeps the pixel in all of them. */
  keep(pixel) {
    for (const view of [this.main, ...this.views]) view.kept = pixel;
    this.onkeep();
  }
}
