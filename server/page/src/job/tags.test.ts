import { expect, it } from "vitest";
import { readTags } from "./tags";

it.each([
  ["", []],
  [" , ,", []],
  ["PET", ["PET"]],
  ["PET,  needle-punched ,batch 7", ["PET", "needle-punched", "batch 7"]],
  ["b, a, b", ["b", "a"]],
])("%j are the tags %j", (text, tags) => expect(readTags(text)).toEqual(tags));
