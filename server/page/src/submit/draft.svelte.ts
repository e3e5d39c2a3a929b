// The job being written: its text, what is wrong with it, what it will take.
import { Text } from "@codemirror/state";
import { messageOf, Refusal, request } from "../api/client";
import type { DryRun, Job, Violation } from "../api/types";
import { findNode, lineAt, lineStarts } from "./json/pointer";
import { scan } from "./json/scan";

/** Something wrong, and where. */
export interface Finding {
  offset: number;
  /** Where what is wrong ends (exclusive). */
  end: number;
  line: number;
  pointer: string;
  message: string;
  allowed: string;
}

/** How long typing must rest before the text is read and checked [ms]. */
const REST = 350;
/** Longer texts are checked when asked, not while typing. */
const LONGEST_WATCHED = 200_000;
/** How long typing must rest before a longer one is read [ms]. */
const LONG_REST = 1500;
const KEPT = "loadframe-draft";

export class Draft {
  /** What there was when the page was left. */
  readonly kept = sessionStorage.getItem(KEPT) ?? "";
  /** The project it goes to; none named, the first of one's own. */
  project = $state("");
  /** The text as it was when typing last rested; everything below belongs to it. */
  settled = $state.raw(this.kept);
  /** Whether nothing is written yet. */
  isEmpty = $state(this.kept.trim() === "");
  isBusy = $state(false);
  estimate = $state.raw<DryRun | null>(null);
  #document: Text = Text.of(this.kept.split("\n"));
  #violations = $state.raw<Violation[]>([]);
  #refusal = $state("");
  #checking: AbortController | null = null;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #isSent = false;
  #sendKey: { text: string; key: string } | null = null;

  readonly scan = $derived(scan(this.settled));
  readonly starts = $derived(lineStarts(this.settled));
  /** Whether the text is read and checked while it is typed. */
  readonly isWatched = $derived(this.settled.length <= LONGEST_WATCHED);

  readonly findings = $derived.by<Finding[]>(() => {
    const { root, fault } = this.scan;
    if (fault)
      return [this.#finding(fault.offset, fault.offset, { pointer: "", code: "syntax", detail: fault.message })];
    return this.#violations
      .map((violation) => {
        const node = root && findNode(root, violation.pointer);
        return this.#finding(node?.from ?? 0, node?.end ?? 0, violation);
      })
      .sort((a, b) => a.offset - b.offset);
  });

  /** What is wrong as a whole, when no field is to blame. */
  readonly refusal = $derived(this.findings.length > 0 ? "" : this.#refusal);

  constructor() {
    if (this.kept !== "") this.#watch();
  }

  /** The text as it is at this moment. */
  get text(): string {
    return this.#document.toString();
  }

  /** Called with every change of the text. */
  noticeTyping(document: Text): void {
    this.#document = document;
    this.isEmpty = document.length < LONGEST_WATCHED && document.toString().trim() === "";
    this.#watch();
  }

  #watch(): void {
    clearTimeout(this.#timer);
    if (this.#document.length <= LONGEST_WATCHED) this.#timer = setTimeout(() => void this.check(), REST);
    else this.#timer = setTimeout(() => this.settle(), LONG_REST);
  }

  /** Asks the server what is wrong with the text and what it would take; stores nothing. */
  async check(): Promise<void> {
    clearTimeout(this.#timer);
    this.settle();
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
    this.settle();
    if (this.scan.fault || this.isBusy) return null;
    this.#checking?.abort();
    this.isBusy = true;
    const { settled } = this;
    // The same text sent twice, after a lost answer, must not become two jobs.
    const sent = this.project + settled;
    if (this.#sendKey?.text !== sent) this.#sendKey = { text: sent, key: randomKey() };
    try {
      const headers = { "Idempotency-Key": this.#sendKey.key };
      const address = this.project === "" ? "/v1/jobs" : `/v1/jobs?project=${this.project}`;
      const response = await request(address, { method: "POST", body: settled, headers });
      this.#isSent = true;
      sessionStorage.removeItem(KEPT);
      return (await response.json()) as Job;
    } catch (error) {
      // What has been read anew meanwhile has its own answer; this one is of a text that is gone.
      if (this.settled === settled) this.#refuse(error);
      return null;
    } finally {
      this.isBusy = false;
    }
  }

  stop(): void {
    clearTimeout(this.#timer);
    this.#checking?.abort();
    if (!this.#isSent) this.#keep();
  }

  /** Reads the text as it is now. */
  settle(): void {
    const text = this.text;
    if (this.settled === text) return;
    this.settled = text;
    this.estimate = null;
    this.#refusal = "";
    // What is mended while it is watched is told at once by the next answer; until then the rest stays in its place.
    if (!this.isWatched) this.#violations = [];
    this.#keep();
  }

  #keep(): void {
    try {
      sessionStorage.setItem(KEPT, this.text);
    } catch {
      // Too large to keep: it is lost when the tab closes, and an older one must not come back in its place.
      sessionStorage.removeItem(KEPT);
    }
  }

  #refuse(error: unknown): void {
    this.estimate = null;
    this.#violations = error instanceof Refusal ? error.violations : [];
    this.#refusal = messageOf(error);
  }

  #finding(offset: number, end: number, { pointer, detail, allowed = "", unit = "1" }: Violation): Finding {
    return {
      offset,
      end,
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
