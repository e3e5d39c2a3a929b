// Poly data of VTK as the engine writes it: arrays appended raw, compressed with zlib in blocks.
// An array is the number of its blocks, bytes of a full block, bytes of the last, compressed bytes
// of each block, all as unsigned 64-bit numbers, then the blocks.

export interface Values {
  name: string;
  /** Numbers for each point or cell. */
  components: number;
  values: Float64Array | Int32Array | Uint8Array;
}

export interface PolyData {
  /** x, y, z of each point. */
  points: Float64Array;
  /** Two points for each line. */
  lines: Int32Array;
  /** Points of all polygons, and where each ends. */
  corners: Int32Array;
  ends: Int32Array;
  pointData: Values[];
  cellData: Values[];
}

const TYPES: Record<string, (buffer: ArrayBuffer) => Values["values"]> = {
  Float64: (buffer) => new Float64Array(buffer),
  Int32: (buffer) => new Int32Array(buffer),
  UInt8: (buffer) => new Uint8Array(buffer),
};

/** Reads a file; throws on any that is not of the engine's form. */
export async function readVtp(file: ArrayBuffer): Promise<PolyData> {
  const bytes = new Uint8Array(file);
  const [start, header] = splitHeader(bytes);
  const arrays = (section: string): Promise<Values[]> => {
    const [, inside = ""] = new RegExp(`<${section}>([^]*?)</${section}>`).exec(header) ?? [];
    return Promise.all(
      [...inside.matchAll(/<DataArray ([^>]*)>/g)].map(([, element = ""]) => readArray(bytes, start, element)),
    );
  };
  const [points, lines, polygons, pointData, cellData] = await Promise.all(
    ["Points", "Lines", "Polys", "PointData", "CellData"].map(arrays),
  );
  const whole = (list: Values[] | undefined, name: string): Int32Array =>
    (list?.find((array) => array.name === name)?.values ?? new Int32Array()) as Int32Array;
  return {
    points: (points?.[0]?.values ?? new Float64Array()) as Float64Array,
    lines: whole(lines, "connectivity"),
    corners: whole(polygons, "connectivity"),
    ends: whole(polygons, "offsets"),
    pointData: pointData ?? [],
    cellData: cellData ?? [],
  };
}

/** Where the appended data begins, and the XML before it. */
function splitHeader(bytes: Uint8Array): [start: number, header: string] {
  // The header is text, and short; what follows is not.
  const text = new TextDecoder("latin1").decode(bytes.subarray(0, 65_536));
  const at = text.indexOf("<AppendedData");
  const start = text.indexOf("_", at) + 1;
  if (at < 0 || start === 0) throw new Error("This snapshot is not in the form that the page reads.");
  return [start, text.slice(0, at)];
}

async function readArray(bytes: Uint8Array, start: number, element: string): Promise<Values> {
  const attribute = (name: string): string => new RegExp(`\\b${name}="([^"]*)"`).exec(element)?.[1] ?? "";
  const typed = TYPES[attribute("type")];
  if (!typed) throw new Error(`This snapshot has values of an unknown type, ${attribute("type")}.`);
  const offset = start + Number(attribute("offset"));
  const part = (from: number, size: number): Uint8Array<ArrayBuffer> => {
    if (!(from >= start && size >= 0 && from + size <= bytes.length)) throw new Error("This snapshot is cut off.");
    return bytes.slice(from, from + size);
  };
  const words = (from: number, count: number): number[] =>
    Array.from(new BigUint64Array(part(from, 8 * count).buffer), Number);
  const [count = 0] = words(offset, 1);
  const sizes = words(offset + 8 * 3, count);
  let from = offset + 8 * (3 + count);
  // All parts are there before the first is unpacked: nothing is left running when one is not.
  const packed = sizes.map((size) => {
    const block = part(from, size);
    from += size;
    return block;
  });
  const buffer = await new Blob(await Promise.all(packed.map(inflate))).arrayBuffer();
  return { name: attribute("Name"), components: Number(attribute("NumberOfComponents") || 1), values: typed(buffer) };
}

function inflate(block: Uint8Array<ArrayBuffer>): Promise<ArrayBuffer> {
  return new Response(new Blob([block]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer();
}
