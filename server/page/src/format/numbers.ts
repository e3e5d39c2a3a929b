// Numbers for reading: as many digits as carry meaning, the rest in a tooltip.

/** Significant digits shown: more than any load cell resolves. */
const DIGITS = 4;
/** No-break narrow space, between groups of three digits and before units. */
export const NARROW = "\u202f";
const MINUS = "\u2212";

/** A number with four significant digits, in powers of ten when very large or small. */
export function formatNumber(value: number, digits = DIGITS): string {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e7 || size < 1e-4) return formatPower(value, digits);
  // Whole numbers are counts or settings, which are shown as they are.
  if (Number.isInteger(value)) return group(value.toFixed(0));
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return group(value.toFixed(Math.min(decimals, 12)));
}

/** A number that somebody chose, such as a bound: without the zeros that mark measured digits. */
export function formatChosen(value: number): string {
  return trimZeros(formatNumber(value));
}

/** An error or a scatter: two digits, with as many decimals as it takes to read them beside the value. */
export function formatError(size: number): string {
  const rounded = Number(size.toPrecision(2));
  if (!(rounded >= SMALLEST_ERROR && rounded < 1e-4)) return formatChosen(rounded);
  return trimZeros(rounded.toFixed(1 - Math.floor(Math.log10(rounded))));
}

/** Errors below this have more zeros than one likes to count. */
const SMALLEST_ERROR = 1e-6;

function formatPower(value: number, digits: number): string {
  const [mantissa = "", exponent = "0"] = value.toExponential(digits - 1).split("e");
  const power = [...String(Number(exponent))].map((c) => SUPERSCRIPT[c] ?? c).join("");
  return `${trimZeros(mantissa).replace("-", MINUS)}${NARROW}×${NARROW}10${power}`;
}

const SUPERSCRIPT: Record<string, string> = {
  "-": "⁻",
  "0": "⁰",
  "1": "¹",
  "2": "²",
  "3": "³",
  "4": "⁴",
  "5": "⁵",
  "6": "⁶",
  "7": "⁷",
  "8": "⁸",
  "9": "⁹",
};

function trimZeros(text: string): string {
  return text.includes(".") ? text.replace(/\.?0+$/, "") : text;
}

function group(text: string): string {
  const [whole = "", decimals] = text.replace("-", MINUS).split(".");
  const grouped = whole.length > 4 ? whole.replace(/\B(?=(\d{3})+$)/g, NARROW) : whole;
  return decimals === undefined ? grouped : `${grouped}.${decimals}`;
}

/** A size in bytes as people read it. */
export function formatBytes(bytes: number): string {
  const units = ["B", "kB", "MB", "GB", "TB"];
  let size = bytes;
  let unit = 0;
  while (size >= 999.5 && unit < units.length - 1) {
    size /= 1000;
    unit += 1;
  }
  const text = unit === 0 || size >= 99.5 ? size.toFixed(0) : size.toPrecision(2);
  return `${text}${NARROW}${units[unit]}`;
}
