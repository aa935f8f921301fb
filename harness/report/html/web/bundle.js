// Makes the page's template: bundles the modules and styles of this folder into page.html and writes it as a C++ source file.
//
// usage: node bundle.js NODE_MODULES OUT.cpp

import { createHash } from "node:crypto";
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const [modules, out] = process.argv.slice(2).map((path) => resolve(path));
const here = dirname(fileURLToPath(import.meta.url));
const esbuild = createRequire(join(modules, "anything.js"))("esbuild");

/** One entry point with everything that it imports, as text. */
function bundled(entry) {
  const result = esbuild.buildSync({
    entryPoints: [join(here, entry)],
    bundle: true,
    minify: true,
    write: false,
    format: "iife",
    charset: "ascii",
    target: ["chrome100", "firefox113", "safari16.4"],
    legalComments: "none",
    nodePaths: [modules],
    logLevel: "warning",
  });
  return result.outputFiles[0].text.trim();
}

const script = bundled("main.js");
const parts = {
  "@STYLE@": bundled("style.css"),
  "@SCRIPT@": script,
  "@SCRIPT_HASH@": "sha256-" + createHash("sha256").update(script).digest("base64"),
};
const page = readFileSync(join(here, "page.html"), "utf8").replace(/@(STYLE|SCRIPT|SCRIPT_HASH)@/g, (slot) => parts[slot]);
for (const slot of ["@GNOMON_TITLE@", "@GNOMON_DATA@", "@GNOMON_PICTURES@"]) {
  if (page.split(slot).length !== 2) throw new Error(`the page must hold ${slot} once`);
}

// String literals in pieces: compilers need not take long ones.
const pieces = Buffer.from(page, "utf8")
  .toString("latin1")
  .match(/[^]{1,4000}/g);
const literal = (piece) =>
  '"' + piece.replace(/["\\?\x00-\x1f\x7f-\xff]/g, (c) => "\\" + c.charCodeAt(0).toString(8).padStart(3, "0")) + '"';
writeFileSync(
  out,
  `// Made from harness/report/html/web by its bundle.js.\n#include "report/html/html_parts.h"\n\nnamespace gnomon {\n\n` +
    `namespace {\nconstexpr char page[] =\n${pieces.map(literal).join("\n")};\n}  // namespace\n\n` +
    `std::string_view page_template() { return {page, sizeof page - 1}; }\n\n}  // namespace gnomon\n`,
);
