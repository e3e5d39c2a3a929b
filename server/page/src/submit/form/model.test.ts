import { describe, expect, it } from "vitest";
import { gistOf, numberText, optionOf, readField, scaffold, scaffoldOf, shownText, type Field } from "./model";

// As schemars writes them.
const SCHEMA = {
  type: "object",
  required: ["version", "shape"],
  properties: {
    version: { type: "integer", minimum: 1, maximum: 1 },
    spacing_mm: {
      type: "array",
      description: "Along x, y, z. It sets the size.",
      items: { type: "number", minimum: 1e-6, maximum: 10 },
      minItems: 3,
      maxItems: 3,
      default: [1, 1, 1],
      "x-unit": "mm",
    },
    speed_mm_per_min: { type: "number", default: 100, "x-unit": "mm/min" },
    shape: {
      oneOf: [
        { type: "string", enum: ["sphere"], description: "A sphere." },
        {
          type: "object",
          required: ["clump"],
          description: "Spheres in one.",
          properties: {
            clump: {
              type: "object",
              required: ["version"],
              properties: { version: { type: "integer", minimum: 2, maximum: 2 }, name: { type: "string" } },
            },
          },
        },
        { type: "object", required: ["list_m"], properties: { list_m: { type: "array", items: { type: "number" } } } },
      ],
    },
    accuracy: {
      anyOf: [
        { type: "string", enum: ["draft", "standard"] },
        { type: "object", properties: { steps: { type: "integer" } } },
      ],
      default: "standard",
    },
    level: {
      anyOf: [
        {
          oneOf: [
            { type: "string", const: "beam" },
            { type: "string", const: "truss" },
          ],
        },
        { type: "null" },
      ],
    },
    time_step_s: { anyOf: [{ type: "number" }, { type: "string", enum: ["auto"] }], "x-unit": "s" },
    load: { type: ["object", "null"], properties: { force_n: { type: ["number", "null"], "x-unit": "N" } } },
    test: { type: "object", default: {}, properties: { steps: { type: "integer" } } },
    materials: {
      type: "object",
      additionalProperties: { type: "object", properties: { density: { type: "number" } } },
    },
    csv: { type: "string", maxLength: 100000 },
    exact: { type: "object", properties: {}, additionalProperties: false },
    open: { type: "object", additionalProperties: true },
  },
};

const root = readField(SCHEMA);

function field(name: string): Field {
  const found = root.shape.is === "group" ? root.shape.fields.find((inner) => inner.name === name) : undefined;
  if (!found) throw new Error(`no field ${name}`);
  return found;
}

function options(name: string) {
  const { shape } = field(name);
  return shape.is === "choice" ? shape.options : [];
}

describe("readField", () => {
  it("gives each value its shape", () => {
    const shapes = (root.shape.is === "group" ? root.shape.fields : []).map(
      ({ name, shape }) => `${name}: ${shape.is}`,
    );
    expect(shapes).toEqual([
      "version: number",
      "spacing_mm: list",
      "speed_mm_per_min: number",
      "shape: choice",
      "accuracy: choice",
      "level: choice",
      "time_step_s: choice",
      "load: group",
      "test: group",
      "materials: map",
      "csv: text",
      "exact: group",
      "open: any",
    ]);
  });

  it("takes the unit out of the label, and gives it to the entries of a list", () => {
    expect(field("spacing_mm").label).toBe("Spacing");
    expect(field("speed_mm_per_min").label).toBe("Speed");
    const { shape } = field("spacing_mm");
    expect(shape).toMatchObject({
      shortest: 3,
      longest: 3,
      entry: { name: "", doc: { unit: "mm", range: "1e-6 … 10" } },
    });
  });

  it("lays choices within choices flat and leaves null out of them", () => {
    expect(options("level").map(({ word }) => word)).toEqual(['"beam"', '"truss"']);
    expect(options("accuracy").map(({ label }) => label)).toEqual(["Draft", "Standard", "Field by field"]);
    expect(options("time_step_s").map(({ label }) => label)).toEqual(["A number", "Auto"]);
    expect(options("shape").map(({ tag }) => tag)).toEqual(["", "clump", "list_m"]);
  });

  it("makes a switch of what is off unless it is given, not of what has defaults", () => {
    const parts = (root.shape.is === "group" ? root.shape.fields : []).filter(({ isPart }) => isPart);
    expect(parts.map(({ name }) => name)).toEqual(["time_step_s", "load", "materials", "exact"]);
  });
});

describe("optionOf", () => {
  it("knows a word, a tag and a value without one", () => {
    const name = (field: string, raw: string, keys: string[] = []): string | undefined =>
      optionOf(options(field), raw, keys)?.label;
    expect(name("shape", '"sphere"')).toBe("Sphere");
    expect(name("shape", '{"clump": {}}', ["clump"])).toBe("Clump");
    expect(name("accuracy", '{"steps": 1}', ["steps"])).toBe("Field by field");
    expect(name("accuracy", '"draft"')).toBe("Draft");
    expect(name("time_step_s", "-1e-6")).toBe("A number");
  });

  it("knows none of what the schema does not have", () => {
    expect(optionOf(options("shape"), '"cube"', [])).toBeUndefined();
    expect(optionOf(options("shape"), '{"cube": 1}', ["cube"])).toBeUndefined();
    expect(optionOf(options("accuracy"), "7", [])).toBeUndefined();
  });
});

describe("scaffold", () => {
  it("makes the parts that must be there and invents no value", () => {
    expect(scaffold(root)).toEqual({ version: 1 });
    expect(scaffold(field("load"))).toEqual({});
    expect(options("shape").map(scaffoldOf)).toEqual(["sphere", { clump: { version: 2 } }, { list_m: [] }]);
    expect(options("accuracy").map(scaffoldOf)).toEqual(["draft", "standard", {}]);
    expect(options("time_step_s").map(scaffoldOf)).toEqual([null, "auto"]);
  });
});

describe("gistOf", () => {
  it("is the first sentence", () => {
    expect(gistOf(field("spacing_mm").doc)).toBe("Along x, y, z.");
    expect(gistOf({ ...root.doc, description: "By 0.5, e.g. of [Zilka2022]" })).toBe("By 0.5, e.g. of [Zilka2022]");
  });
});

describe("numberText", () => {
  it("keeps every digit of a JSON number", () => {
    for (const text of ["1.50", "-0", "1e-6", "123456789012345678901234567890"])
      expect(numberText(text, true)).toBe(text);
  });

  it("writes a finished entry as JSON has it", () => {
    expect([".5", "+3", "2.", " 7 "].map((text) => numberText(text, true))).toEqual(["0.5", "3", "2", "7"]);
  });

  it("loses nothing of what is no number, and is read back as it was typed", () => {
    for (const text of ["1e", "-", ".5", "1,5", "0x10", "1 000", 'a"b\\']) {
      expect(shownText(numberText(text, false)), text).toBe(text);
    }
    for (const text of ["1,5", "0x10", "1 000", "1e999e", "+1e999"])
      expect(numberText(text, true)).toBe(JSON.stringify(text));
  });
});
