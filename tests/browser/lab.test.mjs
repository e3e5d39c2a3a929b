// The lab page in a real browser against a real lab: what a person does on a day at the testing
// machine.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { readFileSync } from "node:fs";
import { availableParallelism } from "node:os";
import {
  close,
  fitsThePhone,
  isAccessible,
  lab,
  open,
  part,
  PHONE,
  picture,
  state,
  visit,
  writeText,
  written,
} from "./browser.mjs";

before(open);
after(close);

function job(spec = {}) {
  return {
    kind: "nonwoven_tensile",
    name: "From the browser",
    spec: {
      version: 1,
      fabric: {
        lattice: { points_per_row: 15, rows: 17, layers: 3, spacing_mm: [20, 20, 10], irregularity: [0.5, 0.5, 0.5] },
      },
      bond: {
        modulus_n: 0.399,
        friction_modulus_n: 1.473,
        compression_stiffness_n: 0.157,
        mean_strength_n: 3.397,
        strength_sigma: 0.365,
      },
      ...spec,
    },
  };
}
/** Work for minutes: nobody waits for its end. */
function endless() {
  const long = job({ test: { strain_step: 0.000002, max_strain: 3 }, output: { snapshot_every_steps: 0 } });
  Object.assign(long.spec.fabric.lattice, { points_per_row: 49, rows: 51 });
  return long;
}

/** Submits what is in the editor; gives the new job's id. */
async function submit(page) {
  await part(page, "submit").click();
  await page.waitForURL(/\/jobs\/[0-9a-f-]{36}$/);
  return page.url().split("/").at(-1);
}

test("the quick example goes from the page to curve, results and files", () =>
  visit("/", async (page) => {
    await part(page, "new-job").click();
    await part(page, "example").selectOption("nonwoven_tensile_quick");
    await page.waitForSelector("[data-testid=estimate][data-ready=true]");
    await picture(page, "submit");
    await isAccessible(page, "the new job");
    const id = await submit(page);
    await state(page, "succeeded").waitFor();
    await page.waitForFunction(() => Number(document.querySelector("[data-testid=curve]")?.dataset.points) > 10);

    const answer = await page.request.get(`/v1/jobs/${id}`);
    const { summary } = await answer.json();
    const row = part(page, "results").locator("tr[data-result=max_force]");
    await row.waitFor();
    const cells = await row.locator("td").allInnerTexts();
    assert.equal(cells[1].trim(), summary.max_force.unit);
    const shown = cells[0].replace(/\s/g, "").replaceAll("−", "-").split("±").map(Number);
    const { value, error } = summary.max_force;
    // three digits are shown at least, and two of an error
    assert.ok(Math.abs(shown[0] / value - 1) < 5e-3, `${cells} is not ${value}`);
    assert.ok(Math.abs(shown[1] / error.value - 1) < 5e-2, `${cells} is not within ${error.value}`);
    const rows = await part(page, "results").locator("tbody tr").count();
    assert.equal(rows, Object.keys(summary).length);

    const [file] = await Promise.all([
      page.waitForEvent("download"),
      part(page, "files").getByRole("link", { name: "curve.csv", exact: true }).click(),
    ]);
    const text = readFileSync(await file.path(), "utf8");
    assert.equal(file.suggestedFilename(), "curve.csv");
    assert.match(text, /^nominal_strain,force_n,/);
    assert.equal(text, await (await page.request.get(`/v1/jobs/${id}/files/curve.csv`)).text());
    await picture(page, "job");
    await isAccessible(page, "a finished job");
  }));

test("a running job shows its progress and its growing curve, and can be cancelled", () =>
  visit("/submit", async (page) => {
    await writeText(page, JSON.stringify(endless(), null, 2));
    const id = await submit(page);
    await state(page, "running").waitFor();
    const points = () => page.evaluate(() => Number(document.querySelector("[data-testid=curve]")?.dataset.points));
    await page.waitForFunction(() => Number(document.querySelector("[data-testid=curve]")?.dataset.points) > 0);
    const first = await points();
    await page.waitForFunction(
      (first) => Number(document.querySelector("[data-testid=curve]").dataset.points) > first,
      first,
    );
    assert.match(await part(page, "progress").innerText(), /\d+(\.\d+)? ?%/);
    await picture(page, "running");
    await isAccessible(page, "a running job");
    await part(page, "cancel").click();
    await part(page, "cancel").click();
    await state(page, "cancelled").waitFor();
    const { outcome } = await (await page.request.get(`/v1/jobs/${id}`)).json();
    assert.equal(outcome, "cancelled");
    await part(page, "retry").waitFor();
  }));

test("a load that comes back is drawn as a loop, over any column that one chooses", () =>
  visit("/submit", async (page) => {
    const example = await (await page.request.get("/v1/kinds/ballast_oedometer/examples")).json();
    const answer = await page.request.post("/v1/jobs", { data: example.items[0].job });
    const { id } = await answer.json();
    await page.goto(`/jobs/${id}`);
    await state(page, "succeeded").waitFor();
    const branches = () => part(page, "curve").getAttribute("data-branches").then(Number);
    await page.waitForFunction(() => Number(document.querySelector("[data-testid=curve]")?.dataset.branches) >= 2);
    assert.equal(await part(page, "curve-over").inputValue(), "displacement_mm");
    assert.match(await part(page, "curve").innerText(), /Dashed: unloading/);

    // the readout follows the test, not the axis: point by point, there and back
    const slider = part(page, "curve").getByRole("slider");
    const { columns, points } = await (await page.request.get(`/v1/jobs/${id}/curve?max_points=2000`)).json();
    const unloading = points.findIndex((point) => point[columns.indexOf("unloading")] === 1);
    for (const row of [0, unloading, points.length - 1]) {
      await slider.fill(String(row));
      assert.equal(await slider.inputValue(), String(row));
      assert.match(
        await slider.getAttribute("aria-valuetext"),
        new RegExp(`Unloading ${points[row][columns.indexOf("unloading")]}`),
      );
    }
    // of one cycle there is no settlement by cycle
    await page.locator("[data-testid=file-plot][data-file='oedometer.csv']").waitFor();
    assert.equal(await page.locator("[data-testid=file-plot][data-file='cycles.csv']").count(), 0);
    await picture(page, "ballast");
    await isAccessible(page, "a ballast test");

    await part(page, "curve-over").selectOption("time_s");
    await page.waitForURL(/over=time_s/);
    assert.equal(await branches(), 0);
    await page.reload();
    await page.waitForFunction(() => Number(document.querySelector("[data-testid=curve]")?.dataset.points) > 0);
    assert.equal(await part(page, "curve-over").inputValue(), "time_s");
    // the usual choice is not worth an address of its own
    await part(page, "curve-over").selectOption("displacement_mm");
    await page.waitForURL((url) => url.search === "");
    assert.ok((await branches()) >= 2);
    await page.setViewportSize(PHONE);
    await fitsThePhone(page, "a ballast test");
    await picture(page, "phone-ballast");
  }));

test("a bad spec shows each violation at its line, and mending it clears them", () =>
  visit(
    "/submit",
    async (page) => {
      const bad = job();
      bad.spec.bond.modulus_n = -1;
      bad.spec.fabric.lattice.rows = 16.5;
      bad.spec.test = { strain_setp: 0.01 };
      const text = JSON.stringify(bad, null, 2);
      await writeText(page, text);
      await part(page, "check").click();
      const violation = (pointer) => page.locator(`[data-testid=violation][data-pointer="${pointer}"]`);
      const lines = text.split("\n");
      for (const [pointer, word] of [
        ["/spec/bond/modulus_n", "modulus_n"],
        ["/spec/fabric/lattice/rows", "rows"],
        ["/spec/test/strain_setp", "strain_setp"],
      ]) {
        await violation(pointer).waitFor();
        const line = lines.findIndex((line) => line.includes(`"${word}"`)) + 1;
        assert.match(await violation(pointer).innerText(), new RegExp(`line ${line}\\b`));
      }
      await picture(page, "violations");
      await isAccessible(page, "violations");
      // a violation leads to its place
      await violation("/spec/bond/modulus_n").click();
      assert.match(await part(page, "editor").locator(".cm-activeLine").innerText(), /modulus_n/);
      // it cannot be submitted
      await part(page, "editor").focus();
      await page.keyboard.press("Control+Home");
      const refused = page.waitForResponse((response) => response.url().endsWith("/v1/jobs"));
      await part(page, "submit").click();
      assert.equal((await refused).status(), 422);
      // the caret goes to what is first to mend; what is written before that would be written there
      await page.waitForFunction(() =>
        document.querySelector("[data-testid=editor] .cm-activeLine")?.textContent.includes(`"rows"`),
      );
      await violation("/spec/bond/modulus_n").waitFor();
      assert.match(page.url(), /\/submit/);
      await writeText(page, JSON.stringify(job(), null, 2));
      await part(page, "violations").waitFor({ state: "detached" });
      // mended while a submission is under way: its refusal is of the text that is gone
      await writeText(page, text);
      await violation("/spec/bond/modulus_n").waitFor();
      let mended;
      const held = new Promise((resolve) => (mended = resolve));
      await page.route(/\/v1\/jobs$/, (route) => held.then(() => route.continue()));
      const late = page.waitForResponse((response) => response.url().endsWith("/v1/jobs"));
      await part(page, "submit").click();
      await writeText(page, JSON.stringify(job(), null, 2));
      await part(page, "violations").waitFor({ state: "detached" });
      mended();
      assert.equal((await late).status(), 422);
      await page.waitForFunction(() => !document.querySelector("[data-testid=submit]").disabled);
      assert.equal(await part(page, "violations").count(), 0);
      assert.equal(JSON.parse(await written(page)).spec.test, undefined);
      // the browser itself reports the refusals in its console
    },
    { expected: /status of 422/ },
  ));

test("the keyboard alone submits, follows, cancels and finds a job", () =>
  visit("/", async (page) => {
    /** Tabs to the element, as somebody without a mouse. */
    const tabTo = async (testid) => {
      for (let presses = 0; presses < 80; presses++) {
        const isThere = await page.evaluate(
          (testid) => document.activeElement?.getAttribute("data-testid") === testid,
          testid,
        );
        if (isThere) return;
        await page.keyboard.press("Tab");
      }
      assert.fail(`Tab never reaches ${testid}`);
    };
    await tabTo("new-job");
    await page.keyboard.press("Enter");
    await page.waitForSelector("[data-testid=estimate][data-ready=true]");
    await tabTo("view-form");
    await page.keyboard.press("ArrowRight");
    await tabTo("editor");
    await page.keyboard.press("Control+A");
    await page.keyboard.insertText(JSON.stringify(endless()));
    await page.keyboard.press("Control+Enter");
    await page.waitForURL(/\/jobs\/[0-9a-f-]{36}$/);
    const id = page.url().split("/").at(-1);
    await state(page, "running").waitFor();
    await tabTo("cancel");
    const outline = await page.evaluate(() => getComputedStyle(document.activeElement).outlineStyle);
    assert.notEqual(outline, "none", "the focus is not to be seen");
    await page.keyboard.press("Enter");
    await page.keyboard.press("Enter");
    await state(page, "cancelled").waitFor();
    await page.goto("/");
    await tabTo("filter-text");
    await page.keyboard.insertText("From the browser");
    await page.locator(`[data-testid=job-row][data-job="${id}"]`).waitFor();
    await page.waitForURL(/q=/);
  }));

test("the list lives: a job submitted elsewhere appears and finishes without a reload", () =>
  visit("/", async (page) => {
    const body = { ...job(), name: "From elsewhere" };
    const answer = await page.request.post("/v1/jobs", { data: body });
    assert.equal(answer.status(), 201);
    const { id } = await answer.json();
    const row = page.locator(`[data-testid=job-row][data-job="${id}"]`);
    await row.waitFor();
    await row.locator("[data-state=succeeded]").waitFor();
    await picture(page, "jobs");
    await isAccessible(page, "the list of jobs");
    // and goes when it is deleted
    await page.request.delete(`/v1/jobs/${id}`);
    await row.waitFor({ state: "detached" });
  }));

test("notes, tags and priority are edited in their place, by keyboard", () =>
  visit(
    "/",
    async (page) => {
      // more work that does not end than a lab has workers, so that the last job waits
      const ids = [];
      for (let count = 0; count <= 2 * availableParallelism(); count++) {
        const answer = await page.request.post("/v1/jobs", { data: { ...endless(), name: "To be described" } });
        ids.push((await answer.json()).id);
      }
      const id = ids.at(-1);
      const stored = async () => (await page.request.get(`/v1/jobs/${id}`)).json();
      await page.goto(`/jobs/${id}`);
      await state(page, "queued").waitFor();
      /** Opens a field by keyboard and writes into it. */
      const write = async (button, field, text) => {
        await part(page, button).focus();
        await page.keyboard.press("Enter");
        await page.waitForFunction((field) => document.activeElement?.dataset.testid === field, field);
        await page.keyboard.press("Control+A");
        await page.keyboard.insertText(text);
      };
      /** The field is gone and the focus back where it was. */
      const isLeft = async (button, field) => {
        await part(page, field).waitFor({ state: "detached" });
        await page.waitForFunction((button) => document.activeElement?.dataset.testid === button, button);
      };

      const notes = "Cut along the machine direction.\n  Second line <b>as written</b>";
      await write("edit-notes", "notes-input", notes.split("\n")[0]);
      await page.keyboard.press("Enter");
      await page.keyboard.insertText(notes.split("\n")[1]);
      await page.keyboard.press("Control+Enter");
      await isLeft("edit-notes", "notes-input");
      assert.equal(await part(page, "job-notes").innerText(), notes);
      assert.equal((await stored()).notes, notes);

      await write("edit-tags", "tags-input", " PET, batch 7 ,, PET");
      await page.keyboard.press("Enter");
      await isLeft("edit-tags", "tags-input");
      assert.deepEqual(await part(page, "job-tags").getByRole("link").allInnerTexts(), ["PET", "batch 7"]);
      assert.deepEqual((await stored()).tags, ["PET", "batch 7"]);

      // what the server refuses stands at the field, which keeps what was written
      await write("edit-priority", "priority-input", "5000");
      await page.keyboard.press("Enter");
      const complaint = part(page, "priority-input-error");
      assert.match(await complaint.innerText(), /out of range.*-1000 … 1000/);
      assert.equal(await part(page, "priority-input").getAttribute("aria-invalid"), "true");
      assert.equal(await part(page, "priority-input").inputValue(), "5000");
      await part(page, "edit-notes").click();
      await part(page, "edit-tags").click();
      await picture(page, "edit");
      await isAccessible(page, "a job being edited");
      await part(page, "priority-input").focus();
      await page.keyboard.press("Control+A");
      await page.keyboard.type("-7");
      await page.keyboard.press("Enter");
      await isLeft("edit-priority", "priority-input");
      assert.equal((await stored()).priority, -7);

      // Escape leaves everything as it was
      await part(page, "tags-input").fill("gone");
      await page.keyboard.press("Escape");
      await isLeft("edit-tags", "tags-input");
      await part(page, "notes-input").fill("gone");
      await page.keyboard.press("Escape");
      await isLeft("edit-notes", "notes-input");
      await write("rename", "name-input", "");
      await page.keyboard.press("Enter");
      await part(page, "name-input-error").waitFor();
      await page.keyboard.press("Escape");
      await isLeft("rename", "name-input");
      const { name, notes: kept, tags } = await stored();
      assert.deepEqual([name, kept, tags], ["To be described", notes, ["PET", "batch 7"]]);

      // what no longer waits has no priority to change
      for (const id of ids) await page.request.post(`/v1/jobs/${id}/cancel`);
      await state(page, "cancelled").waitFor();
      await part(page, "edit-priority").waitFor({ state: "detached" });
      await part(page, "edit-notes").waitFor();
      await page.setViewportSize(PHONE);
      await part(page, "edit-tags").click();
      await part(page, "edit-notes").click();
      await fitsThePhone(page, "a job being edited");
      await picture(page, "phone-edit");
      // the browser itself reports the refusals in its console
    },
    { expected: /status of 422/ },
  ));

test("every view fits a phone", async () => {
  const created = await fetch(`${lab.url}/v1/jobs`, {
    method: "POST",
    headers: { "content-type": "application/json" },
    body: JSON.stringify({
      ...job(),
      name: "Ein_Name_ohne_jeden_Zwischenraum_der_länger_ist_als_ein_Bildschirm_breit",
    }),
  });
  const { id } = await created.json();
  for (const [address, ready, name] of [
    ["/", "job-table", "jobs"],
    ["/submit", "estimate", "submit"],
    [`/jobs/${id}`, "results", "job"],
  ]) {
    await visit(
      address,
      async (page) => {
        await part(page, ready).waitFor();
        await fitsThePhone(page, address);
        await picture(page, `phone-${name}`);
        await isAccessible(page, `${address} on a phone`);
      },
      { viewport: PHONE },
    );
  }
});

test("what is not there is said plainly", () =>
  visit(
    "/jobs/00000000-0000-4000-8000-000000000000",
    async (page) => {
      await page.getByRole("alert").waitFor();
      await isAccessible(page, "a job that is not there");
      // the browser itself reports the answer in its console
    },
    { expected: /status of 404/ },
  ));
