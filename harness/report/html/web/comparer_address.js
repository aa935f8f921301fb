// What the comparer shows, in the page's address: places, sides, mode, switches, zoom, the kept pixel, the profile's line.

import { noChoice } from "./beside.js";
import { onRecall, recalled, recalledNumber, remember } from "./page_state.js";

/** Switches of the comparer: its member, its name in the address, the value that the address leaves out. */
const switches = [
  ["is_shaded", "shaded", true],
  ["shows_all_light", "all_light", false],
  ["has_contours", "contours", false],
];

/** Pixels as "12-34-56-78"; false of none. */
const textOf = (pixels) => pixels?.every(Boolean) && pixels.map(({ x, y }) => `${x}-${y}`).join("-");

/** So many pixels that the address has under a name, or null where one of them is no pixel of the size. */
function recalledPixels(name, count, { width, height }) {
  const text = recalled(name) ?? "";
  const numbers = /^\d+(-\d+)*$/.test(text) ? text.split("-").map(Number) : [];
  const pixels = Array.from({ length: count }, (_, k) => ({ x: numbers[2 * k], y: numbers[2 * k + 1] }));
  return numbers.length === 2 * count && pixels.every(({ x, y }) => x < width && y < height) ? pixels : null;
}

export class ComparerAddress {
  /** Shows in the comparer what the address says, now and whenever another address of the page is opened. */
  constructor(comparer, modes) {
    Object.assign(this, { comparer, modes, wanted: null, is_recalling: false });
    if (recalled("a") !== null) this.recall();
    onRecall(() => this.recall());
  }

  /** What is shown, in texts. The view is that of its middle, which fits a canvas of another size. */
  get shown() {
    const { where, a, b, mode, scale, divider, view, beside, tone, line, profile } = this.comparer;
    return {
      where: where.value,
      a: a.value,
      b: b.value,
      ...Object.fromEntries(beside.lists.map((list) => [list.select.name, beside.is_on && list.value !== noChoice && list.value])),
      mode: mode.name,
      scale: mode.name === "difference" && scale.value,
      wipe: mode.name === "wipe" && divider.share !== 0.5 && divider.share,
      ...Object.fromEntries(
        switches.map(([member, name, usual]) => [name, this.comparer[member] !== usual && (usual ? "off" : "on")]),
      ),
      exposure: tone.gain !== 1 && tone.exposure.value,
      false_colors: tone.is_false && "on",
      pixel: textOf([view.kept]),
      profile: line.is_on && profile.shows.value,
      line: line.is_on && textOf(line.line),
      ...(view.is_fit ? { zoom: null, x: null, y: null } : view.middle),
    };
  }

  /** Puts what is shown into the page's address, unless nobody chose anything yet. */
  keep() {
    if (!this.comparer.frame || this.is_recalling) return;
    const { shown } = this;
    const text = JSON.stringify(shown);
    this.first ??= text;
    if (text !== this.first || recalled("a") !== null) remember(shown);
  }

  /** Shows what the address says; what this run lacks stays as it is. */
  async recall() {
    const { comparer } = this;
    const turn = (this.is_recalling = {});
    const set = (list, value) => {
      if ([...list.select.options].some((option) => option.value === value)) list.value = value;
    };
    set(comparer.where, recalled("where"));
    comparer.choose();
    for (const name of ["a", "b", "scale"]) set(comparer[name], recalled(name));
    for (const list of comparer.beside.lists) set(list, recalled(list.select.name) ?? noChoice);
    for (const [member, name, usual] of switches) comparer.setSwitch(member, (recalled(name) !== null) !== usual);
    comparer.tone.set(recalled("exposure") ?? "0", recalled("false_colors") !== null);
    comparer.divider.set(recalledNumber("wipe") ?? 0.5);
    comparer.setMode(this.modes.find(({ name }) => name === recalled("mode")) ?? comparer.mode);
    const [zoom, x, y] = ["zoom", "x", "y"].map(recalledNumber);
    this.wanted = zoom > 0 && x !== null && y !== null ? { zoom, x, y } : "fit";
    await comparer.load();
    if (this.is_recalling !== turn) return;
    this.recallPixels();
    this.is_recalling = false;
    this.keep();
  }

  /** The kept pixel and the line, of which a picture of another size has none. */
  recallPixels() {
    const { beside, frame, line, profile, view } = this.comparer;
    if (!frame) return;
    const [pixel] = recalledPixels("pixel", 1, frame) ?? [null];
    beside.keep(pixel);
    view.point(pixel);
    const ends = recalledPixels("line", 2, frame);
    if (ends) Object.assign(line, { line: ends, place: frame.place });
    profile.shows.value = recalled("profile") === "difference" ? "difference" : "visibility";
    this.comparer.setProfile(recalled("profile") !== null);
  }

  /** Zooms a view that has its size to what the address says, once. */
  showView(view) {
    if (this.wanted === "fit") view.fit();
    else if (this.wanted) view.showAt(this.wanted);
    this.wanted = null;
  }
}
