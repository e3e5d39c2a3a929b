// Pictures of every view, for eyes: `node dev/screenshots.mjs FOLDER [ADDRESS]` against `npm run dev`.
import { chromium } from "playwright-core";

const [folder = "screenshots", address = "http://localhost:5173"] = process.argv.slice(2);
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--disable-gpu"],
});

const first = await (await fetch(`${address}/v1/jobs?limit=100`)).json();
const oneOf = (test) => first.items.find(test)?.id;
const done = oneOf((job) => job.outcome === "succeeded");
const ballast = oneOf((job) => job.outcome === "succeeded" && job.kind.startsWith("ballast"));
const running = oneOf((job) => job.status === "running");

const views = [
  ["list", "/"],
  ...(done ? [["done", `/jobs/${done}`]] : []),
  ...(ballast ? [["ballast", `/jobs/${ballast}`]] : []),
  ...(running ? [["running", `/jobs/${running}`]] : []),
  ["compare", "/compare?tag=series&by=%2Fspec%2Fbond%2Fmodulus_n"],
  ["submit", "/submit"],
];
const screens = [
  ["desktop", { viewport: { width: 1280, height: 860 }, colorScheme: "light" }],
  ["dark", { viewport: { width: 1280, height: 860 }, colorScheme: "dark" }],
  ["phone", { viewport: { width: 390, height: 844 }, colorScheme: "light", deviceScaleFactor: 2 }],
];

for (const [screen, options] of screens) {
  const context = await browser.newContext(options);
  const page = await context.newPage();
  page.on("console", (message) => message.type() === "error" && console.error(screen, message.text()));
  page.on("pageerror", (error) => console.error(screen, error));
  for (const [view, path] of views) {
    await page.goto(address + path);
    if (view === "submit") {
      const examples = page.getByTestId("example");
      await examples.locator("option:not([disabled])").first().waitFor({ state: "attached" });
      await examples.selectOption({ index: 1 });
      await page.locator('[data-testid="estimate"][data-ready="true"]').waitFor();
    } else if (view === "list") {
      await page.getByTestId("job-row").first().waitFor();
    } else {
      await page.locator(".uplot").waitFor();
    }
    await page.waitForTimeout(400);
    await page.screenshot({ path: `${folder}/${view}-${screen}.png`, fullPage: true });
  }
  await context.close();
}
await browser.close();
