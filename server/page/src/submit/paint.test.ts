import { describe, expect, it } from "vitest";
import { paint } from "./paint";

describe("paint", () => {
  it("loses no character, whatever is being typed", () => {
    for (const line of ['  "a": [1, -2.5e3, true, "x\\"y"],', '"open', '{"k" : nul', '}} \\ "', ""]) {
      expect(
        paint(line)
          .map((token) => token.text)
          .join(""),
      ).toBe(line);
    }
  });

  it("tells keys, texts, numbers and words apart", () => {
    const kinds = paint('"a": "b", "c": 1.5, "d": null').filter((token) => token.kind !== "other");
    expect(kinds.map((token) => token.kind)).toEqual(["key", "text", "key", "number", "key", "word"]);
  });
});
