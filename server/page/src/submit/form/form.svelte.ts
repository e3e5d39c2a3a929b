// What the fields of the form do with the text: every entry is a change of the text, and the text alone holds the job.
import type { Draft } from "../draft.svelte";
import { applyChange, childOf, removeValue, setValue, type Change } from "../json/edit";
import { formatJson } from "../../format/json";
import { formatPointer } from "../json/pointer";
import type { JsonNode } from "../json/scan";
import { describeField, type FieldDoc, type Schema } from "../json/schema";
import { scaffold, scaffoldOf, type Field, type Option } from "./model";

export interface Actions {
  /** Changes the text, as if it had been typed. */
  apply: (change: Change) => void;
  /** Shows a place of the text. */
  showText: (offset: number) => void;
  /** A field has the focus. */
  onfocus: (path: string[]) => void;
}

export class Form {
  readonly #draft: Draft;
  readonly #actions: Actions;
  readonly #schema: () => Schema;
  /** Parts that were switched off, for when they are wanted back. */
  // eslint-disable-next-line svelte/prefer-svelte-reactivity -- read by nothing that is shown
  readonly #putAside = new Map<string, string>();

  /** Messages at each pointer. */
  readonly messages = $derived.by(() => {
    // eslint-disable-next-line svelte/prefer-svelte-reactivity -- made and read at once
    const byPointer = new Map<string, string[]>();
    for (const { pointer, message, allowed } of this.#draft.findings) {
      const text = allowed === "" ? message : `${message}. Allowed: ${allowed}`;
      byPointer.set(pointer, [...(byPointer.get(pointer) ?? []), text]);
    }
    return byPointer;
  });

  constructor(draft: Draft, schema: () => Schema, actions: Actions) {
    this.#draft = draft;
    this.#schema = schema;
    this.#actions = actions;
  }

  get root(): JsonNode | null {
    return this.#draft.scan.root;
  }

  /** Whether the text can be read; otherwise the form waits. */
  get isReadable(): boolean {
    return this.root !== null && this.#draft.scan.fault === null;
  }

  /** Whether entries reach the text as they are typed, and not only when they are finished. */
  get isQuick(): boolean {
    return this.#draft.isWatched;
  }

  raw(node: JsonNode): string {
    return this.#draft.settled.slice(node.start, node.end);
  }

  messagesAt(path: string[]): string[] {
    return this.messages.get(formatPointer(path)) ?? [];
  }

  /** How many messages there are at a pointer and below. */
  countWithin(path: string[]): number {
    const pointer = formatPointer(path);
    let count = 0;
    for (const [at, texts] of this.messages) if (at === pointer || at.startsWith(`${pointer}/`)) count += texts.length;
    return count;
  }

  /** How many there are in a list from an entry on. */
  countBeyond(path: string[], first: number): number {
    const pointer = `${formatPointer(path)}/`;
    let count = 0;
    for (const [at, texts] of this.messages) {
      if (at.startsWith(pointer) && Number.parseInt(at.slice(pointer.length), 10) >= first) count += texts.length;
    }
    return count;
  }

  /** Writes a JSON text at a path, with what is missing on the way. */
  set(path: string[], raw: string): void {
    const list = path.slice(0, -1);
    const standard = /^\d+$/.test(path.at(-1) ?? "") && !this.#nodeAt(list) ? this.#docAt(list)?.default : undefined;
    // The other entries of a list that was left out are as by default.
    if (standard?.startsWith("[")) this.#write(list, standard.replaceAll(",", ", "));
    this.#write(path, raw);
  }

  remove(path: string[]): void {
    const now = this.#now();
    const change = now && removeValue(now.root, path);
    if (change) this.#change(change);
  }

  /** Takes a part away, to be had back. */
  switchOff(path: string[]): void {
    const node = this.#nodeAt(path);
    if (node) this.#putAside.set(formatPointer(path), this.raw(node));
    this.remove(path);
  }

  /** A part as it was, or with what it must have. */
  switchOn(path: string[], field: Field): void {
    const standard = field.doc.default === "null" ? "" : field.doc.default;
    const begin = standard !== "" ? (JSON.parse(standard) as unknown) : (scaffold(field) ?? null);
    this.set(path, this.#putAside.get(formatPointer(path)) ?? formatJson(begin));
  }

  /** Goes over to another option of a choice; what the last one held comes back with it. */
  choose(path: string[], last: Option | undefined, next: Option): void {
    const pointer = formatPointer(path);
    const node = this.#nodeAt(path);
    if (node && last && last.word === "") this.#putAside.set(`${pointer} ${last.label}`, this.raw(node));
    this.set(path, this.#putAside.get(`${pointer} ${next.label}`) ?? formatJson(scaffoldOf(next)));
  }

  /** What the text would be with another value at a path. */
  textWith(path: string[], raw: string): string {
    const { settled, scan } = this.#draft;
    return scan.root ? applyChange(settled, setValue(settled, scan.root, path, raw)) : settled;
  }

  /** The text but for the value at a path: it tells whether anything else has changed. */
  textWithout(path: string[]): string {
    return this.textWith(path, "null");
  }

  /** Shows a value where it stands in the text. */
  showText(path: string[]): void {
    this.#actions.showText(this.#nodeAt(path)?.start ?? 0);
  }

  noticeFocus(path: string[]): void {
    this.#actions.onfocus(path);
  }

  id(path: string[]): string {
    return idOf(formatPointer(path));
  }

  /** The text as it is now, which typing beside the form may have changed; null when it cannot be read. */
  #now(): { text: string; root: JsonNode } | null {
    this.#draft.settle();
    const root = this.root;
    return this.isReadable && root ? { text: this.#draft.settled, root } : null;
  }

  #write(path: string[], raw: string): void {
    const now = this.#now();
    if (now) this.#change(setValue(now.text, now.root, path, raw, (inner) => this.#docAt(inner)?.fields ?? []));
  }

  #change(change: Change): void {
    // What stands there already is nothing to undo.
    if (this.#draft.settled.slice(change.from, change.to) === change.insert) return;
    this.#actions.apply(change);
    this.#draft.settle();
  }

  #nodeAt(path: string[]): JsonNode | undefined {
    let node = this.root ?? undefined;
    for (const name of path) node = childOf(node, name);
    return node;
  }

  #docAt(path: string[]): FieldDoc | null {
    return describeField(this.#schema(), path);
  }
}

/** The id of the field at a pointer. */
export function idOf(pointer: string): string {
  return `field${pointer}`;
}

/** Moves the focus to the field at a pointer or the closest one around it; false when there is none. */
export function focusField(pointer: string): boolean {
  for (let at = pointer; at !== ""; at = at.slice(0, at.lastIndexOf("/"))) {
    const found = document.getElementById(idOf(at));
    if (!found) continue;
    for (let around = found.closest("details"); around; around = around.parentElement?.closest("details") ?? null) {
      around.open = true;
    }
    found.focus();
    found.scrollIntoView({ block: "center" });
    return true;
  }
  return false;
}
