// How visibility becomes color in the comparer: exposure, and false colors in the place of light.

import { clamp } from "./data.js";
import { chooser, toggle } from "./dom.js";

const stops = [-4, -3, -2, -1, 0, 1, 2, 3, 4, 6, 8];
const named = (stop) => ({ value: String(stop), text: stop === 0 ? "0" : `${stop < 0 ? "\u2212" : "+"}${Math.abs(stop)} EV` });

/** The helix of Green 2011: hues that turn while lightness rises evenly, so that a gray print keeps the order. */
export function falseColor(share) {
  const value = clamp(share, 0, 1);
  const angle = 2 * Math.PI * (0.5 / 3 + 1 - 1.5 * value);
  const aside = (value * (1 - value)) / 2;
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const [red, green, blue] = [-0.14861 * c + 1.78277 * s, -0.29227 * c - 0.90649 * s, 1.97294 * c];
  return [red, green, blue].map((turned) => 255 * clamp(value + aside * turned, 0, 1));
}

/** The controls, and what they say: values are multiplied by `gain`, and `is_false` shows them in colors. */
export class Tone {
  constructor(onchange) {
    this.exposure = chooser("exposure", stops.map(named), onchange, "exposure");
    this.exposure.value = "0";
    this.is_false = false;
    this.switch = toggle("false colors", (is_on) => this.set(this.exposure.value, is_on, onchange));
  }

  get elements() {
    return [this.exposure.element, this.switch];
  }

  get gain() {
    return 2 ** Number(this.exposure.value);
  }

  /** Of an exposure that there is. */
  set(exposure, is_false, onchange) {
    if (stops.includes(Number(exposure))) this.exposure.value = String(exposure);
    this.is_false = is_false;
    this.switch.querySelector("input").checked = is_false;
    onchange?.();
  }

  /** Shown with pictures of light alone. */
  offer(is_offered) {
    for (const element of this.elements) element.hidden = !is_offered;
  }
}
