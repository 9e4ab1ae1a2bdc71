// The edges of a mesh by which one knows its shape: those between triangles that lie the least in one plane.
import {Vector3} from 'three';

/**
 * At most `most` edges, two corners each: open ones first, then those of the sharpest turn. Edges inside a
 * plane are none.
 */
export function sharp_edges(vertices: Float32Array, corners: Uint32Array, most: number): Uint32Array {
  const FLAT = 1e-3;  // 1 − cosine of 2.5 degrees; chosen
  const count = vertices.length / 3;
  const first = new Map<number, number>();  // an edge's first triangle
  const normals = new Float32Array(corners.length);
  const [a, b, c] = [new Vector3(), new Vector3(), new Vector3()];
  const found: {key: number; turn: number}[] = [];
  for (let at = 0; at < corners.length; at += 3) {
    a.fromArray(vertices, 3 * corners[at]);
    b.fromArray(vertices, 3 * corners[at + 1])
        .sub(a)
        .cross(c.fromArray(vertices, 3 * corners[at + 2]).sub(a))
        .normalize()
        .toArray(normals, at);
    for (let k = 0; k < 3; ++k) {
      const [from, to] = [corners[at + k], corners[at + ((k + 1) % 3)]];
      const key = Math.min(from, to) * count + Math.max(from, to);
      const other = first.get(key);
      if (other === undefined) {
        first.set(key, at);
        continue;
      }
      first.delete(key);
      const turn = 1 -
          (normals[at] * normals[other] + normals[at + 1] * normals[other + 1] +
           normals[at + 2] * normals[other + 2]);
      if (turn > FLAT) found.push({key, turn});
    }
  }
  for (const key of first.keys()) found.push({key, turn: Infinity});
  if (found.length > most)
    found.sort((one, two) => (one.turn === two.turn ? 0 : two.turn - one.turn)).length = most;
  return Uint32Array.from(found.flatMap(({key}) => [Math.floor(key / count), key % count]));
}
