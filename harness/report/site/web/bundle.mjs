// Makes the scripts and the style of a site from the modules of this folder, and writes them as a C++ source file.
//
// usage: node bundle.mjs NODE_MODULES OUT.cpp

import { writeFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

import { bundler, literal } from "../../html/web/bundling.js";

const [modules, out] = process.argv.slice(2).map((path) => resolve(path));
const here = dirname(fileURLToPath(import.meta.url));
const bundled = bundler(modules);
const entries = { style: "site.css", site: "site.js", report: "report.js" };
const arrays = Object.entries(entries).map(([name, file]) => `constexpr char ${name}[] =\n${literal(bundled(join(here, file)))};\n`);
const views = Object.keys(entries).map((name) => `{${name}, sizeof ${name} - 1}`);
writeFileSync(
  out,
  `// Made from harness/report/site/web by its bundle.mjs.\n#include "report/site/page.h"\n\nnamespace gnomon::site {\n\n` +
    `namespace {\n${arrays.join("\n")}}  // namespace\n\nAssets assets() { return {${views.join(", ")}}; }\n\n}  // namespace gnomon::site\n`,
);
