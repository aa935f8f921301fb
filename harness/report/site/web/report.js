// The table, plots and ranks of one run: those of the report, within a page of a site.

import { showAbout } from "../../html/web/about.js";
import { showPlots } from "../../html/web/plots.js";
import { showRanks } from "../../html/web/ranks.js";
import { showTable } from "../../html/web/table.js";

const section = (id) => document.getElementById(id);

showTable(section("table"), () => {});
showPlots(section("plots"));
showRanks(section("ranks"));
showAbout(section("about"));
