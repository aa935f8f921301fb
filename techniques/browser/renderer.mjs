// Opens the page of an engine in headless Chromium, passes requests on to it and its answers back.
//
// Requests come as lines of JSON on standard input, answers go to the file descriptor that GNOMON_ANSWERS names. A pipe joins
// Chromium to this process: it ends when the pipe does, however this process ends.

import { createWriteStream } from "node:fs";
import { writeFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { createInterface } from "node:readline";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

const here = dirname(fileURLToPath(import.meta.url));
const site = "https://gnomon.invalid/"; // leads nowhere: each of its files is given by `serve`
// OpenGL through EGL needs no display. --use-angle=gl needs one; without it Chromium draws with SwiftShader and does not say so.
const flags = {
  angle_gl: ["--use-angle=gl-egl", "--ignore-gpu-blocklist"],
  swiftshader: ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
};
const refused = ["--enable-unsafe-swiftshader"]; // of the flags that Playwright gives
// An isolated page has a clock of 5 microseconds; others of 100.
const headers = { "Cross-Origin-Opener-Policy": "same-origin", "Cross-Origin-Embedder-Policy": "require-corp" };

let page, folder, html;

function serve(route) {
  const name = new URL(route.request().url()).pathname.slice(1);
  if (name === "") return route.fulfill({ headers, contentType: "text/html", body: html });
  const [, place, rest] = /^(modules|data)\/(.*)$/.exec(name) ?? [null, null, name];
  const path = join({ modules: join(here, "node_modules"), data: folder }[place] ?? here, rest);
  return route.fulfill({ headers, path, contentType: place === "data" ? "application/octet-stream" : "text/javascript" });
}

async function start({ folder: given, program, gl, page: script, imports }) {
  folder = given;
  imports = Object.fromEntries(Object.entries(imports).map(([name, path]) => [name, `${site}modules/${path}`]));
  html = `<!doctype html><script type="importmap">${JSON.stringify({ imports })}</script>`;
  const args = ["--no-sandbox", ...flags[gl]]; // root has no sandbox, nor have most containers
  const browser = await chromium.launch({ executablePath: program, args, ignoreDefaultArgs: refused });
  page = await browser.newPage({ viewport: { width: 64, height: 64 }, deviceScaleFactor: 1 });
  page.on("console", (message) => console.error(message.text()));
  await page.route(`${site}**`, serve);
  await page.goto(site);
  const facts = await page.evaluate(async ([common, script]) => {
    window.engine = await import(common);
    return window.engine.start(await import(script));
  }, [`${site}page.mjs`, `${site}${script}`]);
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
