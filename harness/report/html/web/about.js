// Where the numbers come from and what the words mean.

import { data } from "./data.js";
import { h, rgb } from "./dom.js";

const definitions = (pairs) =>
  h(
    "dl",
    {},
    pairs.map(([topic, text]) => [h("dt", {}, topic), h("dd", {}, text)]),
  );
const block = (title, lead, content, open = false) =>
  h("details", { class: "block", open }, h("summary", {}, h("h3", {}, title)), lead && h("p", {}, lead), content);
const swatch = (color, words) => h("span", { class: "swatch" }, h("i", { style: { background: rgb(color) } }), words);

export function showAbout(section) {
  const metrics = data.metrics.map((metric) => [
    h("code", {}, metric.name),
    [
      metric.sentence,
      metric.unit && ` In ${metric.unit}.`,
      metric.better && ` ${metric.better === "lower" ? "Lower" : "Higher"} is better.`,
    ]
      .filter(Boolean)
      .join(""),
  ]);
  section.append(
    h(
      "div",
      { class: "blocks" },
      block("Where the numbers come from", null, definitions(data.provenance), true),
      data.notes.length > 0 &&
        block(
          "Left out",
          null,
          h(
            "ul",
            {},
            data.notes.map((note) => h("li", {}, note)),
          ),
          true,
        ),
      block(
        "Causes",
        "Why a pixel is wrong. The order counts: the first cause that fits is the pixel's.",
        definitions(data.causes.map((cause) => [swatch(cause.color, cause.name.replaceAll("_", " ")), cause.sentence])),
      ),
      block(
        "Pixel classes",
        "What a pixel is, whatever the technique: the first class that fits.",
        definitions(data.classes.map((info) => [swatch(info.color, `${info.name} ${info.word}`), info.sentence])),
      ),
      block("Metrics", null, definitions(metrics)),
    ),
  );
}
