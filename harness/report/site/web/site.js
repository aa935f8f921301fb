// Every page of a site: tables that are sorted and filtered, the search, and the key that leads to it.

import { showSearch } from "./search.js";
import { enhanceTables } from "./tables.js";

enhanceTables();
showSearch();

const isTyping = (element) => element.closest("input, textarea, select") !== null;

addEventListener("keydown", (event) => {
  if (event.key !== "/" || event.ctrlKey || event.metaKey || event.altKey || isTyping(event.target)) return;
  event.preventDefault();
  document.querySelector("#search input, nav .find input")?.focus();
});

// On paper nobody can open what is closed.
addEventListener("beforeprint", () => document.querySelectorAll("main details").forEach((details) => (details.open = true)));
