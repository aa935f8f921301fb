// What makes a script or a style of modules, and a C++ literal of a text: for the page of a run and the pages of a site.

import { createRequire } from "node:module";
import { join } from "node:path";

/** A function that makes one entry point with everything that it imports, as text. */
export function bundler(modules) {
  const esbuild = createRequire(join(modules, "anything.js"))("esbuild");
  return (entry) => {
    const result = esbuild.buildSync({
      entryPoints: [entry],
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
  };
}

/** String literals in pieces: compilers need not take long ones. */
export function literal(text) {
  const pieces = Buffer.from(text, "utf8")
    .toString("latin1")
    .match(/[^]{1,4000}/g);
  const one = (piece) =>
    '"' + piece.replace(/["\\?\x00-\x1f\x7f-\xff]/g, (c) => "\\" + c.charCodeAt(0).toString(8).padStart(3, "0")) + '"';
  return pieces.map(one).join("\n");
}
