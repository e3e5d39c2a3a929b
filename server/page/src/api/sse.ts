// Server-sent events read from a stream of text. EventSource cannot send the Authorization header,
// so the page reads the stream itself. Ids are not kept: after an interruption the page fetches the
// present state, which is shorter than a replay.
import type { JobEvent } from "./types";

export interface ServerEvent {
  name: string;
  data: string;
}

/** An event of the server's as what it says. */
export function jobEvent({ name, data }: ServerEvent): JobEvent {
  return { event: name, data: JSON.parse(data) as unknown } as JobEvent;
}

/** Takes text as it comes, in pieces cut anywhere, and gives the events that are complete. */
export class EventReader {
  #rest = "";
  #name = "";
  #data: string[] = [];

  read(piece: string): ServerEvent[] {
    const lines = (this.#rest + piece).split("\n");
    this.#rest = lines.pop() ?? "";
    return lines.flatMap((line) => this.#line(line.endsWith("\r") ? line.slice(0, -1) : line));
  }

  #line(line: string): ServerEvent[] {
    if (line === "") return this.#dispatch();
    const colon = line.indexOf(":");
    const field = colon < 0 ? line : line.slice(0, colon);
    const value = colon < 0 ? "" : line.slice(colon + 1).replace(/^ /, "");
    if (field === "event") this.#name = value;
    else if (field === "data") this.#data.push(value);
    return [];
  }

  #dispatch(): ServerEvent[] {
    const event = { name: this.#name || "message", data: this.#data.join("\n") };
    const isEmpty = this.#data.length === 0;
    this.#name = "";
    this.#data = [];
    return isEmpty ? [] : [event];
  }
}
