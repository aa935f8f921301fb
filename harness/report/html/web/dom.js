// Elements from a line: h("td", {class: "number"}, "1.23"). Text never becomes markup.

/** Attributes that are functions are listeners ("onclick"); null, undefined and false leave an attribute or child out. */
export function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(name.slice(2), value);
    else if (name === "style" && value) for (const [key, text] of Object.entries(value)) element.style.setProperty(key, text);
    else if (value !== null && value !== undefined && value !== false) element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children.flat(Infinity).filter((child) => child !== null && child !== undefined && child !== false));
  return element;
}

/** A name that may break after what joins its parts, and not inside a word: "shadow_map:" "resolution=256," "filter=pcf". */
export function breakable(text) {
  const parts = text.split(/(?<=[:,;/])/);
  return parts.flatMap((part, index) => (index === 0 ? [part] : [h("wbr"), part]));
}

/** A labeled list to choose from. `options` are {value, text}; the choice is kept when the options change. */
export function chooser(label, options, onchange, attributes = {}) {
  const select = h("select", { ...attributes, onchange: () => onchange(select.value) });
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
    get value() {
      return select.value;
    },
    set value(value) {
      select.value = value;
    },
  };
}

/** A check box with its label. */
export function toggle(label, checked, onchange) {
  const input = h("input", { type: "checkbox", checked, onchange: () => onchange(input.checked) });
  return h("label", { class: "toggle" }, input, h("span", {}, label));
}

export const rgb = (color) => `rgb(${color.join(" ")})`;

export const plural = (count, one, many = one + "s") => `${count.toLocaleString("en")} ${count === 1 ? one : many}`;
