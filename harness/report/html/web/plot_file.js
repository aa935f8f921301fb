// A plot as an SVG file of its own: with the colors and fonts that the page's style gives it, and its legend above.

import { h } from "./dom.js";

const edge = 8; // around what is drawn
const space = "http://www.w3.org/2000/svg";
const styled = [
  ...["fill", "fill-opacity", "opacity", "paint-order", "text-anchor"],
  ...["stroke", "stroke-opacity", "stroke-width", "stroke-dasharray", "stroke-linecap", "stroke-linejoin"],
  ...["font-size", "font-family", "font-weight", "font-variant"],
];

function element(tag, attributes, ...children) {
  const made = document.createElementNS(space, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

/** A copy with what the style computes as attributes: a file has no style sheet of the page. */
function copyOf(original) {
  const copy = original.cloneNode(true);
  const [from, to] = [original, copy].map((root) => [root, ...root.querySelectorAll("*")]);
  from.forEach((part, index) => {
    const style = getComputedStyle(part);
    for (const name of styled) {
      const value = style.getPropertyValue(name);
      if (value && !["none 0px", "auto"].includes(value)) to[index].setAttribute(name, value);
    }
    to[index].removeAttribute("style");
    to[index].removeAttribute("class");
  });
  copy.querySelectorAll("style, [aria-label=tip]").forEach((part) => part.remove());
  return copy;
}

/** The entries of the plotting library's legends, as groups in a row that breaks at the width. Returns their height too. */
function legendOf(figure, width, ink) {
  const [row, group] = [20, element("g", { "font-size": "12", fill: ink })];
  let [x, y] = [8, 0];
  for (const entry of figure.querySelectorAll("[class*=-swatch]")) {
    const sign = entry.querySelector("svg");
    if (!sign || entry.querySelector("[class*=-swatch]")) continue;
    const name = entry.textContent.trim();
    const length = entry.getBoundingClientRect().width + 12;
    if (x > 8 && x + length > width) [x, y] = [8, y + row];
    const copy = copyOf(sign);
    for (const [key, value] of Object.entries({ x, y: y + 2, width: 15, height: 15 })) copy.setAttribute(key, value);
    group.append(copy, element("text", { x: x + 20, y: y + 14 }, name));
    x += length;
  }
  return { group, height: group.firstChild ? y + row + 6 : 0 };
}

/** The SVG text of the plot in a figure, with a title; null where there is no plot. */
export function plotText(figure, title) {
  const plot = [...figure.querySelectorAll("svg[role=img]")].at(-1);
  if (!plot) return null;
  const style = getComputedStyle(plot);
  const [width, height] = ["width", "height"].map((name) => Number(plot.getAttribute(name)));
  const family = style.fontFamily;
  const legend = legendOf(figure, width, style.color);
  const copy = copyOf(plot);
  copy.setAttribute("y", legend.height);
  copy.setAttribute("color", style.color);
  copy.setAttribute("overflow", "visible"); // names of axes may stand out by a little, as on the page
  const [across, down] = [width + 2 * edge, height + legend.height + edge];
  const fill = style.getPropertyValue("--plot-background") || "#fff";
  const paper = element("rect", { x: -edge, width: across, height: down, fill });
  const size = { width: across, height: down, viewBox: `${-edge} 0 ${across} ${down}`, "font-family": family };
  const file = element("svg", size, element("title", {}, title), paper, legend.group, copy);
  return `<?xml version="1.0" encoding="utf-8"?>\n${new XMLSerializer().serializeToString(file)}\n`;
}

/** A button that saves the plot of the figure; `name` is the file's without its ending, `title()` says what is shown. */
export function saveButton(figure, name, title) {
  function save() {
    const text = plotText(figure, title());
    if (text === null) return;
    const address = URL.createObjectURL(new Blob([text], { type: "image/svg+xml" }));
    h("a", { href: address, download: `${name}.svg` }).click();
    setTimeout(() => URL.revokeObjectURL(address), 60_000);
  }
  return h("button", { type: "button", class: "save", title: "Save this plot as an SVG file", onclick: save }, "SVG");
}
