// The report of one run. Everything on the page comes from the JSON beside this script and from the pictures behind it.

import { showAbout } from "./about.js";
import { showComparer } from "./comparer.js";
import { data, distinct, isOk } from "./data.js";
import { h, plural } from "./dom.js";
import { showPlots } from "./plots.js";
import { showTable } from "./table.js";

function showTop(header) {
  const count = (status) => data.rows.filter((row) => row.status === status).length;
  const different = (key) => distinct(data.rows.map((row) => row[key])).length;
  const says = new Map(data.provenance);
  const facts = [
    [
      plural(data.rows.length, "row"),
      ["unsupported", "failed"]
        .filter(count)
        .map((status) => `${count(status)} ${status}`)
        .join(", "),
    ],
    [
      plural(different("scene"), "scene"),
      plural(distinct(data.rows.map((row) => `${row.scene} ${row.light}`)).length, "light") + " in them",
    ],
    [plural(different("technique"), "technique"), plural(distinct(data.rows.map((row) => row.title)).length, "setting")],
    [plural(data.rows.filter((row) => isOk(row) && row.pictures).length, "mask"), "to compare"],
  ];
  const machine = ["processor", "renderer", "version", "commit"]
    .map((key) => says.get(key))
    .filter((text) => text && text !== "-");
  header.append(
    h("p", { class: "kicker" }, "Gnomon report"),
    h("h1", {}, data.title),
    h("p", { class: "machine" }, machine.join(" \u00b7 ")),
    h(
      "ul",
      { class: "facts" },
      facts.map(([fact, detail]) => h("li", {}, h("b", {}, fact), detail && h("span", {}, detail))),
    ),
  );
}

showTop(document.getElementById("top"));
const pictures = document.getElementById("pictures");
const comparer = showComparer(pictures);
showTable(document.getElementById("table"), (row) => {
  comparer.open(row);
  pictures.scrollIntoView({ behavior: matchMedia("(prefers-reduced-motion: reduce)").matches ? "auto" : "smooth" });
});
showPlots(document.getElementById("plots"));
showAbout(document.getElementById("about"));

// Paper cannot be unfolded.
addEventListener("beforeprint", () => document.querySelectorAll("#about details").forEach((details) => (details.open = true)));
