// The binary forms for drawing (docs/SERVICE.md): geometry, triangles, voxels. Little-endian. Each reader
// refuses what is short or strange.
import type {Vec3} from './protocol.js';

/** A body's triangles: three floats a vertex (m), three corners a triangle, and the id of each triangle. */
export interface Body {
  vertices: Float32Array;
  corners: Uint32Array;
  ids: Uint32Array
}
export interface Geometry {
  reduced: boolean;
  mockup: Body;
  tool: Body
}
/** Cells of one class: x + nx·(y + ny·z), of the grid that begins at `origin`. Metres; the body's frame. */
export interface Voxels {
  origin: Vec3;
  size: number;
  counts: Vec3;
  cells: Uint32Array
}

function begin(bytes: ArrayBuffer, magic: string, header: number): DataView {
  const view = new DataView(bytes);
  if (bytes.byteLength < header)
    throw new Error(`${magic}: ${bytes.byteLength} bytes, fewer than its header of ${header}`);
  const found = String.fromCharCode(view.getUint8(0), view.getUint8(1), view.getUint8(2), view.getUint8(3));
  if (found !== magic) throw new Error(`expected ${magic}, found ${JSON.stringify(found)}`);
  const version = view.getUint32(4, true);
  if (version !== 1) throw new Error(`${magic}: version ${version}, this viewer reads 1`);
  return view;
}

function expect_size(bytes: ArrayBuffer, magic: string, size: number): void {
  if (bytes.byteLength !== size) throw new Error(`${magic}: ${bytes.byteLength} bytes instead of ${size}`);
}

export function read_geometry(bytes: ArrayBuffer): Geometry {
  const view = begin(bytes, 'PGEO', 32);
  const counts = [12, 16, 20, 24].map((at) => view.getUint32(at, true));
  expect_size(bytes, 'PGEO', 32 + 12 * (counts[0] + counts[2]) + 16 * (counts[1] + counts[3]));
  let at = 32;
  const body = (vertices: number, triangles: number): Body => {
    const result = {
      vertices: new Float32Array(bytes, at, 3 * vertices),
      corners: new Uint32Array(bytes, at + 12 * vertices, 3 * triangles),
      ids: new Uint32Array(bytes, at + 12 * vertices + 12 * triangles, triangles),
    };
    for (const corner of result.corners)
      if (corner >= vertices) throw new Error(`PGEO: corner ${corner} of ${vertices} vertices`);
    at += 12 * vertices + 16 * triangles;
    return result;
  };
  return {
    reduced: (view.getUint32(8, true) & 1) !== 0,
    mockup: body(counts[0], counts[1]),
    tool: body(counts[2], counts[3])
  };
}

export function read_voxels(bytes: ArrayBuffer): Voxels {
  const view = begin(bytes, 'PVOX', 72);
  const doubles = [16, 24, 32, 40].map((at) => view.getFloat64(at, true));
  const counts = [48, 52, 56].map((at) => view.getUint32(at, true)) as Vec3;
  const cells = Number(view.getBigUint64(64, true));
  expect_size(bytes, 'PVOX', 72 + 4 * cells);
  return {
    origin: [doubles[0], doubles[1], doubles[2]],
    size: doubles[3],
    counts,
    cells: new Uint32Array(bytes, 72, cells)
  };
}

/** As many of the ids, the smallest first, as `most` characters hold. */
export function ids_within(ids: number[], most: number): {ids: number[]; text: string} {
  let taken = [...ids].sort((a, b) => a - b);
  let text = id_ranges(taken);
  while (text.length > most && taken.length > 1) {
    taken = taken.slice(0, Math.max(1, Math.floor((0.9 * taken.length * most) / text.length)));
    text = id_ranges(taken);
  }
  return {ids: taken, text};
}

/** Ids as the query asks for them: ascending, runs joined, "1,5-9". */
export function id_ranges(ids: number[]): string {
  const sorted = [...ids].sort((a, b) => a - b);
  const parts: string[] = [];
  for (let i = 0; i < sorted.length;) {
    let j = i;
    while (j + 1 < sorted.length && sorted[j + 1] === sorted[j] + 1) ++j;
    parts.push(i === j ? `${sorted[i]}` : `${sorted[i]}-${sorted[j]}`);
    i = j + 1;
  }
  return parts.join(',');
}
