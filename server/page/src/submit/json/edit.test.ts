import { describe, expect, it } from "vitest";
import { applyChange, removeValue, setValue } from "./edit";
import { scan, type JsonNode } from "./scan";

const TEXT = `{
  "kind": "k",
  "spec": {
    "a":   1.50,
    "list": [1, 2, 3],
    "c": { "x": 1 }
  }
}
`;

function read(text: string): JsonNode {
  const { root, fault } = scan(text);
  if (!root || fault) throw new Error(`${fault?.message}: ${text}`);
  return root;
}

const set = (text: string, path: string[], raw: string, names: string[] = []): string =>
  applyChange(
    text,
    setValue(text, read(text), path, raw, () => names),
  );

const remove = (text: string, path: string[]): string => {
  const change = removeValue(read(text), path);
  return change ? applyChange(text, change) : text;
};

describe("setValue", () => {
  it("replaces a value and leaves every other byte", () => {
    expect(set(TEXT, ["spec", "a"], "1e-6")).toBe(TEXT.replace("1.50", "1e-6"));
    expect(set(TEXT, ["spec", "list", "1"], "7")).toBe(TEXT.replace("[1, 2, 3]", "[1, 7, 3]"));
  });

  it("puts a new field where the schema has it, on a line of its own", () => {
    const names = ["z", "a", "b", "list", "c"];
    expect(set(TEXT, ["spec", "b"], "true", names)).toBe(TEXT.replace("1.50,", '1.50,\n    "b": true,'));
    expect(set(TEXT, ["spec", "z"], "0", names)).toBe(TEXT.replace('"a":   ', '"z": 0,\n    "a":   '));
  });

  it("goes on in one line where the others stand in one", () => {
    expect(set(TEXT, ["spec", "c", "y"], "2")).toBe(TEXT.replace('"x": 1', '"x": 1, "y": 2'));
    expect(set(TEXT, ["spec", "list", "3"], "4")).toBe(TEXT.replace("2, 3]", "2, 3, 4]"));
    expect(set("[]", ["2"], "4")).toBe("[null, null, 4]");
  });

  it("makes what is missing on the way", () => {
    const text = set(TEXT, ["spec", "d", "e", "f"], '"deep"');
    expect(JSON.parse(text)).toMatchObject({ spec: { d: { e: { f: "deep" } } } });
    expect(text).toContain('    "d": {\n      "e": {\n        "f": "deep"\n      }\n    }\n  }\n}\n');
    expect(set("{}", ["a"], "1")).toBe('{\n  "a": 1\n}');
  });

  it("puts an object in place of null", () => {
    expect(JSON.parse(set('{"a": null}', ["a", "b"], "1"))).toEqual({ a: { b: 1 } });
  });

  it("keeps names that are escaped", () => {
    const text = '{"a\\"b": {"/": 1}}';
    expect(JSON.parse(set(text, ['a"b', "/"], "2"))).toEqual({ 'a"b': { "/": 2 } });
  });
});

describe("removeValue", () => {
  it("takes the comma with it, wherever the field stands", () => {
    expect(remove(TEXT, ["spec", "a"])).toBe(TEXT.replace('"a":   1.50,\n    ', ""));
    expect(remove(TEXT, ["spec", "c"])).toBe(TEXT.replace(',\n    "c": { "x": 1 }', ""));
    expect(JSON.parse(remove(TEXT, ["spec", "c", "x"]))).toMatchObject({ spec: { c: {} } });
    expect(remove(TEXT, ["spec", "list", "0"])).toBe(TEXT.replace("[1, 2", "[2"));
  });

  it("leaves a text that has no such field", () => {
    expect(removeValue(read(TEXT), ["spec", "q"])).toBeNull();
    expect(removeValue(read(TEXT), ["spec", "q", "r"])).toBeNull();
  });

  it("undoes what setValue did", () => {
    for (const path of [["spec", "b"], ["spec", "list", "3"], ["notes"]]) {
      expect(remove(set(TEXT, path, "9"), path)).toBe(TEXT);
    }
  });
});
