// The specimen of the job being written: asked for once somebody wants to see it, and again for every other spec.
import { complaintsOf, request } from "../api/client";
import type { Job, Preview } from "../api/types";
import { subjectOf, type Subject } from "../snapshots/subject";

/** The bytes of a text in base64. */
export function bytesOf(base64: string): ArrayBuffer {
  return Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0)).buffer;
}

interface JobBody {
  kind: Job["kind"];
  spec: Record<string, unknown>;
}

/** What the specimen of a body is of: of a job that calibrates another, that of the other. */
export function subjectOfBody(body: string): Subject {
  const job = JSON.parse(body) as JobBody;
  return subjectOf(job.kind === "calibrate" ? (job.spec["job"] as JobBody) : job);
}

export class Specimen {
  isWanted = $state(false);
  isBusy = $state(false);
  preview = $state.raw<Preview | null>(null);
  subject = $state<Subject>("picture");
  errors = $state.raw<string[]>([]);
  /** SHA-256 of the spec that the picture, or what is wrong, belongs to. */
  of = $state("");
  #asking: AbortController | null = null;

  /** Asks for the picture of a body that was found valid, unless it is there. */
  async ask(body: string, sha256: string): Promise<void> {
    if (this.of === sha256) return;
    this.of = sha256;
    this.#asking?.abort();
    const asking = new AbortController();
    this.#asking = asking;
    this.isBusy = true;
    try {
      const subject = subjectOfBody(body);
      const answer = await request("/v1/jobs/preview", { method: "POST", body, signal: asking.signal });
      const preview = (await answer.json()) as Preview;
      if (asking.signal.aborted) return;
      [this.preview, this.subject, this.errors] = [preview, subject, []];
    } catch (error) {
      if (asking.signal.aborted) return;
      [this.preview, this.errors] = [null, complaintsOf(error)];
    }
    this.isBusy = false;
  }

  stop(): void {
    this.#asking?.abort();
  }
}
