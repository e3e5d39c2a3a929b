// What a test found is on its page: every file that can be drawn, as a plot and as a table.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { close, fitsThePhone, isAccessible, open, part, PHONE, picture, state, visit } from "./browser.mjs";

before(open);
after(close);

/** Grains that break under a plate, in two cycles: a job that writes every table of a ballast test. */
const BREAKING = {
  kind: "ballast_oedometer",
  name: "Breaking grains",
  spec: {
    version: 1,
    grains: {
      shape: {
        breakable: {
          filled: {
            shape: { ellipsoid: { semi_axes_m: [0.024, 0.024, 0.024] } },
            member_radius_m: 0.0085,
            lattice: "simple_cubic",
          },
        },
      },
    },
    materials: {
      aggregate: {
        density_kg_per_m3: 2600,
        youngs_modulus_pa: 1e8,
        stiffness_ratio: 0.3,
        friction_angle_rad: 0.5,
        normal_cohesion_pa: 1e6,
        shear_cohesion_pa: 1e6,
      },
    },
    apparatus: { diameter_m: 0.15, height_m: 0.1, facets: 12 },
    preparation: { compaction: null },
    test: { smallest_force_n: 100, peak_force_n: 3e3, cycles: 2 },
    accuracy: { critical_step_fraction: 0.4, inertial_number: 3e-3 },
    output: { rows_per_cycle: 100, snapshots: 0 },
  },
};
const PLOTS = [
  "cycles.csv",
  "oedometer.csv",
  "oedometric_modulus.csv",
  "porosity_profile.csv",
  "fragment_moments.csv",
  "fragments.csv",
];

const card = (page, file) => page.locator(`[data-testid=file-plot][data-file="${file}"]`);
/** A number as the page writes it. */
const read = (text) => Number(text.replaceAll(/[^\d.−]/g, "").replace("−", "-"));
/** The value in a button of the legend. */
const valueOf = async (button) => (await button.innerText()).split("\n").at(-1);
/** Four digits are shown. */
const isClose = (shown, value, what) =>
  assert.ok(Math.abs(read(shown) - value) <= 5e-4 * Math.abs(value), `${what}: ${shown} is not ${value}`);

/** A file of a job, as its names and rows. */
async function table(page, id, file) {
  const text = await (await page.request.get(`/v1/jobs/${id}/files/${file}`)).text();
  const [names, ...rows] = text
    .trim()
    .split("\n")
    .map((line) => line.split(","));
  return { names, rows, number: (row, name) => Number(rows.at(row)[names.indexOf(name)]) };
}

/** The cells that a card shows, opening its table where it is folded. */
async function cells(page, file) {
  const folded = card(page, file).locator("details:not([open]) summary");
  if (await folded.count()) await folded.press("Enter");
  await card(page, file).getByTestId("file-rows").waitFor();
  const rows = await card(page, file).locator("tbody tr").all();
  return Promise.all(rows.map((row) => row.locator("td").allInnerTexts()));
}

/** Whether a card's canvas has a line in a colour that is none of the grid's greys. */
const isDrawn = (page, file) =>
  card(page, file)
    .locator("canvas")
    .evaluate((canvas) => {
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      let coloured = 0;
      for (let at = 0; at < data.length; at += 4) {
        const [red, green, blue, alpha] = data.slice(at, at + 4);
        if (alpha > 200 && Math.max(red, green, blue) - Math.min(red, green, blue) > 60) coloured++;
      }
      return coloured > 100;
    });

test("a ballast test shows what it found, from its files", () =>
  visit("/", async (page) => {
    const { id } = await (await page.request.post("/v1/jobs", { data: BREAKING })).json();
    await page.goto(`/jobs/${id}`);
    await state(page, "succeeded").waitFor();
    for (const file of PLOTS) {
      await card(page, file).getByTestId("table-plot").waitFor();
      await page.waitForFunction((file) => document.querySelector(`[data-file="${file}"] canvas`), file);
      assert.ok(await isDrawn(page, file), `${file} has no line`);
    }
    await picture(page, "tables");
    await isAccessible(page, "the tables of a test");

    const cycles = await table(page, id, "cycles.csv");
    const shown = await cells(page, "cycles.csv");
    assert.equal(shown.length, 2);
    for (const [row, line] of shown.entries()) {
      line.forEach((text, column) => isClose(text, Number(cycles.rows[row][column]), cycles.names[column]));
    }
    // a line that nobody asked for yet
    const stiffness = card(page, "cycles.csv").getByRole("button", { name: "Stiffness, unloading" });
    assert.equal(await stiffness.getAttribute("aria-pressed"), "false");
    await stiffness.press("Enter");
    isClose(await valueOf(stiffness), cycles.number(1, "unloading_stiffness_n_per_m"), "stiffness");

    // the path in the oedometer knows from the curve where it is unloaded, and the keyboard follows it
    const path = await table(page, id, "oedometer.csv");
    const plot = card(page, "oedometer.csv").getByTestId("table-plot");
    assert.equal(await plot.getAttribute("data-branches"), "4");
    const slider = plot.getByRole("slider");
    const row = Math.floor(path.rows.length / 3);
    await slider.fill(String(row));
    const [, ratio] = /Void ratio ([\d.]+)/.exec(await slider.getAttribute("aria-valuetext"));
    isClose(ratio, path.number(row, "void_ratio"), "void ratio");

    const profile = await table(page, id, "porosity_profile.csv");
    const upward = card(page, "porosity_profile.csv").getByTestId("table-plot");
    assert.equal(Number(await upward.getAttribute("data-points")), 2 * profile.rows.length);
    await upward.getByRole("slider").fill("0");
    // the cursor's line lies: height goes upward
    assert.ok(await upward.locator(".u-cursor-y").isVisible());
    isClose(
      await valueOf(card(page, "porosity_profile.csv").getByRole("button", { name: "At the peak" })),
      profile.number(0, "porosity_at_peak"),
      "porosity",
    );

    const curves = await cells(page, "fragment_moments.csv");
    const moments = await table(page, id, "fragment_moments.csv");
    assert.deepEqual(curves.at(-1).slice(1).map(read), [100, 100, 100, 100]);
    assert.equal(
      read(curves.at(-1)[0]),
      Math.max(...moments.rows.map((_, row) => moments.number(row, "largest_fragment_members"))),
    );
    const singles = moments.number(-1, "mass_share_1");
    assert.ok(singles > 0, "nothing has broken");
    isClose(curves[0].at(-1), 100 * singles, "single spheres at the end");

    const preparation = await table(page, id, "preparation.csv");
    const stages = await cells(page, "preparation.csv");
    assert.deepEqual(
      stages.map(([, phase]) => phase.toLowerCase()),
      preparation.rows.map(([, phase]) => phase),
    );

    await page.setViewportSize(PHONE);
    await fitsThePhone(page, "the tables of a test");
    await picture(page, "phone-tables");
    await isAccessible(page, "the tables of a test on a phone");
  }));

test("the breaking of a fabric stands beside its curve", () =>
  visit("/", async (page) => {
    const examples = await (await page.request.get("/v1/kinds/nonwoven_tensile/examples")).json();
    const { job } = examples.items.find(({ name }) => name === "nonwoven_tensile_quick");
    const { id } = await (await page.request.post("/v1/jobs", { data: job })).json();
    await page.goto(`/jobs/${id}`);
    await state(page, "succeeded").waitFor();
    for (const file of ["poisson_ratio.csv", "breaking_by_force.csv", "breaking_by_strain.csv"]) {
      await card(page, file).getByTestId("table-plot").waitFor();
      assert.equal((await cells(page, file)).length, (await table(page, id, file)).rows.length);
    }
    assert.equal(await part(page, "curve").count(), 1);
  }));
