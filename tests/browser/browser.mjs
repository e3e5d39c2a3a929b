// A lab, a browser, and what tests do there again and again. Screenshots for people go to the
// folder LOADFRAME_SCREENSHOTS, if that is set.
import assert from "node:assert/strict";
import { mkdirSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { startLab } from "./lab.mjs";
import { chromium } from "playwright-core";

const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const CHROMIUM = process.env.CHROMIUM ?? "/usr/bin/chromium";
// Without a graphics card the picture in three dimensions is drawn in software; all else is drawn without one, which
// takes three quarters of the time.
const FLAGS = [
  "--no-sandbox",
  "--disable-gpu-compositing",
  "--disable-gpu-rasterization",
  "--use-gl=angle",
  "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
];
const SCREENSHOTS = process.env.LOADFRAME_SCREENSHOTS;
const DESKTOP = { width: 1280, height: 900 };
export const PHONE = { width: 390, height: 844 };
/** What such a browser tells of itself where a picture in three dimensions comes to the page. */
const OF_THE_DRIVER = /GL Driver Message .*GPU stall due to ReadPixels/;
/** Longest wait for anything on the page: only what hangs reaches it. */
const PATIENCE_MS = 60_000;

/** The lab, once it is open. */
export let lab;
let browser;

/** Starts a lab, with these options, and a browser. */
export async function open(options) {
  if (SCREENSHOTS) mkdirSync(SCREENSHOTS, { recursive: true });
  lab = await startLab(options);
  browser = await chromium.launch({ executablePath: CHROMIUM, args: FLAGS });
}

export async function close() {
  await browser?.close();
  await lab?.stop();
}

/**
 * Opens an address of the lab and gives the page to `act`; fails on anything in its console that is
 * not `expected`, and on any request to elsewhere but the origin that is named.
 */
export async function visit(address, act, { viewport = DESKTOP, expected = null, elsewhere = null } = {}) {
  const context = await browser.newContext({ viewport, baseURL: lab.url, acceptDownloads: true });
  context.setDefaultTimeout(PATIENCE_MS);
  const page = await context.newPage();
  const complaints = [];
  // What the pages of `elsewhere` load and complain of is theirs.
  const isTheirs = (url) => elsewhere !== null && !url.startsWith(lab.url);
  page.on("console", (message) => {
    if (isTheirs(message.location().url)) return;
    if (OF_THE_DRIVER.test(message.text())) return;
    if (["error", "warning"].includes(message.type())) complaints.push(message.text());
  });
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("request", (request) => {
    if (isTheirs(request.frame().url())) return;
    const { origin, protocol } = new URL(request.url());
    if (protocol.startsWith("http") && ![lab.url, elsewhere].includes(origin))
      complaints.push(`the page asks ${origin}`);
  });
  try {
    await page.goto(address);
    await act(page);
    assert.deepEqual(
      complaints.filter((text) => !expected?.test(text)),
      [],
    );
  } finally {
    await context.close();
  }
}

export const part = (page, name) => page.getByTestId(name);
/** For people to look at, who ask for it. */
export const picture = (page, name) =>
  SCREENSHOTS && page.screenshot({ path: `${SCREENSHOTS}/${name}.png`, fullPage: true });
export const state = (page, name) => page.locator(`[data-testid=status][data-state=${name}]`).first();

/** All that axe knows of colours. */
export const OF_COLOURS = ["color-contrast", "link-in-text-block"];

/** Axe finds nothing, by all its rules or by these. */
export async function isAccessible(page, where, rules = null) {
  await page.evaluate(AXE);
  const { violations } = await page.evaluate(
    (only) => globalThis.axe.run(only === null ? {} : { runOnly: { type: "rule", values: only } }),
    rules,
  );
  const lines = violations.flatMap(({ id, nodes }) =>
    nodes.map((node) => `${id}: ${node.html}\n${node.failureSummary}`),
  );
  assert.deepEqual(lines, [], where);
}

export async function fitsThePhone(page, where) {
  const [content, screen] = await page.evaluate(() => [document.documentElement.scrollWidth, window.innerWidth]);
  assert.ok(content <= screen, `${where} is ${content} px wide on a screen of ${screen}`);
}

/** The text in the editor, once the page has read it. */
export const written = (page) => page.evaluate(() => sessionStorage.getItem("loadframe-draft") ?? "");

/** Writes a text into the editor, as a paste does. */
export async function writeText(page, text) {
  // the first example is filled in once it has arrived; before that it would overwrite the paste
  await page.waitForFunction(() => (sessionStorage.getItem("loadframe-draft") ?? "") !== "");
  if (!(await part(page, "editor").isVisible())) await part(page, "view-text").check();
  await part(page, "editor").focus();
  await page.keyboard.press("Control+A");
  await page.keyboard.insertText(text);
}
