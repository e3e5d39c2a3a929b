// Links from the page to the guide: what each is about, that it can be reached by keyboard, and that it is left to the
// server.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { close, fitsThePhone, isAccessible, open, part, PHONE, picture, state, visit } from "./browser.mjs";

before(open);
after(close);

const about = (scope, name) => scope.getByRole("link", { name: `about ${name} in the guide`, exact: true });

/** Follows a link with the keyboard; the page must not answer in the server's place. */
async function follow(page, link, address) {
  await page.evaluate(() => (globalThis.isSamePage = true));
  await link.press("Enter");
  await page.waitForFunction(() => !globalThis.isSamePage);
  const { pathname, hash } = new URL(page.url());
  assert.match(pathname + hash, address);
}

test("top bar and foot lead to the guide", () =>
  visit("/", async (page) => {
    for (const place of ["navigation", "contentinfo"]) {
      await follow(page, page.getByRole(place).getByRole("link", { name: "Guide" }), /^\/guide$/);
      await page.goto("/");
    }
  }));

test("a field leads to its entry, and the kind to its page", () =>
  visit("/submit", async (page) => {
    await part(page, "example").selectOption("nonwoven_tensile_quick");
    await part(page, "view-text").check();
    const line = (name) => part(page, "editor").locator(".cm-line", { hasText: name });
    const help = part(page, "field-help");
    for (const [place, anchor] of [
      [line('"strain_step"').getByText('"strain_step"'), "test.strain_step"],
      [line('"spacing_mm"').getByText("2", { exact: true }).last(), "fabric.lattice.spacing_mm"],
    ]) {
      await place.click();
      const link = about(help, anchor);
      await link.waitFor();
      assert.equal(await link.getAttribute("href"), `/guide/nonwoven_tensile/fields#${anchor}`);
    }
    await picture(page, "submit-help");
    await isAccessible(page, "a field's help");
    await page.setViewportSize(PHONE);
    await fitsThePhone(page, "a field's help");
    await picture(page, "phone-submit-help");
    await follow(page, part(page, "kind-guide"), /^\/guide\/nonwoven_tensile$/);
  }));

test("every check and warning of a job leads to what it means", () =>
  visit("/", async (page) => {
    const examples = await (await page.request.get("/v1/kinds/nonwoven_tensile/examples")).json();
    const { job } = examples.items.find(({ name }) => name === "nonwoven_tensile_quick");
    // nothing is drawn at random: two specimens that are alike are warned of
    job.spec.fabric.lattice.irregularity = [0, 0, 0];
    job.spec.bond.strength_sigma = 0;
    job.spec.test = { strain_step: 0.05, max_strain: 0.3, repeats: 2 };
    const { id } = await (await page.request.post("/v1/jobs", { data: job })).json();
    await page.goto(`/jobs/${id}`);
    await state(page, "succeeded").waitFor();
    const outcome = await (await page.request.get(`/v1/jobs/${id}/outcome`)).json();
    assert.ok(outcome.warnings.length > 0, "nothing is warned of");
    for (const [place, names] of [
      ["quality", Object.keys(outcome.quality)],
      ["warnings", outcome.warnings.map(({ code }) => code)],
    ]) {
      for (const name of names) {
        const link = about(part(page, place), name).first();
        await link.waitFor();
        assert.equal(await link.getAttribute("href"), `/guide/quality#${name}`);
      }
    }
    for (const scheme of ["light", "dark"]) {
      await page.emulateMedia({ colorScheme: scheme });
      await isAccessible(page, `a job with warnings, ${scheme}`);
      await picture(page, `warnings-${scheme}`);
    }
    await page.emulateMedia({ colorScheme: "light" });
    await page.setViewportSize(PHONE);
    await fitsThePhone(page, "a job with warnings");
    const [table, card] = await part(page, "quality").evaluate((table) => [
      table.scrollWidth,
      table.parentElement.clientWidth,
    ]);
    assert.ok(table <= card, `the checks are ${table} px wide in ${card}`);
    await picture(page, "phone-warnings");
    await follow(page, about(page, "nonwoven_tensile"), /^\/guide\/(nonwoven_tensile|ballast)/);
  }));
