// The shapes on the wire, as the crate loadframe-api defines them.

export type JobStatus = "queued" | "running" | "paused" | "finished";
export type JobOutcome = "succeeded" | "failed" | "cancelled" | "timed_out" | "quarantined";

export interface Quantity {
  value: number | null;
  unit: string;
  /** Standard deviation over repeats, whose mean the value is. */
  deviation?: number;
  /** 95 % interval of the mean, or of a fitted value. */
  interval?: [low: number, high: number];
  n?: number;
  description?: string;
}

export interface Attempt {
  number: number;
  worker: string;
  host: string;
  started_at: string;
  ended_at: string | null;
  end_reason: string | null;
}

export interface Job {
  id: string;
  kind: string;
  name: string;
  notes: string;
  tags: string[];
  priority: number;
  status: JobStatus;
  outcome: JobOutcome | null;
  reason: string;
  reason_code: string;
  progress: number;
  phase: string;
  eta_s: number | null;
  position: number | null;
  attempt: number;
  attempts: Attempt[];
  created_at: string;
  started_at: string | null;
  finished_at: string | null;
  updated_at: string;
  spec_sha256: string;
  spec?: unknown;
  summary?: Record<string, Quantity>;
  links: Record<string, string>;
}

export interface Page<T> {
  items: T[];
  next: string | null;
}

export interface Progress {
  job_id: string;
  progress: number;
  phase: string;
  eta_s: number | null;
}

export interface PointsReady {
  job_id: string;
  attempt: number;
  total: number;
}

export interface Curve {
  columns: string[];
  attempt: number;
  points: number[][];
  next: number;
  complete: boolean;
}

export interface QualityCheck {
  value: number;
  unit: string;
  bound: number;
  ok: boolean;
  description?: string;
}

export interface Warning {
  code: string;
  detail: string;
}

export interface FileEntry {
  name: string;
  bytes: number;
  sha256: string;
}

export interface Cost {
  wall_s: number;
  cpu_s: number;
  threads: number;
  peak_memory_mb: number;
  work: Record<string, number>;
}

export interface Outcome {
  kind: string;
  status: string;
  stop_reason: string;
  summary: Record<string, Quantity>;
  quality: Record<string, QualityCheck>;
  cost: Cost;
  provenance: Record<string, string | number>;
  warnings: Warning[];
  files: FileEntry[];
}

export interface LogLine {
  at: string;
  attempt: number;
  message: string;
}

export interface Worker {
  id: string;
  name: string;
  host: string;
  threads: number;
  engine_version: string;
  alive: boolean;
  job_id: string | null;
  last_seen_at: string;
}

export interface Kind {
  kind: string;
  title: string;
  description: string;
}

export interface Example {
  name: string;
  title: string;
  description: string;
  job: unknown;
}

export interface Estimate {
  wall_s: number;
  memory_mb: number;
  disk_mb: number;
  calibrated: boolean;
}

export interface DryRun {
  spec_sha256: string;
  estimate: Estimate;
  warnings?: Warning[];
}

export interface Violation {
  pointer: string;
  code: string;
  detail: string;
  value?: unknown;
  allowed?: string;
  unit?: string;
}

export interface Problem {
  type: string;
  title: string;
  status: number;
  detail: string;
  violations?: Violation[];
}
