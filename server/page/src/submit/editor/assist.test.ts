import { CompletionContext } from "@codemirror/autocomplete";
import { json } from "@codemirror/lang-json";
import { EditorState } from "@codemirror/state";
import { describe, expect, it } from "vitest";
import type { Schema } from "../json/schema";
import { complete } from "./assist";
import { placeAt } from "./places";

const SCHEMA: Schema = {
  type: "object",
  properties: {
    kind: { type: "string" },
    spec: {
      type: "object",
      properties: {
        bond: { type: "object", properties: { modulus_n: { type: "number", "x-unit": "N", minimum: 0 } } },
        jaws: { oneOf: [{ const: "half_bond", description: "Cut." }, { const: "clamped" }], default: "clamped" },
        stages: { type: "array", items: { type: "object", properties: { steps: { type: "integer", default: 5 } } } },
        flag: { type: "boolean" },
      },
    },
  },
};

/** A text and the place of its `|`. */
function at(text: string): { state: EditorState; position: number } {
  const position = text.indexOf("|");
  return { state: EditorState.create({ doc: text.replace("|", ""), extensions: [json()] }), position };
}

function place(text: string) {
  const { state, position } = at(text);
  return placeAt(state, position);
}

function offered(text: string): string[] {
  const { state, position } = at(text);
  return complete(SCHEMA, new CompletionContext(state, position, true))?.options.map(({ label }) => label) ?? [];
}

describe("placeAt", () => {
  it("names the value around the caret", () => {
    expect(place('{"spec": {"bond": {"modulus_n": 0.|4}}}').path).toEqual(["spec", "bond", "modulus_n"]);
    expect(place('{"spec": {"stages": [{}, {"steps": 1|}]}}').path).toEqual(["spec", "stages", "1", "steps"]);
    expect(place('{"a": [1, 2, 3|]}').path).toEqual(["a", "2"]);
  });

  it("names the object whose field is being named", () => {
    expect(place('{"spec": {"bo|nd": 1}}')).toMatchObject({ path: ["spec"], isName: true });
    expect(place('{"spec": {|}}')).toMatchObject({ path: ["spec"], isName: true });
    expect(place('{"spec": {"bond": {}|}}').path).toEqual(["spec", "bond"]);
  });

  it("goes on beyond a fault", () => {
    expect(place('{"a": , "spec": {"bond": {"modulus_n": 4|}}').path).toEqual(["spec", "bond", "modulus_n"]);
  });
});

describe("complete", () => {
  it("offers the fields that are not there yet", () => {
    expect(offered('{"spec": {"bond": {}, |}}')).toEqual(['"jaws"', '"stages"', '"flag"']);
    expect(offered('{"spec": {"bo|": 1}}')).toEqual(['"bond"', '"jaws"', '"stages"', '"flag"']);
    expect(offered('{"spec": {"stages": [{"|"}]}}')).toEqual(['"steps"']);
  });

  it("offers the words that a value may be", () => {
    expect(offered('{"spec": {"jaws": "|"}}')).toEqual(['"half_bond"', '"clamped"']);
    expect(offered('{"spec": {"flag": |}}')).toEqual(["true", "false"]);
    expect(offered('{"spec": {"stages": [{"steps": |}]}}')).toEqual(["5"]);
  });

  it("has nothing to offer where the schema knows nothing", () => {
    expect(offered('{"spec": {"other": {|}}}')).toEqual([]);
    expect(offered('{"kind": "|"}')).toEqual([]);
  });

  it("writes a name's colon unless it is there", () => {
    const applied = (text: string): unknown => {
      const { state, position } = at(text);
      return complete(SCHEMA, new CompletionContext(state, position, true))?.options[0]?.apply;
    };
    expect(applied('{"spec": {|}}')).toBe('"bond": ');
    expect(applied('{"spec": {"x|": 1}}')).toBe('"bond"');
  });
});
