// A gearbox of fifty parts, in millimetres, as text for write_step and as a GLB of its own. A solid: name,
// node above, colour, and a box (corner, sizes) or a cylinder (middle of its end, axis, radius, height,
// bore).
const grey = '#b8bec4';
const steel = '#8d99a6';
const brass = '#d8b25a';

export function gearbox() {
  const solids = [];
  const box = (name, above, colour, at, size) => solids.push({name, above, colour, kind: 'box', at, size});
  const cylinder = (name, above, colour, at, axis, radius, height, bore = 0) =>
      solids.push({name, above, colour, kind: 'cylinder', at, axis, radius, height, bore});
  box('base', 'case', grey, [0, 0, 0], [240, 160, 16]);
  for (const [i, [x, y]] of [[0, 0], [224, 0], [0, 144], [224, 144]].entries())
    box(`post_${i + 1}`, 'case', grey, [x, y, 17], [16, 16, 82]);
  box('wall_front', 'case', grey, [17, 0, 17], [206, 8, 82]);
  box('wall_back', 'case', grey, [17, 152, 17], [206, 8, 82]);
  box('wall_left', 'case', grey, [0, 17, 17], [8, 126, 82]);
  box('wall_right', 'case', grey, [232, 17, 17], [8, 126, 82]);
  for (const [i, x] of [60, 120, 180].entries()) {
    cylinder('shaft', `shaft_${i + 1}`, steel, [x, 14, 56], 'y', 7, 132);
    for (const [k, y] of [30, 104].entries())
      cylinder(`gear_${k + 1}`, `shaft_${i + 1}`, brass, [x, y, 56], 'y', [28, 24, 26][i], 14, 7.5);
    for (const [k, y] of [50, 86].entries())
      cylinder(`spacer_${k + 1}`, `shaft_${i + 1}`, '#5b7f95', [x, y, 56], 'y', 11, 12, 7.5);
  }
  for (let i = 0; i < 10; ++i)
    cylinder(`bolt_${i + 1}`, 'bolts', '#3d464f', [20 + (200 / 9) * i, 4, 114], 'z', 3, 8);
  for (let i = 0; i < 10; ++i)
    cylinder(`bolt_${i + 11}`, 'bolts', '#3d464f', [20 + (200 / 9) * i, 156, 114], 'z', 3, 8);
  box('cover', 'case', '#a9c3d6', [0, 0, 101], [240, 160, 10]);
  cylinder('handle', '', '#c8553d', [120, 80, 118], 'z', 14, 46);
  for (const [i, [x, y]] of [[20, 20], [220, 20], [20, 140], [220, 140]].entries())
    cylinder(`foot_${i + 1}`, 'feet', '#3d464f', [x, y, -11], 'z', 10, 10);
  return solids;
}

/** A line a solid. */
export const as_text = (solids) =>
    solids
        .map(
            ({
              name,
              above,
              colour,
              kind,
              ...rest
            }) => [name, above || '-', colour, kind,
                   ...(kind === 'box' ? [...rest.at, ...rest.size] :
                                        [...rest.at, rest.axis, rest.radius, rest.height, rest.bore])]
                      .join(' '))
        .join('\n') +
    '\n';

const turn = (axis, [u, v, w]) => (axis === 'z' ? [u, v, w] : axis === 'y' ? [v, w, u] : [w, u, v]);
function triangles({kind, at, size, axis, radius, height, bore}) {
  const out = [];
  const quad = (a, b, c, d) => out.push([a, b, c], [a, c, d]);
  if (kind === 'box') {
    const p = (x, y, z) => [at[0] + x * size[0], at[1] + y * size[1], at[2] + z * size[2]];
    quad(p(0, 0, 0), p(0, 1, 0), p(1, 1, 0), p(1, 0, 0));
    quad(p(0, 0, 1), p(1, 0, 1), p(1, 1, 1), p(0, 1, 1));
    quad(p(0, 0, 0), p(1, 0, 0), p(1, 0, 1), p(0, 0, 1));
    quad(p(0, 1, 0), p(0, 1, 1), p(1, 1, 1), p(1, 1, 0));
    quad(p(0, 0, 0), p(0, 0, 1), p(0, 1, 1), p(0, 1, 0));
    quad(p(1, 0, 0), p(1, 1, 0), p(1, 1, 1), p(1, 0, 1));
    return out;
  }
  const sides = 48;
  const p = (r, i, h) => turn(axis, [
                           r * Math.cos((2 * Math.PI * i) / sides), r * Math.sin((2 * Math.PI * i) / sides), h
                         ]).map((value, k) => at[k] + value);
  for (let i = 0; i < sides; ++i) {
    const j = (i + 1) % sides;
    quad(p(radius, i, 0), p(radius, j, 0), p(radius, j, height), p(radius, i, height));
    if (bore > 0) quad(p(bore, j, 0), p(bore, i, 0), p(bore, i, height), p(bore, j, height));
    quad(p(bore, j, 0), p(radius, j, 0), p(radius, i, 0), p(bore, i, 0));
    quad(p(bore, i, height), p(radius, i, height), p(radius, j, height), p(bore, j, height));
  }
  return out.filter(
      ([a, b, c]) => ![[a, b], [b, c], [a, c]].some(
          ([x, y]) => x.every((value, k) => value === y[k])));  // of a full end half a quad is none
}

/** The same as a GLB, in metres. */
export function as_glb(solids) {
  const groups = new Map();
  const nodes = [], meshes = [], accessors = [], views = [], materials = [], pieces = [];
  let bytes = 0;
  const roots = [];
  for (const solid of solids) {
    const flat = new Float32Array(triangles(solid).flat(2).map((value) => value / 1000));
    const index = nodes.length;
    const places = [0, 1, 2].map((k) => flat.filter((_, i) => i % 3 === k));
    accessors.push({
      bufferView: views.length,
      componentType: 5126,
      count: flat.length / 3,
      type: 'VEC3',
      min: places.map((list) => list.reduce((a, b) => Math.min(a, b))),
      max: places.map((list) => list.reduce((a, b) => Math.max(a, b)))
    });
    views.push({buffer: 0, byteOffset: bytes, byteLength: flat.byteLength});
    pieces.push(Buffer.from(flat.buffer));
    bytes += flat.byteLength;
    const linear = [1, 3, 5].map((at) => (parseInt(solid.colour.slice(at, at + 2), 16) / 255) ** 2.2);
    materials.push({pbrMetallicRoughness: {baseColorFactor: [...linear, 1]}});
    meshes.push(
        {primitives: [{attributes: {POSITION: accessors.length - 1}, material: materials.length - 1}]});
    nodes.push({name: solid.name, mesh: meshes.length - 1});
    if (!solid.above) {
      roots.push(index);
      continue;
    }
    if (!groups.has(solid.above)) {
      groups.set(solid.above, nodes.length);
      roots.push(nodes.length);
      nodes.push({name: solid.above, children: []});
    }
    nodes[groups.get(solid.above)].children.push(index);
  }
  let head = JSON.stringify({
    asset: {version: '2.0'},
    buffers: [{byteLength: bytes}],
    bufferViews: views,
    accessors,
    materials,
    meshes,
    nodes,
    scenes: [{nodes: roots}],
    scene: 0
  });
  head += ' '.repeat((4 - (head.length % 4)) % 4);
  const chunk = (kind, body) => {
    const frame = Buffer.alloc(8);
    frame.writeUInt32LE(body.length, 0);
    frame.write(kind, 4, 'latin1');
    return Buffer.concat([frame, body]);
  };
  const body = Buffer.concat([chunk('JSON', Buffer.from(head)), chunk('BIN\0', Buffer.concat(pieces))]);
  const start = Buffer.alloc(12);
  start.write('glTF', 0, 'latin1');
  start.writeUInt32LE(2, 4);
  start.writeUInt32LE(12 + body.length, 8);
  return Buffer.concat([start, body]);
}
