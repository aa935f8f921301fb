// Elements from a line: h("td", {class: "number"}, "1.23"). Text never becomes markup.

const isGiven = (value) => value !== null && value !== undefined && value !== false;

/** Attributes that are functions are listeners ("onclick"); null, undefined and false leave an attribute or child out. */
export function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(name.slice(2), value);
    else if (name === "style" && value) for (const [key, text] of Object.entries(value)) element.style.setProperty(key, text);
    else if (isGiven(value)) element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children.flat(Infinity).filter(isGiven));
  return element;
}

/** A list with an entry for each item. */
export const list = (attributes, items) => h("ul", attributes, items.map((item) => h("li", {}, item)));

/** A box in the color that a legend names. */
export const swatch = (color) => h("i", { style: { background: color } });

/** The parts of a name, each with what joins it to the next: "shadow_" "map:" "resolution=256," "filter=pcf". */
const partsOf = (name) => name.split(/(?<=[:,;/_])/);

/** A name that may break between its parts, and not inside a word. */
export const breakable = (text) => partsOf(text).flatMap((part, index) => (index === 0 ? [part] : [h("wbr"), part]));

/** A name in lines of up to so many letters: broken between its parts, inside a part that is longer than a line. */
export function linesOf(name, letters) {
  const pieces = partsOf(name).flatMap((part) => part.match(new RegExp(`.{1,${letters}}`, "gsu")) ?? []);
  const lines = [""];
  for (const piece of pieces) {
    if (lines.at(-1) && lines.at(-1).length + piece.length > letters) lines.push("");
    lines[lines.length - 1] += piece;
  }
  return lines;
}

/** A labeled list of options {value, text}. `set` replaces the options and keeps the choice where it can. */
export function chooser(name, options, onchange, label = name) {
  const select = h("select", { name, onchange: () => onchange(select.value) });
  const element = h("label", { class: "field" }, h("span", {}, label), select);
  const set = (choices, value = select.value) => {
    select.replaceChildren(...choices.map((option) => h("option", { value: option.value }, option.text)));
    if (choices.some((option) => option.value === value)) select.value = value;
    select.disabled = choices.length < 2;
  };
  set(options);
  return {
    element,
    select,
    set,
    get value() { return select.value; },
    set value(value) { select.value = value; },
  };
}

/** A check box with its label. */
export function toggle(label, onchange, checked = false) {
  const input = h("input", { type: "checkbox", checked, onchange: () => onchange(input.checked) });
  return h("label", { class: "toggle" }, input, h("span", {}, label));
}

/** A canvas that shows this ImageData. */
export function canvasOf(image) {
  const canvas = h("canvas", { width: image.width, height: image.height });
  canvas.getContext("2d").putImageData(image, 0, 0);
  return canvas;
}

/** Calls back with the element's width in CSS pixels, at first and whenever it changes. */
export function onWidth(element, listener) {
  let width = 0;
  new ResizeObserver(() => {
    if (width === element.clientWidth) return;
    width = element.clientWidth;
    listener(width);
  }).observe(element);
}

/** Screen pixels of a CSS pixel. */
export const screenRatio = () => devicePixelRatio || 1;

export const rgb = (color) => `rgb(${color.join(" ")})`;

export const words = (name) => name.replaceAll("_", " ");

export const plural = (count, one) => `${count.toLocaleString("en")} ${one}${count === 1 ? "" : "s"}`;
