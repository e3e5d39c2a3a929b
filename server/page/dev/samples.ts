// Jobs, curves and answers for looking at the page without a server. The curve is a smooth made-up
// shape, not a result.
import type { Job, Outcome } from "../src/api/types";

export const KIND = "nonwoven_tensile";
export const COLUMNS = [
  "nominal_strain",
  "force_n",
  "force_bottom_jaw_n",
  "broken_bonds",
  "residual_ratio",
  "rounds",
  "stored_energy_n_mm",
  "width_strain",
];
export const STEPS = 160;

export const SPEC = {
  version: 1,
  seed: 1,
  fabric: {
    lattice: {
      points_per_row: 49,
      rows: 51,
      layers: 3,
      spacing_mm: [20, 20, 10],
      irregularity: [0.5, 0.5, 0.5],
      jaws: "half_bond",
    },
  },
  bond: {
    modulus_n: 0.399,
    friction_modulus_n: 1.473,
    compression_stiffness_n: 0.157,
    mean_strength_n: 3.397,
    strength_sigma: 0.365,
  },
  test: { strain_step: 0.01, max_strain: 3, stop_force_fraction: 0.1, breaking: "all_over_strength" },
  accuracy: { solver: "newton_cg", force_accuracy: 100 },
  output: { snapshot_every_steps: 10 },
};

export const SUMMARY = {
  max_force: { value: 403.271958, unit: "N", description: "Largest force at the moving jaw." },
  strain_at_max_force: { value: 1.11, unit: "1", description: "Nominal strain at the largest force." },
  strength: { value: 411.5, unit: "N/m", description: "Largest force per width." },
  modulus_at_10_percent: { value: 92.4318, unit: "N/m", description: "Secant stiffness per width at 10 % strain." },
  poisson_ratio: { value: 0.562213, unit: "1", description: "Lateral contraction over strain at 10 %." },
  energy_absorption: { value: null, unit: "J/m2", description: "Work per area up to the largest force." },
};

export function curvePoint(step: number): number[] {
  const strain = (step + 1) * 0.01;
  const rise = 90 * strain + 250 * strain * strain * Math.exp(-((strain / 1.3) ** 6));
  const fall = 1 / (1 + Math.exp((strain - 1.2) / 0.035));
  const broken = 9000 / (1 + Math.exp((1.15 - strain) / 0.06));
  const force = rise * fall + Math.sin(step * 1.7) * 2 * strain;
  return [
    strain,
    force,
    force * (1 + 0.004 * Math.sin(step)),
    Math.round(broken),
    0.4 + 0.3 * Math.sin(step),
    step % 4,
    force * 30,
    -0.4 * strain,
  ];
}

export const BALLAST_COLUMNS = ["time_s", "force_kn", "displacement_mm", "cycle", "unloading", "inertial_number"];

/** Four cycles, each settling half as much as the one before. */
export function ballastPoint(step: number): number[] {
  const [cycle, place] = [Math.floor(step / 40), (step % 40) / 40];
  const load = Math.sin(Math.PI * place) ** 2;
  const begin = 16 * (1 - 0.5 ** cycle);
  const residual = 16 * 0.5 ** (cycle + 1) * (place < 0.5 ? load : 1);
  return [
    0.01 * step,
    40 * load,
    begin + residual + 4 * Math.sqrt(load),
    cycle + 1,
    place > 0.5 ? 1 : 0,
    1e-4 * (1 - load),
  ];
}

export function makeJob(number: number, changes: Partial<Job>): Job {
  const id = `01990000-0000-7000-8000-${String(number).padStart(12, "0")}`;
  const self = `/v1/jobs/${id}`;
  const ago = (minutes: number): string => new Date(Date.now() - minutes * 60_000).toISOString();
  const job: Job = {
    id,
    kind: KIND,
    name: `needle-punched PET 49×51×3, seed ${number}`,
    notes: "",
    tags: ["thesis"],
    priority: 0,
    threads: null,
    status: "finished",
    outcome: "succeeded",
    reason: "The force fell below 10 % of its maximum.",
    reason_code: "completed",
    progress: 1,
    phase: "done",
    eta_s: null,
    position: null,
    attempt: 1,
    attempts: [
      {
        number: 1,
        worker: "bench-2",
        host: "tensile-lab",
        started_at: ago(number * 7),
        ended_at: ago(number * 7 - 0.06),
        end_reason: "completed",
        engine: "0.2.0 0000000",
      },
    ],
    created_at: ago(number * 7 + 1),
    started_at: ago(number * 7),
    finished_at: ago(number * 7 - 0.06),
    updated_at: ago(number),
    overrun_factor: 10,
    limits: null,
    spec_sha256: "9c56cc51b374c3ba189210d5b6d4bf57790d351c96c47c02190ecf1e430635ab",
    spec: SPEC,
    summary: SUMMARY,
    links: {
      self,
      page: `/jobs/${id}`,
      events: `${self}/events`,
      curve: `${self}/curve`,
      files: `${self}/files`,
      archive: `${self}/archive.zip`,
      outcome: `${self}/outcome`,
      log: `${self}/log`,
    },
    ...changes,
  };
  if (job.outcome !== "succeeded") delete job.summary;
  return job;
}

export function startJobs(): Job[] {
  const waiting = {
    status: "queued",
    outcome: null,
    reason: "Waiting for a worker.",
    reason_code: "submitted",
    progress: 0,
    phase: "",
    attempt: 0,
    attempts: [],
    started_at: null,
    finished_at: null,
  } as const;
  return [
    makeJob(1, {
      ...waiting,
      attempts: [],
      position: 2,
      name: "layers 5, half the spacing",
      tags: ["layers", "draft"],
    }),
    makeJob(2, { ...waiting, attempts: [], position: 1 }),
    makeJob(3, {
      status: "running",
      outcome: null,
      reason: "",
      reason_code: "submitted",
      progress: 0.02,
      phase: "strain step 3 of 160",
      eta_s: 70,
      finished_at: null,
      name: "needle-punched PET, reference accuracy",
      notes: "Repeat of Tuesday's run with the new compression stiffness.",
    }),
    makeJob(4, {
      status: "paused",
      outcome: null,
      reason: "Paused; a checkpoint is kept.",
      reason_code: "paused_by_user",
      progress: 0.43,
      finished_at: null,
    }),
    makeJob(5, {}),
    makeJob(6, {
      outcome: "failed",
      reason: "No equilibrium at nominal strain 0.62: residual 3.1 times its limit after 1000 iterations.",
      reason_code: "simulation_error",
      progress: 0.2,
      tags: [],
    }),
    makeJob(7, {
      outcome: "cancelled",
      reason: "Cancelled by a person.",
      reason_code: "cancelled_by_user",
      progress: 0.6,
    }),
    makeJob(8, {
      outcome: "quarantined",
      reason: "Its worker died three times while running it.",
      reason_code: "too_many_losses",
      attempt: 3,
    }),
    makeJob(70, { kind: "ballast_box", name: "box test, four cycles", tags: ["ballast"] }),
    ...Array.from({ length: 60 }, (_, index) =>
      makeJob(9 + index, { name: index === 0 ? "" : `width series ${index}` }),
    ),
  ];
}

export function makeOutcome(job: Job): Outcome {
  return {
    kind: KIND,
    status: "succeeded",
    stop_reason: "force_dropped",
    summary: SUMMARY,
    quality: {
      residual_over_limit: {
        value: 0.9731,
        unit: "1",
        bound: 1,
        ok: true,
        description: "Largest resultant over its limit.",
      },
      jaw_force_imbalance: {
        value: 0.0214,
        unit: "1",
        bound: 0.01,
        ok: false,
        description: "Difference of the two jaws' forces over their mean.",
      },
      unconverged_steps: { value: 0, unit: "1", bound: 0, ok: true, description: "" },
    },
    cost: {
      wall_s: 3.42,
      cpu_s: 6.71,
      threads: 2,
      peak_memory_mb: 84.3,
      work: { newton_iterations: 18231, bond_evaluations: 812345678 },
    },
    provenance: {
      spec_sha256: job.spec_sha256,
      engine_version: "0.1.0",
      engine_commit: "0000000",
      seed: 1,
      threads: 2,
      started_at: job.started_at ?? "",
      host: "tensile-lab",
    },
    warnings: [
      {
        code: "jaw_force_imbalance",
        detail: "The two jaws differ by 2.1 %, more than 1 %: choose a tighter accuracy before quoting the force.",
      },
    ],
    files: [],
  };
}
