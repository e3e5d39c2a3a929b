import { describe, expect, it } from "vitest";
import { findNode, formatPointer, lineAt, lineStarts, parsePointer } from "./pointer";
import { scan } from "./scan";

const TEXT = `{
  "kind": "nonwoven_tensile",
  "spec": {
    "bond": {"modulus_n": 0.4, "a/b~c": [1, {"x": null}]},
    "seed": 1
  }
}`;

function textAt(pointer: string): string {
  const { root } = scan(TEXT);
  if (!root) throw new Error("no tree");
  const node = findNode(root, pointer);
  return TEXT.slice(node.start, node.end);
}

describe("scan", () => {
  it("accepts what JSON.parse accepts and refuses what it refuses", () => {
    const texts = [
      "1",
      "-0.5e+3",
      '"a\\u00e9\\n"',
      "[]",
      "{}",
      "[1,2]",
      '{"a":[{}]}',
      " true ",
      TEXT,
      "",
      "01",
      "1.",
      ".5",
      "+1",
      "tru",
      "[1,]",
      '{"a":1,}',
      '{"a" 1}',
      "{'a':1}",
      '"\\x"',
      '"a',
      "[1 2]",
      "{a:1}",
      "[",
      "1 2",
      '"a\nb"',
      "NaN",
      "-",
    ];
    for (const text of texts) {
      let isValid = true;
      try {
        JSON.parse(text);
      } catch {
        isValid = false;
      }
      expect(scan(text).fault === null, text).toBe(isValid);
    }
  });

  it("refuses a key given twice, where it is given again", () => {
    expect(scan('{"a": 1, "a": 2}').fault).toEqual({ offset: 9, message: "“a” is given twice." });
  });

  it("sees a missing comma where it should have been", () => {
    const text = '{\n  "a": 1\n  "b": 2\n}';
    expect(scan(text).fault?.offset).toBe(text.indexOf("1") + 1);
  });

  it("gives the tree up to the fault", () => {
    const text = '{"spec": {"bond": {"modulus_n": ';
    const { root, fault } = scan(text);
    expect(fault).not.toBeNull();
    expect(root && findNode(root, "/spec/bond/modulus_n")).toMatchObject({ name: "modulus_n", end: text.length });
  });
});

describe("pointers", () => {
  it("find values, also with escaped names", () => {
    expect(textAt("/spec/bond/modulus_n")).toBe("0.4");
    expect(textAt("/spec/bond/a~1b~0c/1/x")).toBe("null");
    expect(textAt("")).toBe(TEXT);
  });

  it("find the closest ancestor of a missing field", () => {
    expect(textAt("/spec/bond/mean_strength_n")).toBe(textAt("/spec/bond"));
  });

  it("are read and written as inverses", () => {
    const path = ["a/b", "~", "", "3"];
    expect(parsePointer(formatPointer(path))).toEqual(path);
  });
});

describe("lines", () => {
  it("are found from offsets", () => {
    const starts = lineStarts("ab\n\ncd");
    expect(starts).toEqual([0, 3, 4]);
    expect([0, 2, 3, 4, 6].map((offset) => lineAt(starts, offset))).toEqual([0, 0, 1, 2, 2]);
  });
});
