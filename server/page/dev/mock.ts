// A stand-in for the server while the page is worked on: sample jobs, one of them running.
import type { IncomingMessage, ServerResponse } from "node:http";
import type { Plugin } from "vite";
import type { Job } from "../src/api/types";
import { curves, differences } from "./compareSamples";
import {
  BALLAST_COLUMNS,
  ballastPoint,
  COLUMNS,
  curvePoint,
  KIND,
  makeJob,
  makeOutcome,
  SPEC,
  startJobs,
  STEPS,
} from "./samples";

const SCHEMA = {
  type: "object",
  description: "A virtual tensile test of a nonwoven fabric.",
  required: ["version", "fabric"],
  properties: {
    seed: { type: "integer", description: "Seed of every random stream of the test.", minimum: 0, default: 1 },
    bond: {
      type: "object",
      description: "Bond law and strength.",
      properties: {
        modulus_n: {
          type: ["number", "null"],
          minimum: 1e-12,
          maximum: 1e12,
          "x-unit": "N",
          description: "e, force per unit bond strain in tension.",
        },
      },
    },
  },
};
const FILES = [
  "outcome.json",
  "curve.csv",
  "events.csv",
  "log.jsonl",
  "snapshots.pvd",
  ...Array.from({ length: 12 }, (_, i) => `snapshots/step_${String(i * 10).padStart(5, "0")}.vtp`),
].map((name, index) => ({ name, bytes: 900 * (index + 1) ** 3, sha256: "00" }));

export function mock(): Plugin {
  const jobs = startJobs();
  const listeners = new Set<ServerResponse>();
  let steps = 3;

  const send = (name: string, data: unknown): void => {
    for (const listener of listeners) listener.write(`event: ${name}\ndata: ${JSON.stringify(data)}\n\n`);
  };
  const change = (job: Job, changes: Partial<Job>): Job => {
    Object.assign(job, changes, { updated_at: new Date().toISOString() });
    send("job", job);
    return job;
  };
  const tick = (): void => {
    const job = jobs.find((candidate) => candidate.status === "running");
    if (!job) return;
    steps += 1;
    if (steps >= STEPS) {
      const done = makeJob(3, {});
      change(job, {
        status: "finished",
        outcome: "succeeded",
        progress: 1,
        reason: done.reason,
        finished_at: new Date().toISOString(),
        summary: done.summary ?? {},
      });
      return;
    }
    Object.assign(job, {
      progress: steps / STEPS,
      phase: `strain step ${steps} of ${STEPS}`,
      eta_s: (STEPS - steps) * 0.4,
    });
    send("progress", { job_id: job.id, progress: job.progress, phase: job.phase, eta_s: job.eta_s });
    send("points", { job_id: job.id, attempt: 1, total: steps });
  };

  const answer = (method: string, url: URL, body: string): unknown => {
    const [, , first, id, what] = url.pathname.split("/");
    if (first === "kinds") {
      if (what === "schema") return SCHEMA;
      if (what === "examples")
        return {
          items: [
            {
              name: KIND,
              title: "Needle-punched PET",
              description: "49 × 51 points in three layers, pulled until it parts.",
              job: { kind: KIND, name: "example", spec: SPEC },
            },
          ],
        };
      return { items: [{ kind: KIND, title: "Nonwoven tensile test", description: "" }] };
    }
    if (first === "workers")
      return {
        items: [
          {
            id: "w",
            name: "bench-2",
            host: "tensile-lab",
            threads: 2,
            engine_version: "0.1.0",
            alive: true,
            job_id: jobs[2]?.id,
            last_seen_at: new Date().toISOString(),
          },
        ],
      };
    if (first === "differences") return differences(url.searchParams);
    if (first === "curves") return curves(url.searchParams);
    if (first === "me") return { kind: "sole", accounts: false, scope: "everything" };
    if (first !== "jobs") return undefined;
    if (!id && method === "POST") return create(url, body);
    if (!id) return list(url);
    const job = jobs.find((candidate) => candidate.id === id);
    if (!job) return undefined;
    if (method === "PATCH") return change(job, JSON.parse(body) as Partial<Job>);
    if (method === "DELETE") return (jobs.splice(jobs.indexOf(job), 1), send("deleted", { job_id: id }), {});
    if (what === "curve") {
      const since = Number(url.searchParams.get("since") ?? 0);
      const count = job.progress === 1 ? STEPS : Math.round(job.progress * STEPS);
      const [columns, point] = job.kind === "ballast_box" ? [BALLAST_COLUMNS, ballastPoint] : [COLUMNS, curvePoint];
      return {
        columns,
        attempt: 1,
        points: Array.from({ length: Math.max(0, count - since) }, (_, i) => point(since + i)),
        next: count,
        complete: job.status === "finished",
      };
    }
    if (what === "files") return { items: job.outcome === "succeeded" ? FILES : [] };
    if (what === "log")
      return {
        items: [
          { at: job.created_at, attempt: 1, message: "7572 nodes, 26683 bonds, 2 threads" },
          { at: job.created_at, attempt: 1, message: "step 1: 6 iterations" },
        ],
      };
    if (what === "outcome") return makeOutcome(job);
    if (what === "pause")
      return change(job, { status: "paused", reason: "Paused by you.", reason_code: "paused_by_user" });
    if (what === "resume") return change(job, { status: "running", reason: "", reason_code: "resumed_by_user" });
    if (what === "cancel")
      return change(job, {
        status: "finished",
        outcome: "cancelled",
        reason: "Cancelled by you.",
        finished_at: new Date().toISOString(),
      });
    return job;
  };
  const list = (url: URL): unknown => {
    const status = url.searchParams.get("status");
    const text = url.searchParams.get("q") ?? "";
    const fitting = jobs.filter((job) => (!status || job.status === status) && job.name.includes(text));
    const start = Number(url.searchParams.get("cursor") ?? 0);
    const end = start + Number(url.searchParams.get("limit") ?? 50);
    return { items: fitting.slice(start, end), next: end < fitting.length ? String(end) : null };
  };
  const create = (url: URL, body: string): unknown => {
    const envelope = JSON.parse(body) as { name?: string; spec?: { bond?: { modulus_n?: number }; seed?: number } };
    const violations = [];
    if (!((envelope.spec?.bond?.modulus_n ?? 1) > 0))
      violations.push({
        pointer: "/spec/bond/modulus_n",
        code: "out_of_range",
        detail: "must be positive",
        value: envelope.spec?.bond?.modulus_n,
        allowed: "1e-12 … 1e12",
        unit: "N",
      });
    if (typeof envelope.spec?.seed !== "number")
      violations.push({
        pointer: "/spec/seed",
        code: "wrong_type",
        detail: "must be a whole number",
        allowed: "0 … 9007199254740991",
      });
    if (violations.length > 0)
      return {
        type: "/problems/invalid-spec",
        title: "The job is not valid",
        status: 422,
        detail: "Two fields.",
        violations,
      };
    if (url.searchParams.has("dry_run"))
      return {
        spec: envelope.spec,
        spec_sha256: makeJob(1, {}).spec_sha256,
        estimate: { wall_s: 3.4, memory_mb: 84, disk_mb: 12.4, calibrated: true },
        warnings: [],
      };
    const job = makeJob(900 + jobs.length, {
      name: envelope.name ?? "",
      status: "queued",
      outcome: null,
      progress: 0,
      position: 3,
      attempts: [],
      attempt: 0,
    });
    jobs.unshift(job);
    send("job", job);
    return job;
  };

  return {
    name: "mock-server",
    configureServer(server) {
      const timer = setInterval(tick, 400);
      server.httpServer?.on("close", () => clearInterval(timer));
      server.middlewares.use((request, response, next) => {
        const url = new URL(request.url ?? "/", "http://mock");
        if (url.pathname === "/version") return void response.end('{"version":"0.1.0","commit":"unknown"}');
        if (url.pathname.startsWith("/guide")) return void response.end(`The server's guide: ${request.url ?? ""}`);
        if (!url.pathname.startsWith("/v1/")) return next();
        if (url.pathname.endsWith("/events")) return stream(request, response, listeners);
        let body = "";
        request.on("data", (part: Buffer) => (body += part.toString()));
        request.on("end", () => {
          const found = answer(request.method ?? "GET", url, body) as { status?: unknown } | undefined;
          response.statusCode = found === undefined ? 404 : typeof found.status === "number" ? found.status : 200;
          response.setHeader("Content-Type", "application/json");
          response.end(JSON.stringify(found ?? { title: "Not found", status: 404, detail: "There is no such job." }));
        });
      });
    },
  };
}

function stream(request: IncomingMessage, response: ServerResponse, listeners: Set<ServerResponse>): void {
  response.writeHead(200, { "Content-Type": "text/event-stream", "Cache-Control": "no-store" });
  response.write(": connected\n\n");
  listeners.add(response);
  request.on("close", () => listeners.delete(response));
}
