// The job being written: its text, what is wrong with it, what it will take.
import { messageOf, Refusal, request } from "../api/client";
import type { DryRun, Job, Violation } from "../api/types";
import { findNode, lineAt, lineStarts } from "./json/pointer";
import { scan } from "./json/scan";

/** Something wrong, and where. */
export interface Finding {
  offset: number;
  line: number;
  pointer: string;
  message: string;
  allowed: string;
}

/** How long typing must rest before the text is read and checked [ms]. */
const REST = 350;
/** Longer texts are checked when asked, not while typing. */
const LONGEST_WATCHED = 200_000;
/** Longer ones (measured networks) are not edited at all: a text area takes seconds for each letter. */
const LONGEST_EDITED = 1_000_000;
const KEPT = "loadframe-draft";

export function isLarge(text: string): boolean {
  return text.length > LONGEST_EDITED;
}

export class Draft {
  text = $state(sessionStorage.getItem(KEPT) ?? "");
  /** The project it goes to; none named, the first of one's own. */
  project = $state("");
  /** A job too large to edit, sent instead of the text. */
  large = $state.raw<string | null>(null);
  /** The text as it was when typing last rested; everything below belongs to it. */
  settled = $state("");
  isBusy = $state(false);
  estimate = $state.raw<DryRun | null>(null);
  #violations = $state.raw<Violation[]>([]);
  #refusal = $state("");
  #checking: AbortController | null = null;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #sendKey: { text: string; key: string } | null = null;

  readonly scan = $derived(scan(this.settled));
  readonly starts = $derived(lineStarts(this.settled));

  readonly findings = $derived.by<Finding[]>(() => {
    const { root, fault } = this.scan;
    if (fault) return [this.#finding(fault.offset, { pointer: "", code: "syntax", detail: fault.message })];
    return this.#violations
      .map((violation) => this.#finding(root ? findNode(root, violation.pointer).from : 0, violation))
      .sort((a, b) => a.offset - b.offset);
  });

  /** What is wrong as a whole, when no field is to blame. */
  readonly refusal = $derived(this.findings.length > 0 ? "" : this.#refusal);

  /** Begins anew with a text from elsewhere. */
  take(text: string): void {
    this.large = isLarge(text) ? text : null;
    if (this.large === null) this.text = text;
    else this.#settleOn("");
  }

  /** Called with every change of the text. */
  noticeTyping(): void {
    clearTimeout(this.#timer);
    if (this.large === null && this.text.length <= LONGEST_WATCHED) {
      this.#timer = setTimeout(() => void this.check(), REST);
    } else {
      this.estimate = null;
    }
    try {
      sessionStorage.setItem(KEPT, this.text);
    } catch {
      // A text too large to keep is only lost when the tab closes.
    }
  }

  /** Asks the server what is wrong with the text and what it would take; stores nothing. */
  async check(): Promise<void> {
    clearTimeout(this.#timer);
    this.#settle();
    if (this.scan.fault) return;
    this.#checking?.abort();
    const checking = new AbortController();
    this.#checking = checking;
    try {
      const options = { method: "POST", body: this.settled, signal: checking.signal };
      const response = await request("/v1/jobs?dry_run=true", options);
      this.estimate = (await response.json()) as DryRun;
      this.#violations = [];
      this.#refusal = "";
    } catch (error) {
      if (!checking.signal.aborted) this.#refuse(error);
    }
  }

  /** Submits the job; returns it, or null when it was refused. */
  async submit(): Promise<Job | null> {
    clearTimeout(this.#timer);
    this.#settle();
    if (this.scan.fault || this.isBusy) return null;
    this.#checking?.abort();
    this.isBusy = true;
    // The same text sent twice, after a lost answer, must not become two jobs.
    const sent = this.project + this.settled;
    if (this.#sendKey?.text !== sent) this.#sendKey = { text: sent, key: randomKey() };
    try {
      const headers = { "Idempotency-Key": this.#sendKey.key };
      const address = this.project === "" ? "/v1/jobs" : `/v1/jobs?project=${this.project}`;
      const response = await request(address, { method: "POST", body: this.settled, headers });
      sessionStorage.removeItem(KEPT);
      return (await response.json()) as Job;
    } catch (error) {
      this.#refuse(error);
      return null;
    } finally {
      this.isBusy = false;
    }
  }

  stop(): void {
    clearTimeout(this.#timer);
    this.#checking?.abort();
  }

  #settle(): void {
    this.#settleOn(this.large ?? this.text);
  }

  #settleOn(text: string): void {
    if (this.settled === text) return;
    this.settled = text;
    this.estimate = null;
    this.#violations = [];
    this.#refusal = "";
  }

  #refuse(error: unknown): void {
    this.estimate = null;
    this.#violations = error instanceof Refusal ? error.violations : [];
    this.#refusal = messageOf(error);
  }

  #finding(offset: number, { pointer, detail, allowed = "", unit = "1" }: Violation): Finding {
    return {
      offset,
      line: lineAt(this.starts, offset),
      pointer,
      message: detail,
      allowed: allowed && unit !== "1" ? `${allowed} ${unit}` : allowed,
    };
  }
}

// crypto.randomUUID exists only on https and localhost; a lab server is often plain http.
function randomKey(): string {
  return [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}
