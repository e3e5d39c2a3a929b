// Many made-up jobs side by side, for looking at comparisons without a server: five seeds of each of
// some stiffnesses.
import type { ComparedJob, Curves, Differences } from "../src/api/types";

const SEEDS = 5;

/** How many jobs an address asks for: as many as it names, or those of a tag. */
function countOf(query: URLSearchParams): number {
  return query.get("jobs")?.split(",").length ?? (query.get("tag") === "many" ? 200 : 15);
}

function stiffness(place: number): number {
  return 0.3 + 0.1 * Math.floor(place / SEEDS);
}

function height(place: number): number {
  return 300 * stiffness(place) * (1 + 0.08 * Math.sin(7 * place));
}

function job(place: number): ComparedJob {
  return {
    id: `00000000-0000-7000-8000-${String(place).padStart(12, "0")}`,
    kind: "nonwoven_tensile",
    name: `PET needled, stiffness ${stiffness(place).toFixed(1)}, seed ${(place % SEEDS) + 1}`,
    tags: ["series"],
    status: "finished",
    outcome: "succeeded",
    created_at: "2026-11-20T10:00:00Z",
    spec_sha256: String(place),
    columns: ["nominal_strain", "force_n", "force_bottom_jaw_n", "broken_bonds"],
    points: 2_000,
    dimensions: { width_mm: 980 },
  };
}

export function differences(query: URLSearchParams): Differences {
  const places = Array.from({ length: countOf(query) }, (_, place) => place);
  return {
    jobs: places.map(job),
    fields: [
      { pointer: "/spec/seed", values: places.map((place) => (place % SEEDS) + 1) },
      { pointer: "/spec/bond/modulus_n", unit: "N", values: places.map(stiffness) },
    ],
    fields_left_out: 0,
    specs_left_out: [],
    results: [
      { name: "max_force", unit: "N", values: places.map((place) => height(place)) },
      { name: "strain_at_max_force", unit: "1", values: places.map((place) => 1.11 + 0.01 * (place % SEEDS)) },
      {
        name: "modulus_at_10_percent",
        unit: "N/m",
        values: places.map((place) => (place === 3 ? null : height(place))),
      },
    ],
    missing: [],
    more: false,
  };
}

export function curves(query: URLSearchParams): Curves {
  const points = Number(query.get("points") ?? 1000);
  const x = Array.from({ length: points }, (_, step) => (1.6 * step) / points);
  const [over, of] = [query.get("over") ?? "nominal_strain", query.get("of") ?? "force_n"];
  return {
    points,
    curves: Array.from({ length: countOf(query) }, (_, place) => ({
      job: job(place).id,
      over,
      of,
      x,
      y: x.map(
        (strain) => height(place) * strain * Math.exp(1 - strain) * (strain > 1.3 ? Math.exp(-8 * (strain - 1.3)) : 1),
      ),
      of_points: 2_000,
      complete: true,
    })),
    without: [],
    missing: [],
    more: false,
  };
}
