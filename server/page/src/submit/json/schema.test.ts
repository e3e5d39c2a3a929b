import { describe, expect, it } from "vitest";
import { describeField } from "./schema";

// The shapes that schemars writes: tagged choices, options, lists, defaults.
const SCHEMA = {
  type: "object",
  required: ["fabric"],
  properties: {
    fabric: {
      description: "The specimen.",
      oneOf: [
        {
          type: "object",
          required: ["lattice"],
          properties: {
            lattice: {
              type: "object",
              properties: {
                spacing_mm: {
                  description: "Spacing.",
                  type: "array",
                  "x-unit": "mm",
                  items: { type: "number", minimum: 1e-6, maximum: 1e6 },
                },
              },
            },
          },
        },
        { type: "object", required: ["network"], properties: { network: { type: "object" } } },
      ],
    },
    bond: {
      type: "object",
      default: { modulus_n: null },
      properties: {
        modulus_n: { description: "e.", type: ["number", "null"], minimum: 0, maximum: 10, "x-unit": "N" },
        sigma: { type: "number", exclusiveMinimum: 0, default: 0.5 },
      },
    },
    materials: {
      type: "object",
      additionalProperties: { type: "object", properties: { density: { type: "number", "x-unit": "kg/m3" } } },
    },
    stages: { type: "array", items: { type: "object", properties: { steps: { type: "integer" } } } },
    breaking: {
      description: "Which bonds break.",
      oneOf: [
        { type: "string", const: "weakest_first", description: "Only one." },
        { type: "string", const: "none", description: "Never." },
      ],
    },
  },
};

describe("describeField", () => {
  it("gives unit, range, type and default", () => {
    const doc = describeField(SCHEMA, ["bond", "modulus_n"]);
    expect(doc).toMatchObject({ description: "e.", unit: "N", range: "0 … 10", type: "number" });
    expect(describeField(SCHEMA, ["bond", "sigma"])).toMatchObject({ range: "> 0", default: "0.5" });
    expect(describeField(SCHEMA, ["bond"])?.default).toBe('{"modulus_n":null}');
  });

  it("finds a field in the choice that has it", () => {
    const doc = describeField(SCHEMA, ["fabric", "lattice", "spacing_mm"]);
    expect(doc).toMatchObject({ description: "Spacing.", unit: "mm", range: "1e-6 … 1e6" });
    expect(describeField(SCHEMA, ["fabric"])).toMatchObject({
      description: "The specimen.",
      isRequired: true,
      fields: ["lattice", "network"],
    });
  });

  it("gives a list's unit and meaning to its numbers", () => {
    const doc = describeField(SCHEMA, ["fabric", "lattice", "spacing_mm", "2"]);
    expect(doc).toMatchObject({ unit: "mm", description: "Spacing." });
  });

  it("lists the options of a choice with their meaning", () => {
    expect(describeField(SCHEMA, ["breaking"])?.options).toEqual([
      { value: '"weakest_first"', description: "Only one." },
      { value: '"none"', description: "Never." },
    ]);
  });

  it("names a field as the guide does", () => {
    expect(describeField(SCHEMA, ["bond", "modulus_n"])?.anchor).toBe("bond.modulus_n");
    expect(describeField(SCHEMA, ["fabric", "lattice", "spacing_mm", "2"])?.anchor).toBe("fabric.lattice.spacing_mm");
    expect(describeField(SCHEMA, ["materials", "basalt"])?.anchor).toBe("materials.*");
    expect(describeField(SCHEMA, ["materials", "basalt", "density"])).toMatchObject({
      anchor: "materials.*.density",
      unit: "kg/m3",
    });
    expect(describeField(SCHEMA, ["stages", "0", "steps"])?.anchor).toBe("stages.*.steps");
    expect(describeField(SCHEMA, [])?.anchor).toBe("");
  });

  it("does not know fields that do not exist", () => {
    expect(describeField(SCHEMA, ["bond", "modulus"])).toBeNull();
  });
});
