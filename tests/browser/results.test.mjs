// The table of results: a value and how wrong it may be are read together, on any screen and without a mouse.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { close, fitsThePhone, isAccessible, open, part, PHONE, picture, state, visit } from "./browser.mjs";

before(open);
after(close);

/** Runs an example, changed, and opens its page. */
async function ran(page, kind, name, change) {
  const examples = await (await page.request.get(`/v1/kinds/${kind}/examples`)).json();
  const { job } = examples.items.find((example) => example.name === name);
  change(job.spec);
  const answer = await page.request.post("/v1/jobs", { data: job });
  assert.equal(answer.status(), 201, await answer.text());
  const { id } = await answer.json();
  await page.goto(`/jobs/${id}`);
  await state(page, "succeeded").waitFor();
  const { summary } = await (await page.request.get(`/v1/jobs/${id}`)).json();
  return summary;
}

/** The number after a word or sign, as it is written. */
const numberAfter = (text, sign) => Number(new RegExp(`${sign} ([\\d.]+)`).exec(text)?.[1]);
/** Two digits are shown. */
const isRounded = (shown, exact) => assert.ok(Math.abs(shown / exact - 1) < 0.06, `${shown} for ${exact}`);

test("the mean of repeats stands with its standard error, and what they scatter by in words", () =>
  visit("/", async (page) => {
    const summary = await ran(page, "composite_cell", "composite_cell", (spec) => {
      spec.accuracy = "draft";
      spec.repeats = 3;
      spec.arrangement.random.fibres = 8;
    });
    const { error, deviation, unit } = summary.modulus_2;
    assert.deepEqual([unit, summary.modulus_2.n], ["MPa", 3]);
    const sources = error.parts.map(({ source }) => source);
    assert.ok(sources.includes("specimens") && sources.includes("grid"), String(sources));

    const isRead = async () => {
      const row = page.locator('[data-result="modulus_2"]');
      const text = (await row.innerText()).replaceAll(/[\u202f\u00a0]/g, "");
      isRounded(numberAfter(text, "±"), error.value);
      isRounded(numberAfter(text, "deviation"), deviation);
      assert.match(text, /deviation [\d.]+ of 3/);
      assert.ok(await row.locator(".error").isVisible());
      // and of every other result that has one
      const withError = Object.values(summary).filter(({ value, error }) => error?.value > 1e-12 * Math.abs(value));
      assert.equal(await page.locator("[data-result] .error").count(), withError.length);
    };
    await isRead();
    await isAccessible(page, "results with their errors");
    await picture(page, "results");
    // what they are made of is opened and scrolled by keyboard
    const errors = part(page, "errors");
    await errors.locator("summary").focus();
    await page.keyboard.press("Enter");
    assert.match(await errors.innerText(), /± is one standard error, all parts together; a deviation is/);
    await page.keyboard.press("Tab");
    assert.equal(await page.evaluate(() => document.activeElement.getAttribute("role")), "region");
    await isAccessible(page, "parts of errors");

    await page.setViewportSize(PHONE);
    await isRead();
    await fitsThePhone(page, "results with their errors");
    await isAccessible(page, "results on a phone");
    await picture(page, "phone-results");
  }));
