// The plots: each a card with its own lists to choose from, all of them following the filter of the table.

import { h } from "./dom.js";
import { onFilter } from "./filter.js";
import { costCard } from "./plot_cost.js";
import { framesCard } from "./plot_frames.js";
import { frontCard } from "./plot_front.js";
import { scalingCard } from "./plot_scaling.js";

/** One picture with a name for those who have it read to them; the library's names for its parts say nothing to them. */
function describe(plot, title) {
  for (const part of plot.querySelectorAll("[aria-label]")) {
    part.dataset.mark = part.getAttribute("aria-label");
    part.removeAttribute("aria-label");
  }
  const picture = [plot, ...plot.querySelectorAll("svg")].filter((element) => element.localName === "svg").at(-1);
  picture.setAttribute("role", "img");
  picture.setAttribute("aria-label", `${title}; the table has the numbers`);
}

/**
 * A card draws itself when it comes into view, and again when its size, its choices or the filter change. `make` gets the
 * function that redraws and returns {title, lead, controls, draw}; draw(width) returns {plot, caption}, or {empty} with a
 * sentence that says why there is nothing to see. Nothing is shown for a card that `make` returns null for.
 */
function addCard(section, make) {
  let is_seen = false,
    is_stale = true,
    width = 0;
  const redraw = () => {
    is_stale = true;
    if (!is_seen || width === 0) return;
    is_stale = false;
    const { plot, caption, empty } = card.draw(width);
    if (plot) describe(plot, card.title);
    figure.replaceChildren(plot ?? h("p", { class: "empty" }, empty), ...(caption ? [h("figcaption", {}, caption)] : []));
  };
  const card = make(redraw);
  if (!card) return;
  const figure = h("figure");
  const element = h(
    "article",
    { class: `card ${card.name}` },
    h("h3", {}, card.title),
    h("p", { class: "lead" }, card.lead),
    h("div", { class: "bar" }, card.controls),
    figure,
  );
  section.append(element);
  new ResizeObserver(() => {
    if (width === figure.clientWidth) return;
    width = figure.clientWidth;
    redraw();
  }).observe(figure);
  new IntersectionObserver(
    (entries) => {
      is_seen = entries.some((entry) => entry.isIntersecting);
      if (is_seen && is_stale) redraw();
    },
    { rootMargin: "400px" },
  ).observe(element);
  addEventListener("beforeprint", () => {
    is_seen = true;
    if (is_stale) redraw();
  });
  onFilter(redraw);
}

export function showPlots(section) {
  const cards = h("div", { class: "cards" });
  section.append(cards);
  for (const make of [frontCard, costCard, scalingCard, framesCard]) addCard(cards, make);
}
