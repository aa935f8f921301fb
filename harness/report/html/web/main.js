// The report of one run. Everything on the page comes from the JSON beside this script and from the pictures behind it.

import { showAbout } from "./about.js";
import { showComparer } from "./comparer.js";
import { data, distinct, isOk, joined } from "./data.js";
import { h, list, plural } from "./dom.js";
import { recalled, remember } from "./page_state.js";
import { showPlayer } from "./player.js";
import { showPlots } from "./plots.js";
import { showRanks } from "./ranks.js";
import { showTable } from "./table.js";

function showTop(header) {
  const count = (status) => data.rows.filter((row) => row.status === status).length;
  const different = (name, of) => plural(distinct(data.rows.map(of)).length, name);
  const unmeasured = ["unsupported", "failed"].filter(count).map((status) => `${count(status)} ${status}`);
  const masks = data.rows.filter((row) => isOk(row) && row.pictures).length;
  const lights = different("light", (row) => `${row.scene} ${row.light}`);
  const facts = [
    [plural(data.rows.length, "row"), unmeasured.join(", ")],
    [different("scene", (row) => row.scene), `${lights} in them`],
    [different("technique", (row) => row.technique), different("setting", (row) => row.title)],
    [plural(masks, "mask"), "to compare"],
  ];
  const provenance = new Map(data.provenance);
  const machine = ["processor", "renderer", "version", "commit"].map((key) => provenance.get(key));
  header.append(
    h("p", { class: "kicker" }, "Gnomon report"),
    h("h1", {}, data.title),
    h("p", { class: "machine" }, joined(machine.filter((text) => text !== "-"), " \u00b7 ")),
    list({ class: "facts" }, facts.map(([fact, detail]) => [h("b", {}, fact), detail && h("span", {}, detail)])),
  );
}

showTop(document.getElementById("top"));
const pictures = document.getElementById("pictures");
const comparer = showComparer(pictures);
const player = showPlayer(pictures);
showTable(document.getElementById("table"), (row) => {
  remember({ row: row.index });
  comparer.open(row);
  player.open(row);
  pictures.scrollIntoView({ behavior: matchMedia("(prefers-reduced-motion: reduce)").matches ? "auto" : "smooth" });
});
showPlots(document.getElementById("plots"));
showRanks(document.getElementById("ranks"));
showAbout(document.getElementById("about"));
// A link that says what is compared leads to it; one of the table alone stays at the table.
if (recalled("a") !== null) pictures.scrollIntoView();

// On paper nobody can open what is closed.
addEventListener("beforeprint", () => document.querySelectorAll("#about details").forEach((details) => (details.open = true)));
