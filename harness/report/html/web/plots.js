// The plots: each a card with its own lists to choose from. All of them follow the filter of the table.

import { describe } from "./axes.js";
import { h, onWidth } from "./dom.js";
import { onFilter } from "./filter.js";
import { saveButton } from "./plot_file.js";
import { followKeys, teller } from "./plot_keys.js";
import { onRecall, recalled, remember } from "./page_state.js";
import { costCard } from "./plot_cost.js";
import { framesCard } from "./plot_frames.js";
import { frontCard } from "./plot_front.js";
import { scalingCard } from "./plot_scaling.js";

/**
 * A card draws itself when it comes into view, and again when its size, its choices or the filter change. `make` gets the
 * function that redraws and returns {name, title, lead, controls, draw}, or null for no card. draw(width) returns {plot,
 * caption}, or {empty}: the reason why there is no plot.
 */
function addCard(section, make) {
  let [is_seen, is_stale, width] = [false, true, 0];
  const redraw = () => {
    is_stale = true;
    if (!is_seen || width === 0) return;
    is_stale = false;
    const { plot, caption, empty } = card.draw(width);
    if (plot) followKeys(describe(plot, `${card.title}; arrow keys go from point to point, and the table has the numbers`), said);
    figure.replaceChildren(plot ?? h("p", { class: "empty" }, empty), ...(caption ? [h("figcaption", {}, caption)] : []));
  };
  const card = make(redraw);
  if (!card) return;
  const [figure, said] = [h("figure"), teller()];
  const chosen = () => card.controls.flatMap((control) => [...(control.querySelectorAll?.("select") ?? [])]);
  const title = () => [card.title, ...chosen().map((select) => select.selectedOptions[0]?.textContent)].join(", ");
  const element = h(
    "article",
    { class: `card ${card.name}` },
    h("h3", {}, card.title),
    h("p", { class: "lead" }, card.lead),
    h("div", { class: "bar" }, card.controls, saveButton(figure, card.name, title)),
    figure,
    said,
  );
  section.append(element);
  rememberChoices(card.name, chosen());
  onWidth(figure, (now) => { width = now; redraw(); });
  const see = (is_near) => {
    is_seen = is_near;
    if (is_seen && is_stale) redraw();
  };
  const watch = (entries) => see(entries.some((entry) => entry.isIntersecting));
  new IntersectionObserver(watch, { rootMargin: "400px" }).observe(element);
  addEventListener("beforeprint", () => see(true));
  onFilter(redraw);
}

/** What a reader chooses in a card's lists goes into the address, under the names of card and list. */
function rememberChoices(name, lists) {
  const key = (list) => `${name}.${list.name}`;
  const recall = () =>
    lists.forEach((list) => {
      const value = recalled(key(list));
      if (value === null || value === list.value || ![...list.options].some((option) => option.value === value)) return;
      list.value = value;
      list.dispatchEvent(new Event("change"));
    });
  lists.forEach((list) => list.addEventListener("change", () => remember({ [key(list)]: list.value })));
  recall();
  onRecall(recall);
}

export function showPlots(section) {
  const cards = h("div", { class: "cards" });
  section.append(cards);
  for (const make of [frontCard, costCard, scalingCard, framesCard]) addCard(cards, make);
}
