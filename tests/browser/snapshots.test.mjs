// Snapshots in three dimensions: what they hold, how they are coloured, and that they move.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { close, fitsThePhone, isAccessible, open, part, PHONE, picture, state, visit } from "./browser.mjs";

before(open);
after(close);

/** Runs an example and opens its view; gives the job's id. */
async function view(page, kind, name) {
  const examples = await (await page.request.get(`/v1/kinds/${kind}/examples`)).json();
  const { job } = examples.items.find((example) => example.name === name);
  const answer = await page.request.post("/v1/jobs", { data: job });
  assert.equal(answer.status(), 201, await answer.text());
  const { id } = await answer.json();
  await page.goto(`/jobs/${id}`);
  await state(page, "succeeded").waitFor();
  assert.ok(
    !(await page.evaluate(() => performance.getEntriesByType("resource").some(({ name }) => name.includes("three")))),
    "three dimensions are fetched before anybody asks",
  );
  await part(page, "show-snapshots").press("Enter");
  await page.waitForFunction(() => Number(document.querySelector("[data-testid=viewport]")?.dataset.frame) >= 0);
  return id;
}

/** The picture as it is seen, once it has been drawn. */
async function seen(page) {
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  return (await part(page, "viewport").screenshot()).toString("base64");
}

const isAt = (page, frame) =>
  page.waitForFunction(
    (frame) => document.querySelector("[data-testid=viewport]")?.dataset.frame === String(frame),
    frame,
  );

test("a grain breaks into its fragments before one's eyes", () =>
  visit("/", async (page) => {
    await view(page, "granular_scene", "granular_scene_breaking_clump");
    const moment = part(page, "snapshots").getByRole("slider", { name: "Moment" });
    const last = Number(await moment.getAttribute("max"));
    assert.match(
      await part(page, "inventory").innerText(),
      /^57 spheres, 1 polygon of walls and \d+ contact forces\.$/,
    );
    assert.equal(await part(page, "spheres-by").inputValue(), "fragment");
    const broken = await seen(page);
    await picture(page, "snapshots");
    await isAccessible(page, "snapshots");

    await part(page, "spheres-by").selectOption("velocity_m_per_s");
    assert.match(await part(page, "snapshots").innerText(), /… [\d.]+\sm\/s/u);
    assert.notEqual(await seen(page), broken);
    await part(page, "spheres-by").selectOption("fragment");
    await part(page, "has-lines").check();
    assert.notEqual(await seen(page), broken);
    await part(page, "has-lines").uncheck();

    await moment.fill("0");
    await isAt(page, 0);
    assert.notEqual(await seen(page), broken);
    // plays to the end and stops there
    await part(page, "play").press("Enter");
    await isAt(page, last);
    await page.waitForFunction(() => document.querySelector("[data-testid=play]").innerText === "Play");
    await page.setViewportSize(PHONE);
    await fitsThePhone(page, "snapshots");
    await picture(page, "phone-snapshots");
  }));

test("a fabric shows its bonds, and those that broke no more", () =>
  visit("/", async (page) => {
    const id = await view(page, "nonwoven_tensile", "nonwoven_tensile_quick");
    const { summary } = await (await page.request.get(`/v1/jobs/${id}`)).json();
    const broken = summary.broken_bonds.value;
    assert.equal(
      await part(page, "inventory").innerText(),
      `${summary.bonds.value - broken} bonds and ${broken} broken bonds.`,
    );
    assert.equal(await part(page, "has-lines").isChecked(), true);
  }));

test("a section is seen face on, in the colours of its stress", () =>
  visit("/", async (page) => {
    const id = await view(page, "composite_bending", "composite_bending");
    const { summary } = await (await page.request.get(`/v1/jobs/${id}`)).json();
    assert.equal((await part(page, "inventory").innerText()).replaceAll(/[^\d]/g, ""), String(summary.cells.value));
    const told = await part(page, "snapshots").innerText();
    assert.match(told, /full load/i);
    assert.match(told, /drawn [\d.]+ times as large/);
    assert.match(told, /… [\d.]+\sMPa/u);
    // one moment is not played
    assert.equal(await part(page, "play").count(), 0);
    assert.equal(await part(page, "cells-by").inputValue(), "stress_mises_mpa");
    const stressed = await seen(page);
    await picture(page, "section");
    await part(page, "cells-by").selectOption("strain_xx");
    const strained = await seen(page);
    assert.notEqual(strained, stressed);
    await part(page, "viewport").focus();
    await page.keyboard.press("ArrowRight");
    await part(page, "cells-by").focus();
    assert.notEqual(await seen(page), strained);

    // how wrong a result is stands beside it, and where that is known from below
    const deflection = page.locator('[data-result="mean_top_deflection"]');
    assert.match(await deflection.innerText(), /± [\d.]+/);
    await part(page, "errors").locator("summary").press("Enter");
    assert.match(await part(page, "errors").innerText(), /Grid\s+from coarser grids/);
    await isAccessible(page, "a section");
    await page.setViewportSize(PHONE);
    await fitsThePhone(page, "a section");
    await picture(page, "phone-section");
  }));

test("a section that breaks is seen at its peak and at its end, with its damage", () =>
  visit("/", async (page) => {
    await view(page, "composite_bending", "composite_bending_break");
    const moment = part(page, "snapshots").getByRole("slider", { name: "Moment" });
    assert.equal(await moment.getAttribute("max"), "1");
    assert.match(await part(page, "snapshots").innerText(), /at [\d.]+\smm/u);
    await part(page, "cells-by").selectOption("damage");
    const end = await seen(page);
    await picture(page, "breaking-section");
    await moment.fill("0");
    await isAt(page, 0);
    assert.notEqual(await seen(page), end);
    await isAccessible(page, "breaking section");
  }));

test("a unit cell shows where its fibres are and what pulls at them", () =>
  visit("/", async (page) => {
    await view(page, "composite_cell", "composite_cell_hexagonal");
    assert.match(await part(page, "inventory").innerText(), /cells\.$/);
    assert.equal(await part(page, "cells-by").inputValue(), "stress_mises_mpa");
    const stressed = await seen(page);
    await picture(page, "unit-cell");
    await part(page, "cells-by").selectOption("fibre_share");
    assert.notEqual(await seen(page), stressed);
    assert.match(await page.locator('[data-result="modulus_2"]').innerText(), /± [\d.]+/);
  }));

test("a sheet of paper shows its fibres, its bonds, and which of them broke", () =>
  visit("/", async (page) => {
    await view(page, "paper_tensile", "paper_tensile_directions");
    assert.match(await part(page, "inventory").innerText(), /^[\d\s]+segments, [\d\s]+bonds and [\d\s]+breaks\.$/u);
    assert.equal(await part(page, "has-lines").isChecked(), true);
    await picture(page, "paper-sheet");
    await isAccessible(page, "sheet of paper");
  }));

/** Opens the Submit page with an example whose spec is valid. */
async function writes(page, name) {
  await part(page, "example").selectOption(name);
  await page.waitForSelector("[data-testid=estimate][data-ready=true]");
}

test("a specimen is seen before its job is submitted, and drawn again for every other spec", () =>
  visit("/submit", async (page) => {
    await writes(page, "nonwoven_tensile_quick");
    await part(page, "show-specimen").press("Enter");
    await isAt(page, 0);
    const fabric = await part(page, "inventory").innerText();
    assert.match(fabric, /^[\d\s]+bonds\.$/u);
    assert.match(await part(page, "specimen-shows").innerText(), /not strained yet/);
    const first = await seen(page);
    await picture(page, "specimen-fabric");
    await isAccessible(page, "a specimen");

    // another number of rows is another fabric
    await page.locator('[id="field/spec/fabric/lattice/rows"]').fill("13");
    await page.waitForFunction(
      (known) => document.querySelector("[data-testid=inventory]").innerText !== known,
      fabric,
    );
    assert.notEqual(await seen(page), first);

    // and another example another specimen, of another kind
    await writes(page, "ballast_oedometer");
    await page.waitForFunction(() =>
      document.querySelector("[data-testid=specimen-shows]").innerText.includes("Pouring"),
    );
    await picture(page, "specimen-ballast");
  }));

test("a specimen that is too large for a picture is told so", () =>
  visit(
    "/submit",
    async (page) => {
      await writes(page, "nonwoven_tensile_quick");
      await page.locator('[id="field/spec/fabric/lattice/rows"]').fill("5001");
      await page.waitForSelector("[data-testid=estimate][data-ready=false]");
      await page.waitForSelector("[data-testid=estimate][data-ready=true]");
      await part(page, "show-specimen").press("Enter");
      assert.match(await part(page, "specimen-error").innerText(), /too much for a picture.*at most 200000/i);
    },
    { expected: /422/ },
  ));
