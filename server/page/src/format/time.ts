// Times and durations for reading.
import { NARROW } from "./numbers";

/** A duration [s] in its two leading units: `850 ms`, `42 s`, `3 min 20 s`, `2 h 5 min`. */
export function formatDuration(seconds: number): string {
  if (!Number.isFinite(seconds) || seconds < 0) return "–";
  if (seconds < 1) return `${Math.round(seconds * 1000)}${NARROW}ms`;
  // Whole seconds are those of a running clock.
  if (seconds < 10 && !Number.isInteger(seconds)) return `${seconds.toFixed(1)}${NARROW}s`;
  const whole = Math.round(seconds);
  if (whole < 60) return `${whole}${NARROW}s`;
  if (whole < 3600) return pair(Math.floor(whole / 60), "min", whole % 60, "s");
  const minutes = Math.round(whole / 60);
  if (minutes < 1440) return pair(Math.floor(minutes / 60), "h", minutes % 60, "min");
  const hours = Math.round(minutes / 60);
  return pair(Math.floor(hours / 24), "d", hours % 24, "h");
}

function pair(large: number, largeUnit: string, small: number, smallUnit: string): string {
  const first = `${large}${NARROW}${largeUnit}`;
  return small === 0 ? first : `${first} ${small}${NARROW}${smallUnit}`;
}

/** An estimate [s], rounded as far as an estimate can be trusted. */
export function formatEta(seconds: number): string {
  if (seconds < 1.5) return "almost done";
  if (seconds < 60) return `about ${Math.ceil(seconds)}${NARROW}s left`;
  const minutes = Math.round(seconds / 60);
  if (minutes < 90) return `about ${minutes}${NARROW}min left`;
  return `about ${Math.round(seconds / 3600)}${NARROW}h left`;
}

/** How long ago a moment was, both in ms since 1970. */
export function formatAgo(moment: number, now: number): string {
  const seconds = Math.max(0, (now - moment) / 1000);
  if (seconds < 10) return "just now";
  if (seconds < 60) return `${Math.floor(seconds / 10) * 10}${NARROW}s ago`;
  if (seconds < 3600) return `${Math.floor(seconds / 60)}${NARROW}min ago`;
  if (seconds < 86_400) return `${Math.floor(seconds / 3600)}${NARROW}h ago`;
  const days = Math.floor(seconds / 86_400);
  return days === 1 ? "yesterday" : days < 14 ? `${days} days ago` : formatDay(moment);
}

function formatDay(moment: number): string {
  return new Date(moment).toISOString().slice(0, 10);
}

/** The exact local moment, year first so that nobody mistakes day and month. */
export function formatMoment(moment: number): string {
  const date = new Date(moment);
  const two = (part: number): string => String(part).padStart(2, "0");
  const day = `${date.getFullYear()}-${two(date.getMonth() + 1)}-${two(date.getDate())}`;
  return `${day} ${two(date.getHours())}:${two(date.getMinutes())}:${two(date.getSeconds())}`;
}
