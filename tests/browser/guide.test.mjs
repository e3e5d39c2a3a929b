// The guide in a real browser: readable at a desk and on a phone, by keyboard and by screen reader,
// without scripts.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { close, fitsThePhone, isAccessible, OF_COLOURS, open, PHONE, picture, visit } from "./browser.mjs";

before(open);
after(close);

const PAGES = [
  "/guide",
  "/guide/start",
  "/guide/quality",
  "/guide/accuracy",
  "/guide/granular_scene/fields",
  "/guide/validation-ballast",
  "/guide/search?q=inertial+number",
  "/docs",
];
const name = (address) => address.replace(/\W+/g, "-").slice(1);

for (const address of PAGES) {
  test(`${address} is accessible, and fits a phone`, async () => {
    await visit(address, async (page) => {
      await page.emulateMedia({ colorScheme: "light" });
      await isAccessible(page, `${address}, light`);
      await picture(page, `guide-${name(address)}-light`);
      await page.emulateMedia({ colorScheme: "dark" });
      // nothing else differs
      await isAccessible(page, `${address}, dark`, OF_COLOURS);
      await picture(page, `guide-${name(address)}-dark`);
    });
    await visit(
      address,
      async (page) => {
        await fitsThePhone(page, address);
        await isAccessible(page, `${address} on a phone`);
        await picture(page, `guide-${name(address)}-phone`);
      },
      { viewport: PHONE },
    );
  });
}

test("a warning is found, read and left by the keyboard", () =>
  visit("/guide", async (page) => {
    await page.keyboard.press("Tab");
    assert.equal(await page.evaluate(() => document.activeElement.textContent), "Skip to the text");
    await page.getByRole("searchbox").fill("not_settled");
    await page.keyboard.press("Enter");
    await page.getByRole("link", { name: "not_settled", exact: true }).first().click();
    assert.match(page.url(), /\/guide\/quality#not_settled$/);
    const heading = page.locator("#not_settled");
    assert.ok((await heading.boundingBox()).y < 900, "the heading is on the screen");
    await page.getByRole("navigation", { name: "Pages before and after" }).getByRole("link").last().click();
    assert.match(page.url(), /\/guide\/accuracy$/);
  }));

test("a field of a spec is shown at its address", () =>
  visit("/guide/nonwoven_tensile/fields#test.strain_step", async (page) => {
    const field = page.locator(":target");
    assert.equal((await field.innerText()).trim(), "test.strain_step");
    assert.match(await field.locator("xpath=following-sibling::dd[1]").innerText(), /default 0.01/);
  }));
