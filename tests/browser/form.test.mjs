// The Submit page as a form: it and the text follow each other, errors stand at their fields, and long texts stay
// editable.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import {
  close,
  fitsThePhone,
  isAccessible,
  open,
  part,
  PHONE,
  picture,
  visit,
  writeText,
  written,
} from "./browser.mjs";

before(open);
after(close);

const ROWS = "/spec/fabric/lattice/rows";
const MODULUS = "/spec/bond/modulus_n";

/** The control of a field by its JSON pointer. */
const control = (page, pointer) => page.locator(`[id="field${pointer}"]`);
/** The whole line or frame of a field. */
const field = (page, pointer) => page.locator(`[data-testid=field][data-pointer="${pointer}"]`);
const message = (page, pointer) => page.locator(`[id="field${pointer}-wrong"]`);
const estimated = (page) => page.waitForSelector("[data-testid=estimate][data-ready=true]");

/** Opens the page with the quick example. */
async function start(page) {
  await part(page, "form").waitFor();
  await part(page, "example").selectOption("nonwoven_tensile_quick");
  await page.waitForFunction(() => sessionStorage.getItem("loadframe-draft")?.includes("quick look"));
  await estimated(page);
}

/** Waits until the page has read a text of which `isSo` is true. */
async function reads(page, isSo) {
  for (;;) {
    const text = await written(page);
    if (isSo(text)) return text;
    await page.waitForTimeout(50);
  }
}

test("a form that is filled in writes the text, and its job is submitted", () =>
  visit(
    "/submit?view=both",
    async (page) => {
      await start(page);
      const before = await written(page);
      await control(page, ROWS).fill("13");
      const changed = await reads(page, (text) => text.includes('"rows": 13'));
      // not a byte besides
      assert.equal(changed.replace('"rows": 13', ""), before.replace(/"rows": \d+/, ""));
      assert.match(await part(page, "editor").innerText(), /"rows": 13/);

      // what was left out is put where the schema has it, and taken out again
      await control(page, "/spec/fabric/lattice/thickness_mm").fill("0.5");
      await reads(page, (text) => JSON.parse(text).spec.fabric.lattice.thickness_mm === 0.5);
      await control(page, "/spec/fabric/lattice/thickness_mm").fill("");
      await reads(page, (text) => text === changed);

      // a part is switched on and off, and comes back as it was
      const history = page.getByRole("checkbox", { name: "History" });
      await history.check();
      await reads(page, (text) => "history" in JSON.parse(text).spec.test);
      await page
        .locator('[data-testid=field][data-pointer="/spec/test/history"]')
        .getByRole("button", { name: "Add", exact: false })
        .click();
      const withBlock = await reads(page, (text) => JSON.parse(text).spec.test.history.length === 1);
      await history.uncheck();
      await reads(page, (text) => text === changed);
      await history.check();
      await reads(page, (text) => text === withBlock);
      await history.uncheck();

      await control(page, "/spec/bond/strength_draw").selectOption({ label: "Normal" });
      await reads(page, (text) => JSON.parse(text).spec.bond.strength_draw === "normal");
      await control(page, "/spec/fabric/lattice/spacing_mm/1").fill("2.25");
      await reads(page, (text) => JSON.parse(text).spec.fabric.lattice.spacing_mm[1] === 2.25);

      await estimated(page);
      await picture(page, "submit-form");
      await part(page, "submit").click();
      await page.waitForURL(/\/jobs\/[0-9a-f-]{36}$/);
      const { spec } = await (await page.request.get(`/v1${new URL(page.url()).pathname}`)).json();
      assert.equal(spec.fabric.lattice.rows, 13);
      assert.equal(spec.bond.strength_draw, "normal");
    },
    { expected: /status of 422/ },
  ));

test("a text that is edited changes the form, and undo brings back what the form wrote over", () =>
  visit(
    "/submit?view=both",
    async (page) => {
      await start(page);
      const job = JSON.parse(await written(page));
      const rows = String(job.spec.fabric.lattice.rows);
      await control(page, ROWS).fill("99");
      await part(page, "editor").focus();
      await page.keyboard.press("Control+Z");
      await page.waitForFunction(([id, rows]) => document.getElementById(id).value === rows, [`field${ROWS}`, rows]);

      job.spec.fabric.lattice.rows = 21;
      job.spec.accuracy = "draft";
      job.spec.unheard_of = { a: [1, 2] };
      await writeText(page, JSON.stringify(job, null, 1));
      await page.waitForFunction((id) => document.getElementById(id).value === "21", `field${ROWS}`);
      assert.equal(await control(page, "/spec/accuracy").locator("option:checked").innerText(), "Draft");
      // what the schema does not know is shown, not lost
      assert.match(await field(page, "/spec/unheard_of").innerText(), /"a": \[ ?1, 2 ?\]/);
    },
    { expected: /status of 422/ },
  ));

test("a text with a mistake is left alone until it is mended; the form waits", () =>
  visit("/submit?view=both", async (page) => {
    await start(page);
    const whole = await written(page);
    const broken = whole.replace('"rows":', '"rows"');
    await writeText(page, broken);
    await part(page, "form-waits").waitFor();
    assert.ok(await control(page, MODULUS).isDisabled());
    assert.equal(await written(page), broken);
    assert.match(await part(page, "violations").innerText(), /Expected “:” after “rows”/);
    await isAccessible(page, "a text with a mistake");
    await writeText(page, whole);
    await part(page, "form-waits").waitFor({ state: "detached" });
    await control(page, MODULUS).fill("0.5");
    await reads(page, (text) => JSON.parse(text).spec.bond.modulus_n === 0.5);
  }));

test("an error stands at its field, and goes when it is mended", () =>
  visit(
    "/submit",
    async (page) => {
      await start(page);
      await control(page, MODULUS).fill("-1");
      await message(page, MODULUS).getByText("out of range").waitFor();
      assert.equal(await control(page, MODULUS).getAttribute("aria-invalid"), "true");
      const described = (await control(page, MODULUS).getAttribute("aria-describedby")).split(" ");
      assert.ok(described.includes(`field${MODULUS}-wrong`));
      const hint = await page.locator(`[id="${described[0]}"]`).innerText();
      assert.match(hint, /^N · 1e-12 … 1e12/);
      await picture(page, "submit-form-error");
      await isAccessible(page, "a form with an error");

      // what is no number is kept as it was typed, and refused
      await control(page, MODULUS).fill("0,4");
      await message(page, MODULUS).getByText("found string").waitFor();
      assert.equal(await control(page, MODULUS).inputValue(), "0,4");
      await part(page, "submit").click();
      await page.waitForFunction((id) => document.activeElement?.id === id, `field${MODULUS}`);

      // one that is missing has its field too, and the list beside leads to it
      await control(page, MODULUS).fill("0.4");
      await control(page, ROWS).fill("");
      await message(page, ROWS).getByText("missing").waitFor();
      await page.locator(`[data-testid=violation][data-pointer="${ROWS}"]`).click();
      await page.waitForFunction((id) => document.activeElement?.id === id, `field${ROWS}`);
      await page.keyboard.insertText("15");
      await part(page, "violations").waitFor({ state: "detached" });
      await estimated(page);
      // the browser itself reports the refusals in its console
    },
    { expected: /status of 422/ },
  ));

test("presets tell their price", () =>
  visit("/submit", async (page) => {
    await start(page);
    await part(page, "ask-prices").click();
    const prices = part(page, "prices");
    await prices.waitFor();
    assert.deepEqual(await prices.locator("dt").allInnerTexts(), ["Draft", "Standard", "Reference"]);
    for (const price of await prices.locator("dd").allInnerTexts()) assert.match(price, /^about .+\sm?s.*,\s.+B$/);
    // of another job they are not
    await control(page, ROWS).fill("15");
    await prices.waitFor({ state: "detached" });
  }));

test("every example of every kind is a form in which nothing is foreign", () =>
  visit("/submit", async (page) => {
    await part(page, "form").waitFor();
    for (const { kind } of (await (await page.request.get("/v1/kinds")).json()).items) {
      const { items } = await (await page.request.get(`/v1/kinds/${kind}/examples`)).json();
      for (const { name, job } of items) {
        await part(page, "example").selectOption(name);
        await page.waitForFunction(
          (name) => sessionStorage.getItem("loadframe-draft")?.includes(name),
          JSON.stringify(job.name),
        );
        // a calibration's inner job is text
        const known = kind === "calibrate" ? ["/spec/job/spec"] : [];
        await field(page, "/spec/version").waitFor();
        const raw = await page
          .getByRole("button", { name: "Remove" })
          .evaluateAll((buttons) =>
            buttons
              .filter((button) => button.closest("[role=group]")?.querySelector("code"))
              .map((button) => button.closest("[data-pointer]").dataset.pointer),
          );
        assert.deepEqual(
          raw.filter((pointer) => !known.includes(pointer)),
          [],
          name,
        );
      }
    }
  }));

test("five megabytes stay editable, as text and in the form", () =>
  visit("/submit?view=both", async (page) => {
    await start(page);
    const nodes = Array.from({ length: 200_000 }, (_, index) =>
      [index / 7, index / 11, 0].map((x) => Number(x.toFixed(6))),
    );
    const job = JSON.parse(await written(page));
    job.spec.fabric = { network: { nodes_mm: nodes, jaws: [], bonds: [] } };
    const text = JSON.stringify(job);
    assert.ok(text.length > 5e6, `${text.length}`);
    await part(page, "open-file").setInputFiles({
      name: "large.json",
      mimeType: "application/json",
      buffer: Buffer.from(text),
    });
    await part(page, "long-text").waitFor();
    const list = field(page, "/spec/fabric/network/nodes_mm");
    assert.match(
      await list.getByTestId("long-list").innerText(),
      /The first 8 of 200000 entries; 199992 more stand in the text/,
    );
    // a finished entry reaches the text
    await control(page, MODULUS).fill("0.125");
    await control(page, MODULUS).press("Tab");
    await list.getByRole("button", { name: "Edit as text" }).click();
    await page.keyboard.insertText("  ");
    await part(page, "editor").getByText(":  [[", { exact: false }).waitFor();
    // the form is made anew, from the text
    await part(page, "view-text").check();
    await part(page, "view-both").check();
    assert.equal(await control(page, MODULUS).inputValue(), "0.125");
  }));

test("the editor completes what the schema knows", () =>
  visit(
    "/submit?view=text",
    async (page) => {
      await page.waitForFunction(() => (sessionStorage.getItem("loadframe-draft") ?? "") !== "");
      await writeText(page, '{"kind": "nonwoven_tensile", "spec": {"version": 1, "bond": {');
      await page.waitForTimeout(500);
      await page.keyboard.type('"fric');
      const offer = page.locator(".cm-tooltip-autocomplete");
      await offer.getByText("friction_modulus_n").waitFor();
      await isAccessible(page, "a completion");
      await page.keyboard.press("Enter");
      await reads(page, (text) => text.includes('"friction_modulus_n": '));
      await part(page, "editor").getByText('"version"').hover();
      await page.locator(".field-tooltip").getByText("Version of this spec's format.").waitFor();
    },
    { expected: /status of 4/ },
  ));

test("the form fits a phone", () =>
  visit(
    "/submit",
    async (page) => {
      await start(page);
      await fitsThePhone(page, "the form");
      await picture(page, "phone-submit-form");
      await isAccessible(page, "the form on a phone");
      await part(page, "view-text").check();
      await fitsThePhone(page, "the text");
    },
    { viewport: PHONE },
  ));
