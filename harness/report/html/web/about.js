// Where the numbers come from and what the words mean.

import { data, joined } from "./data.js";
import { h, list, rgb, swatch, words } from "./dom.js";

const definitions = (pairs) => h("dl", {}, pairs.map(([topic, text]) => [h("dt", {}, topic), h("dd", {}, text)]));
const block = (title, lead, content, open = false) =>
  h("details", { class: "block", open }, h("summary", {}, h("h3", {}, title)), lead && h("p", {}, lead), content);
const colored = (color, text) => h("span", { class: "swatch" }, swatch(rgb(color)), text);

export function showAbout(section) {
  const metrics = data.metrics.map(({ name, sentence, unit, better }) => {
    const direction = better && `${better === "lower" ? "Lower" : "Higher"} is better.`;
    return [h("code", {}, name), joined([sentence, unit && `In ${unit}.`, direction])];
  });
  const causes = data.causes.map((cause) => [colored(cause.color, words(cause.name)), cause.sentence]);
  const classes = data.classes.map((info) => [colored(info.color, `${info.name} ${info.word}`), info.sentence]);
  const order = "Why a pixel is wrong. The order counts: the first cause that fits is the pixel's.";
  section.append(
    h(
      "div",
      { class: "blocks" },
      block("Where the numbers come from", null, definitions(data.provenance), true),
      data.notes.length > 0 && block("Left out", null, list({}, data.notes), true),
      block("Causes", order, definitions(causes)),
      block("Pixel classes", "What a pixel is, whatever the technique: the first class that fits.", definitions(classes)),
      block("Metrics", null, definitions(metrics)),
    ),
  );
}
