// Opens a page with three.js in headless Chromium, passes requests on to it and its answers back.
//
// Requests come as lines of JSON on standard input, answers go to the file descriptor that GNOMON_ANSWERS names. A pipe joins
// Chromium to this process: it ends when the pipe does, however this process ends.

import { createWriteStream } from "node:fs";
import { writeFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { dirname, join } from "node:path";
import { createInterface } from "node:readline";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

const here = dirname(fileURLToPath(import.meta.url));
const three = dirname(dirname(createRequire(import.meta.url).resolve("three")));
const site = "https://gnomon.invalid/"; // leads nowhere: each of its files is given by `route`
// OpenGL through EGL needs no display. --use-angle=gl needs one; without it Chromium draws with SwiftShader and does not say so.
const flags = {
  angle_gl: ["--use-angle=gl-egl", "--ignore-gpu-blocklist"],
  swiftshader: ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
};
const refused = ["--enable-unsafe-swiftshader"]; // of the flags that Playwright gives
const imports = { three: `${site}three/build/three.module.js`, "three/addons/": `${site}three/examples/jsm/` };
const html = `<!doctype html><script type="importmap">${JSON.stringify({ imports })}</script>`;
// An isolated page has a clock of 5 microseconds; others of 100.
const headers = { "Cross-Origin-Opener-Policy": "same-origin", "Cross-Origin-Embedder-Policy": "require-corp" };

let page, folder;

function serve(route) {
  const name = new URL(route.request().url()).pathname.slice(1);
  if (name === "") return route.fulfill({ headers, contentType: "text/html", body: html });
  const [, place, rest] = /^(three|data)\/(.*)$/.exec(name) ?? [null, null, name];
  const path = join({ three, data: folder }[place] ?? here, rest);
  return route.fulfill({ headers, path, contentType: place === "data" ? "application/octet-stream" : "text/javascript" });
}

async function start({ folder: given, program, gl }) {
  folder = given;
  const args = ["--no-sandbox", ...flags[gl]]; // root has no sandbox, nor have most containers
  const browser = await chromium.launch({ executablePath: program, args, ignoreDefaultArgs: refused });
  page = await browser.newPage({ viewport: { width: 64, height: 64 }, deviceScaleFactor: 1 });
  page.on("console", (message) => console.error(message.text()));
  await page.route(`${site}**`, serve);
  await page.goto(site);
  const facts = await page.evaluate(async (script) => {
    window.engine = await import(script);
    return window.engine.start();
  }, `${site}page.mjs`);
  return { ...facts, browser: browser.version() };
}

async function answer({ do: doing, ...request }) {
  if (doing === "start") return start(request);
  const done = (await page.evaluate(([doing, request]) => window.engine[doing](request), [doing, request])) ?? {};
  if ("picture" in done) {
    await writeFile(join(folder, request.file), Buffer.from(done.picture, "base64"));
    delete done.picture;
  }
  return done;
}

const reason = (problem) => problem.message.split("\n")[0].replace(/^page\.\w+: (Error: )?/, "");

const answers = createWriteStream(null, { fd: Number(process.env.GNOMON_ANSWERS) });
for await (const line of createInterface({ input: process.stdin })) {
  const said = await answer(JSON.parse(line)).catch((problem) => ({ error: reason(problem) }));
  answers.write(`${JSON.stringify(said)}\n`);
}
process.exit(); // and Chromium with it
