// JSON read with positions, so that an error at a pointer can be shown at its line. Text that is
// still being typed gives the tree up to its first fault.

export interface JsonNode {
  /** Where the value begins and ends (exclusive) in the text. */
  start: number;
  end: number;
  /** Key or index in the parent; empty for the root. */
  name: string;
  /** Where the member begins: its key, or the value itself in a list. */
  from: number;
  children: JsonNode[];
}

export interface Fault {
  offset: number;
  message: string;
}

export interface Scan {
  root: JsonNode | null;
  fault: Fault | null;
}

/** Deeper nesting is refused by the server as well. */
const DEEPEST = 100;
/** Of all values that hold no others: a measured network has a million. */
const NONE: JsonNode[] = [];
const NUMBER = /-?(?:0|[1-9]\d*)(?:\.\d+)?(?:[eE][+-]?\d+)?/y;
const WORD = /[A-Za-z_]+/y;
// What JSON forbids in a text is what this rule warns of.
// eslint-disable-next-line no-control-regex
const STRING = /"(?:[^"\\\u0000-\u001f]|\\(?:["\\/bfnrt]|u[0-9a-fA-F]{4}))*"/y;

export function scan(text: string): Scan {
  const scanner = new Scanner(text);
  try {
    scanner.document();
    return { root: scanner.root, fault: null };
  } catch (fault) {
    if (fault instanceof FaultFound) return { root: scanner.root, fault: fault.fault };
    throw fault;
  }
}

class FaultFound extends Error {
  readonly fault: Fault;

  constructor(fault: Fault) {
    super(fault.message);
    this.fault = fault;
  }
}

class Scanner {
  root: JsonNode | null = null;
  readonly #text: string;
  #at = 0;

  constructor(text: string) {
    this.#text = text;
  }

  document(): void {
    this.#space();
    if (this.#at === this.#text.length) this.#fail("Nothing here yet: pick an example or paste a job.");
    this.root = this.#node("", this.#at);
    this.#value(this.root, 0);
    this.#space();
    if (this.#at < this.#text.length) this.#fail("Something follows after the end of the job.");
  }

  #value(node: JsonNode, depth: number): void {
    node.start = this.#at;
    if (depth > DEEPEST) this.#fail("Nested too deeply.");
    const first = this.#text[this.#at];
    if (first === "{" || first === "[") node.children = [];
    if (first === "{") this.#members(node, depth);
    else if (first === "[") this.#elements(node, depth);
    else this.#scalar(first);
    node.end = this.#at;
  }

  #members(node: JsonNode, depth: number): void {
    const seen = new Set<string>();
    this.#list("}", "a field or “}”", () => {
      const from = this.#at;
      const key = this.#string("Expected a field name in double quotes.");
      if (seen.has(key)) this.#fail(`“${key}” is given twice.`, from);
      seen.add(key);
      this.#space();
      if (this.#text[this.#at] !== ":") this.#fail(`Expected “:” after “${key}”.`);
      this.#at += 1;
      this.#space();
      this.#child(node, key, from, depth);
    });
  }

  #elements(node: JsonNode, depth: number): void {
    this.#list("]", "a value or “]”", () => {
      this.#child(node, String(node.children.length), this.#at, depth);
    });
  }

  #child(parent: JsonNode, name: string, from: number, depth: number): void {
    const child = this.#node(name, from);
    parent.children.push(child);
    this.#value(child, depth + 1);
  }

  #list(close: string, expected: string, item: () => void): void {
    const open = this.#at;
    this.#at += 1;
    this.#space();
    if (this.#text[this.#at] === close) {
      this.#at += 1;
      return;
    }
    for (;;) {
      if (this.#at === this.#text.length) this.#fail(`This “${this.#text[open]}” is never closed.`, open);
      if (this.#text[this.#at] === close) this.#fail(`Expected ${expected.split(" or ")[0]} after “,”.`);
      item();
      const end = this.#at;
      this.#space();
      const next = this.#text[this.#at];
      this.#at += 1;
      if (next === close) return;
      if (next === undefined) this.#fail(`This “${this.#text[open]}” is never closed.`, open);
      // A missing comma is seen where it should have been, not a line later.
      if (next !== ",") this.#fail(`Expected “,” or “${close}”.`, end);
      this.#space();
    }
  }

  #scalar(first: string | undefined): void {
    if (first === '"') {
      this.#string("");
      return;
    }
    if (this.#skip(NUMBER)) {
      const next = this.#text[this.#at];
      if (next !== undefined && /[\w.+]/.test(next)) this.#fail("This is not a number as JSON writes it.");
      return;
    }
    const word = this.#match(WORD);
    if (word === null) this.#fail("Expected a value.");
    if (!["true", "false", "null"].includes(word)) {
      this.#fail(`“${word}” is not a value; texts need double quotes.`, this.#at - word.length);
    }
    const next = this.#text[this.#at];
    if (next !== undefined && /[\w.+]/.test(next)) this.#fail("This is not a number as JSON writes it.");
  }

  #string(otherwise: string): string {
    if (this.#text[this.#at] !== '"') this.#fail(otherwise);
    const raw = this.#match(STRING);
    if (raw === null) this.#fail("This text has no closing quote on its line, or a wrong escape.");
    return raw.includes("\\") ? (JSON.parse(raw) as string) : raw.slice(1, -1);
  }

  #skip(pattern: RegExp): boolean {
    pattern.lastIndex = this.#at;
    if (!pattern.test(this.#text)) return false;
    this.#at = pattern.lastIndex;
    return true;
  }

  #match(pattern: RegExp): string | null {
    pattern.lastIndex = this.#at;
    const found = pattern.exec(this.#text)?.[0] ?? null;
    this.#at += found?.length ?? 0;
    return found;
  }

  #space(): void {
    for (;;) {
      const code = this.#text.charCodeAt(this.#at);
      if (code !== 0x20 && code !== 0x0a && code !== 0x0d && code !== 0x09) return;
      this.#at += 1;
    }
  }

  // Until its end is known, a node reaches to the end of the text: the caret is inside it.
  #node(name: string, from: number): JsonNode {
    return { start: this.#at, end: this.#text.length, name, from, children: NONE };
  }

  #fail(message: string, offset = this.#at): never {
    throw new FaultFound({ offset: Math.min(offset, this.#text.length), message });
  }
}
