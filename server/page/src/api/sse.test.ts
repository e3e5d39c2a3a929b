import { describe, expect, it } from "vitest";
import { EventReader } from "./sse";

const STREAM = ': hello\n\nid: 7\nevent: progress\ndata: {"a":\ndata: 1}\n\nid: 8\r\nevent: job\r\ndata:{}\r\n\r\n';

describe("EventReader", () => {
  it("reads name and joined data and skips comments", () => {
    const reader = new EventReader();
    expect(reader.read(STREAM)).toEqual([
      { name: "progress", data: '{"a":\n1}' },
      { name: "job", data: "{}" },
    ]);
  });

  it("gives the same events wherever the stream is cut", () => {
    for (let cut = 0; cut <= STREAM.length; cut++) {
      const reader = new EventReader();
      const events = [...reader.read(STREAM.slice(0, cut)), ...reader.read(STREAM.slice(cut))];
      expect(events.map((event) => event.name)).toEqual(["progress", "job"]);
    }
  });
});
