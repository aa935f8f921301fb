// What the tests of the page share: running the program, opening a page in the browser, looking at it.

import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

export const here = dirname(fileURLToPath(import.meta.url));
const root = join(here, "../..");
const program = process.env.GNOMON_PROGRAM ?? join(root, "build/release/gnomon");
export const faults = process.env.GNOMON_FAULTS ?? join(root, "build/release/gnomon_faults.so");
const modules = process.env.GNOMON_NODE_MODULES ?? join(root, "build/release/report_page/node_modules");
const screenshots = process.env.GNOMON_SCREENSHOTS ?? tmpdir();
const chromium = process.env.GNOMON_CHROMIUM ?? "/usr/bin/chromium";
const require = createRequire(join(modules, "anything.js"));

if (!chromium || chromium.endsWith("NOTFOUND")) {
  console.log("skipped: no Chromium here; scripts/setup --check installs it");
  process.exit(77);
}
const { chromium: browsers } = require("playwright-core");
const axe = require("axe-core").source;

/** A folder that goes with the test. */
export const home = mkdtempSync(join(tmpdir(), "gnomon-report-"));

/** Runs the program to its end and returns what it printed; {status, stdout, stderr} when `status` is requested. */
export function gnomon(args, { status = 0 } = {}) {
  const environment = { ...process.env, GNOMON_CACHE: join(home, "cache") };
  try {
    const stdout = execFileSync(program, args, {
      cwd: home,
      env: environment,
      encoding: "utf8",
      stdio: ["ignore", "pipe", "pipe"],
      maxBuffer: 1 << 28,
    });
    if (status !== 0) throw new Error(`gnomon ${args.join(" ")} exits 0, not ${status}`);
    return stdout;
  } catch (error) {
    if (error.status !== status || status === 0)
      throw new Error(`gnomon ${args.join(" ")}: ${error.status}\n${error.stdout}\n${error.stderr}`);
    return { status: error.status, stdout: error.stdout, stderr: error.stderr };
  }
}

let browser = null;
const patience = 120_000; // ms, for what takes one second: the machine may be busy

export async function openBrowser() {
  const args = ["--no-sandbox", "--disable-gpu", "--disable-quic"];
  browser = await browsers.launch({ executablePath: chromium, args, timeout: patience });
}

export async function closeBrowser() {
  await browser?.close();
  rmSync(home, { recursive: true, force: true });
}

/** In the page, before its own script: counts the pictures that it inflates. */
function countReads() {
  const read = Response.prototype.arrayBuffer;
  window.reads = { begun: 0, ended: 0 };
  Response.prototype.arrayBuffer = async function () {
    ++window.reads.begun;
    try {
      return await read.call(this);
    } finally {
      ++window.reads.ended;
    }
  };
}

/**
 * Waits until the page has done all that follows from what was done to it: its pictures are inflated, and after that frames have
 * passed in which it draws, and learns of its new sizes and places.
 */
export const settled = (page) =>
  page.evaluate(async (patience) => {
    const end = performance.now() + patience;
    let ended;
    do {
      if (performance.now() > end) throw new Error(`not settled after ${patience} ms: ${JSON.stringify(window.reads)}`);
      ({ ended } = window.reads);
      for (let k = 0; k < 4; ++k) await new Promise(requestAnimationFrame);
    } while (ended !== window.reads.begun);
  }, patience);

/**
 * A page that is empty yet. `page.troubles` collects what must not happen: requests that leave the file, messages on the console,
 * errors. Options are those of a browser context.
 */
export async function newPage(options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, reducedMotion: "reduce", ...options });
  context.setDefaultTimeout(patience);
  await context.addInitScript(countReads);
  const page = await context.newPage();
  page.troubles = [];
  page.on("request", (request) => /^(file|data|blob):/.test(request.url()) || page.troubles.push(`request ${request.url()}`));
  page.on("console", (message) => page.troubles.push(`console: ${message.text()}`));
  page.on("pageerror", (error) => page.troubles.push(`error: ${error.message}`));
  return page;
}

/** Opens a report in a page of its own. */
export async function open(file, options = {}) {
  const page = await newPage(options);
  await page.goto(`file://${file}`, { waitUntil: "load" });
  return page;
}

/** Milliseconds of processor time of the whole browser by process. */
async function processorTimes(session) {
  const { processInfo } = await session.send("SystemInfo.getProcessInfo");
  return new Map(processInfo.map(({ id, cpuTime }) => [id, 1000 * cpuTime]));
}

/** The processor time between two readings, that of new processes included. */
const spent = (before, after) => [...after].reduce((sum, [id, time]) => sum + time - (before.get(id) ?? 0), 0);

/** Waits until the browser rests: a new window has parts that are pages, too, and they load some time after it opens. */
async function rest(session) {
  const end = Date.now() + patience;
  let before = await processorTimes(session);
  for (let calm = 0; calm < 3;) {
    if (Date.now() > end) throw new Error(`the browser does not rest after ${patience} ms`);
    await new Promise((done) => setTimeout(done, 200));
    const now = await processorTimes(session);
    calm = spent(before, now) <= 20 ? calm + 1 : 0; // ms; a process is counted in steps of 10
    before = now;
  }
}

/** In a page: arithmetic and memory in no order, as in the loop of tests/budget. It takes about as long as that one. */
function loop() {
  const table = new Map();
  for (let i = 0, value = 1; i < 230_000; ++i) {
    value = (Math.imul(value, 1664525) + 1013904223) >>> 0;
    table.set(value >>> 8, i);
  }
  return [...table.keys()].sort((p, q) => p - q)[0];
}

let loopPage = null;

/** Milliseconds of processor time of some loops. A first one is not counted: the browser compiles it. */
async function loopTimes(session) {
  const counted = [];
  for (let k = 0; k < 4; ++k) {
    const before = await processorTimes(session);
    await loopPage.evaluate(loop);
    if (k > 0) counted.push(spent(before, await processorTimes(session)));
  }
  return counted;
}

/**
 * What some work takes: milliseconds of processor time of the whole browser, milliseconds by the clock, and the milliseconds of
 * processor time of a loop just before and just after it, which say how fast the machine is then. The browser rests before.
 */
export async function costOf(work) {
  const session = await browser.newBrowserCDPSession();
  loopPage ??= await newPage();
  await rest(session);
  const loops = await loopTimes(session);
  const before = await processorTimes(session),
    start = Date.now();
  await work();
  const clock = Date.now() - start;
  const processor = spent(before, await processorTimes(session));
  await rest(session);
  loops.push(...(await loopTimes(session)));
  await session.detach();
  loops.sort((p, q) => p - q);
  return { processor, clock, loop: (loops[loops.length / 2 - 1] + loops[loops.length / 2]) / 2 };
}

/** Where pictures for people go. */
export const saved = (name) => join(screenshots, name);

export const screenshot = (page, name, options = {}) => page.screenshot({ path: saved(`${name}.png`), ...options });

/** What axe finds wrong, one line each. */
export async function accessFindings(page) {
  await page.evaluate(axe);
  const { violations } = await page.evaluate(() =>
    window.axe.run(document, { runOnly: ["wcag2a", "wcag2aa", "wcag21aa", "best-practice"] }),
  );
  return violations.map(
    ({ id, help, nodes }) =>
      `${id}: ${help}: ${nodes
        .slice(0, 3)
        .map((node) => node.target.join(" "))
        .join(", ")}`,
  );
}

/** Indices of the rows that the table shows, in its order. */
export const shownRows = (page) =>
  page.locator("tbody tr[data-row]").evaluateAll((rows) => rows.map((row) => Number(row.dataset.row)));

/** The page's own data. */
export const dataOf = (page) => page.evaluate(() => JSON.parse(document.getElementById("data").textContent));

/** Color [r, g, b] of the canvas where the picture's pixel lies, the whole picture being fit. */
export async function colorAt(page, x, y, name = "viewport") {
  await settled(page);
  return page.evaluate(
    ([x, y, name]) => {
      const canvas = document.querySelector(`.${name} canvas`);
      const [width, height] = canvas.style.aspectRatio.split("/").map(Number);
      const scale = Math.min(canvas.width / width, canvas.height / height);
      const left = (canvas.width - scale * width) / 2,
        top = (canvas.height - scale * height) / 2;
      const copy = new OffscreenCanvas(1, 1).getContext("2d", { willReadFrequently: true });
      copy.drawImage(canvas, -Math.floor(left + (x + 0.5) * scale), -Math.floor(top + (y + 0.5) * scale));
      return [...copy.getImageData(0, 0, 1, 1).data].slice(0, 3);
    },
    [x, y, name],
  );
}

/** What the read-out says, by name. */
export async function readOut(page) {
  await settled(page);
  return page
    .locator(".readout > div")
    .evaluateAll((items) =>
      Object.fromEntries(items.map((item) => [item.children[0].textContent, item.children[1].textContent])),
    );
}

/** Chooses how to compare. The label is clicked, as a reader does it, once it lies still: what was chosen before may still move it. */
export const choose = (page, mode) => page.locator(".modes label").filter({ has: page.locator(`input[value=${mode}]`) }).click();
