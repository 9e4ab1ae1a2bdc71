// Which parts of a scene are drawn. Hidden ones stay in the contact: only their surface goes.
import type {Body} from '../server/binary.js';
import type {NamedPart} from '../server/protocol.js';

/** For each triangle id below the sum of all: the place of its part. */
export function places_of(parts: readonly NamedPart[]): (triangle: number) => number {
  const ends: number[] = [];
  let end = 0;
  for (const {triangles} of parts) ends.push(end += triangles);
  return (triangle) => {
    let low = 0;
    let high = ends.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (ends[middle] <= triangle)
        low = middle + 1;
      else
        high = middle;
    }
    return low;
  };
}

/**
 * The corners of what is drawn of a body while some of its parts are hidden; the body's own where none is.
 */
export function shown_corners(
    body: Body, parts: readonly NamedPart[], hidden: ReadonlySet<number>): Uint32Array {
  if (hidden.size === 0) return body.corners;
  const place = places_of(parts);
  const out = new Uint32Array(body.corners.length);
  let count = 0;
  for (let t = 0; t < body.ids.length; ++t) {
    if (hidden.has(place(body.ids[t]))) continue;
    out.set(body.corners.subarray(3 * t, 3 * t + 3), 3 * count++);
  }
  return out.slice(0, 3 * count);
}
