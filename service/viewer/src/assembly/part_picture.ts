// All parts of an assembly as one mesh: one draw call however many they are. What each looks like, whether it
// is shown and whether it moves with the tool is a texel a part.
import * as three from 'three';

import {flat_material, geometry_of, with_faces} from '../draw/flat_shading.js';

import type {Geometry} from '../server/binary.js';
import type {AssemblyPart} from '../server/protocol.js';

const WIDTH = 256;  // texels of a row
const HIDDEN = 0;
const SHOWN = 1;
const WITH_TOOL = 8;

export interface Look {
  colour: three.Color;
  hidden: boolean;
  with_tool: boolean
}
interface Run {
  first: number;
  count: number;
  box: three.Box3;
  with_tool: boolean;
  hidden: boolean
}

export class PartPicture {
  readonly object = new three.Group();
  /** World from the tool's file. */
  readonly tool_matrix = new three.Matrix4();
  drawn_triangles = 0;
  private readonly mesh: three.Mesh<three.BufferGeometry, three.MeshLambertMaterial>;
  private readonly states = {
    value: new three.DataTexture(new Float32Array(4 * WIDTH), WIDTH, 1, three.RGBAFormat, three.FloatType)
  };
  private runs: Run[] = [];
  private positions = new Float32Array(0);
  private corners = new Uint32Array(0);

  constructor() {
    const material = flat_material({}, (shader) => {
      shader.uniforms['parts'] = this.states;
      shader.uniforms['tool_matrix'] = {value: this.tool_matrix};
      shader.vertexShader =
          shader.vertexShader
              .replace(
                  '#include <common>',
                  '#include <common>\nattribute float part;\nuniform highp sampler2D parts;\nuniform mat4 tool_matrix;')
              .replace('#include <begin_vertex>', `#include <begin_vertex>
          int place = int(part + 0.5);
          vec4 look = texelFetch(parts, ivec2(place % ${WIDTH}, place / ${WIDTH}), 0);
          colour = look.rgb;
          bool with_tool = look.a >= ${WITH_TOOL}.0;
          if (with_tool) transformed = (tool_matrix * vec4(transformed, 1.0)).xyz;`)
              .replace('normalMatrix * face', 'normalMatrix * (with_tool ? mat3(tool_matrix) * face : face)')
              .replace(
                  '#include <project_vertex>',
                  `#include <project_vertex>
          if (look.a == ${HIDDEN}.0 || look.a == ${
                      WITH_TOOL}.0) gl_Position = vec4(0.0, 0.0, 2.0, 1.0);   // beyond the far plane, as a whole triangle`);
    });
    this.mesh = new three.Mesh(new three.BufferGeometry(), material);
    this.mesh.frustumCulled = false;  // the shader moves some of it
    this.object.add(this.mesh);
  }

  /**
   * `scale`: metres per file unit of a file. Vertices that parts share, as reduced meshes have them, are
   * given to each.
   */
  load(geometry: Geometry, parts: readonly AssemblyPart[], scale: (file: number) => number): void {
    const {vertices, corners, ids} = geometry.mockup;
    const shared = new Uint32Array(vertices.length / 3);
    const owner = new Int32Array(vertices.length / 3).fill(-1);
    let source = new Uint32Array(Math.max(1024, vertices.length / 3));
    let owners = new Float32Array(source.length);
    let count = 0;
    const out = new Uint32Array(corners.length);
    this.runs =
        parts.map(() => ({first: 0, count: 0, box: new three.Box3(), with_tool: false, hidden: false}));
    let part = 0;
    for (let t = 0; t < ids.length; ++t) {
      while (part + 1 < parts.length && ids[t] >= parts[part + 1].first_triangle) ++part;
      const run = this.runs[part];
      if (run.count++ === 0) run.first = t;
      for (let k = 0; k < 3; ++k) {
        const vertex = corners[3 * t + k];
        if (owner[vertex] !== part) {
          if (count === source.length) {
            const [more, more_owners] = [new Uint32Array(2 * count), new Float32Array(2 * count)];
            more.set(source);
            more_owners.set(owners);
            [source, owners] = [more, more_owners];
          }
          owner[vertex] = part;
          shared[vertex] = count;
          source[count] = vertex;
          owners[count++] = part;
        }
        out[3 * t + k] = shared[vertex];
      }
    }
    const positions = new Float32Array(3 * count);
    for (let i = 0; i < count; ++i) {
      const factor = scale(parts[owners[i]].file);
      for (let axis = 0; axis < 3; ++axis) positions[3 * i + axis] = vertices[3 * source[i] + axis] * factor;
    }
    const made = with_faces(positions, out);
    const owned = new Float32Array(count + made.copied.length);
    owned.set(owners.subarray(0, count));
    made.copied.forEach((vertex, i) => {
      owned[count + i] = owners[vertex];
    });
    this.positions = made.vertices;
    this.corners = made.corners;
    this.drawn_triangles = ids.length;
    const corner = new three.Vector3();
    for (const run of this.runs)
      for (let i = 3 * run.first; i < 3 * (run.first + run.count); ++i)
        run.box.expandByPoint(corner.fromArray(made.vertices, 3 * made.corners[i]));
    this.mesh.geometry.dispose();
    this.mesh.geometry = geometry_of(made);
    this.mesh.geometry.setAttribute('part', new three.BufferAttribute(owned, 1));
    this.states.value.dispose();
    const rows = Math.max(1, Math.ceil(parts.length / WIDTH));
    this.states.value = new three.DataTexture(
        new Float32Array(4 * WIDTH * rows), WIDTH, rows, three.RGBAFormat, three.FloatType);
  }

  /** What each part looks like. */
  show(looks: readonly Look[]): void {
    const data = this.states.value.image.data as unknown as Float32Array;
    looks.forEach(({colour, hidden, with_tool}, i) => {
      data.set(
          [colour.r, colour.g, colour.b, (hidden ? HIDDEN : SHOWN) + (with_tool ? WITH_TOOL : 0)], 4 * i);
      Object.assign(this.runs[i] ?? {}, {hidden, with_tool});
    });
    this.states.value.needsUpdate = true;
  }

  /** What the picture hangs on beside the mesh. */
  changes(): unknown[] {
    return [this.states.value, this.states.value.version, ...this.tool_matrix.elements];
  }

  /** Box of some parts, m; where they are shown, the tool moved. */
  box(parts: readonly number[], moved = true): three.Box3 {
    const all = new three.Box3();
    for (const i of parts) {
      const run = this.runs[i];
      if (!run || run.box.isEmpty()) continue;
      all.union(run.with_tool && moved ? run.box.clone().applyMatrix4(this.tool_matrix) : run.box);
    }
    return all;
  }

  /** The part that a ray meets first, and where; null for none. */
  pick(ray: three.Ray): {part: number; point: three.Vector3}|null {
    const back = this.tool_matrix.clone().invert();
    const at_home = ray.clone().applyMatrix4(back);
    const entry = new three.Vector3();
    const near = this.runs
                     .map((run, i) => {
                       const own = run.with_tool ? at_home : ray;
                       const hit = run.hidden || run.count === 0 ? null : own.intersectBox(run.box, entry);
                       return {
                         i,
                         distance: hit ? hit.distanceTo(own.origin) : Infinity,
                         inside: hit !== null && run.box.containsPoint(own.origin)
                       };
                     })
                     .filter(({distance}) => distance < Infinity)
                     .sort((a, b) => (a.inside ? 0 : a.distance) - (b.inside ? 0 : b.distance));
    let best = -1;
    let nearest = Infinity;
    const [a, b, c, hit] =
        [new three.Vector3(), new three.Vector3(), new three.Vector3(), new three.Vector3()];
    for (const {i, distance, inside} of near) {
      if (!inside && distance > nearest) break;
      const run = this.runs[i];
      const own = run.with_tool ? at_home : ray;
      for (let t = run.first; t < run.first + run.count; ++t) {
        a.fromArray(this.positions, 3 * this.corners[3 * t]);
        b.fromArray(this.positions, 3 * this.corners[3 * t + 1]);
        c.fromArray(this.positions, 3 * this.corners[3 * t + 2]);
        if (!own.intersectTriangle(a, b, c, false, hit)) continue;
        const way = hit.distanceTo(own.origin);
        if (way < nearest) {
          nearest = way;
          best = i;
        }
      }
    }
    return best < 0 ? null : {part: best, point: ray.at(nearest, new three.Vector3())};
  }
  clear(): void {
    this.runs = [];
    this.mesh.geometry.dispose();
    this.mesh.geometry = new three.BufferGeometry();
  }
}
