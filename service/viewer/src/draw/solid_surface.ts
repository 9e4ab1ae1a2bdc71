// Whether a surface bounds solids, so that no far side of it is ever seen.

/**
 * Every piece of it that hangs together over vertices is closed, each edge run along as often one way as the
 * other, and faces outwards.
 */
export function is_solid(vertices: Float32Array, corners: Uint32Array): boolean {
  const count = vertices.length / 3;
  const joined = Uint32Array.from({length: count}, (_, i) => i);
  const piece_of = (vertex: number): number => {
    while (joined[vertex] !== vertex) vertex = joined[vertex] = joined[joined[vertex]];
    return vertex;
  };
  const runs = new Map<number, number>();  // of an edge, forwards less backwards, where they differ
  for (let i = 0; i < corners.length; ++i) {
    const from = corners[i], to = corners[i % 3 === 2 ? i - 2 : i + 1];
    joined[piece_of(from)] = piece_of(to);
    const edge = Math.min(from, to) * count + Math.max(from, to);
    const left = (runs.get(edge) ?? 0) + (from < to ? 1 : -1);
    if (left === 0)
      runs.delete(edge);
    else
      runs.set(edge, left);
  }
  if (runs.size > 0 || corners.length === 0) return false;
  const volumes = new Map<number, number>();  // times six
  for (let i = 0; i < corners.length; i += 3) {
    const [a, b, c] = [3 * corners[i], 3 * corners[i + 1], 3 * corners[i + 2]], v = vertices;
    const volume = v[a] * (v[b + 1] * v[c + 2] - v[b + 2] * v[c + 1]) +
        v[a + 1] * (v[b + 2] * v[c] - v[b] * v[c + 2]) + v[a + 2] * (v[b] * v[c + 1] - v[b + 1] * v[c]);
    const piece = piece_of(corners[i]);
    volumes.set(piece, (volumes.get(piece) ?? 0) + volume);
  }
  return [...volumes.values()].every((volume) => volume > 0);
}
