// Makes the page's template: bundles the modules and styles of this folder into page.html and writes it as a C++ source file.
//
// usage: node bundle.js NODE_MODULES OUT.cpp

import { createHash } from "node:crypto";
import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

import { bundler, literal } from "./bundling.js";

const [modules, out] = process.argv.slice(2).map((path) => resolve(path));
const here = dirname(fileURLToPath(import.meta.url));
const bundled = bundler(modules);

const script = bundled(join(here, "main.js"));
const parts = {
  "@STYLE@": bundled(join(here, "style.css")),
  "@SCRIPT@": script,
  "@SCRIPT_HASH@": "sha256-" + createHash("sha256").update(script).digest("base64"),
};
const page = readFileSync(join(here, "page.html"), "utf8").replace(/@(STYLE|SCRIPT|SCRIPT_HASH)@/g, (slot) => parts[slot]);
for (const slot of ["@GNOMON_TITLE@", "@GNOMON_COLORS@", "@GNOMON_DATA@", "@GNOMON_PICTURES@"]) {
  if (page.split(slot).length !== 2) throw new Error(`the page must hold ${slot} once`);
}

writeFileSync(
  out,
  `// Made from harness/report/html/web by its bundle.js.\n#include "report/html/html_parts.h"\n\nnamespace gnomon {\n\n` +
    `namespace {\nconstexpr char page[] =\n${literal(page)};\n}  // namespace\n\n` +
    `std::string_view page_template() { return {page, sizeof page - 1}; }\n\n}  // namespace gnomon\n`,
);
