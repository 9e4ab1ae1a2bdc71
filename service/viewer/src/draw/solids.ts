// Small solids of plain colours, drawn over all else, in the order in which they are added. All are one mesh:
// where there is no GPU, drawing each by itself costs more than its triangles do.
import * as three from 'three';

const UP = new three.Vector3(0, 1, 0);
const ONCE = new three.Vector3(1, 1, 1);

export class Solids {
  readonly object: three.Mesh<three.BufferGeometry, three.MeshBasicMaterial>;
  private positions = new Float32Array(0);
  private colours = new Float32Array(0);  // four a vertex
  private index = new Uint32Array(0);
  private vertices = 0;
  private corners = 0;
  private readonly at = new three.Vector3();

  constructor() {
    this.object = new three.Mesh(
        new three.BufferGeometry(),
        new three.MeshBasicMaterial(
            {vertexColors: true, toneMapped: false, depthTest: false, transparent: true}));
    this.object.frustumCulled = false;
    this.object.renderOrder = 10;
    this.object.visible = false;
  }

  begin(): void {
    this.vertices = this.corners = 0;
  }
  /** A solid with an index, at a place and in a size. */
  add(shape: three.BufferGeometry, place: three.Matrix4, colour: three.Color, opacity = 1): void {
    const points = shape.getAttribute('position'), corners = shape.index!;
    this.make_room(this.vertices + points.count, this.corners + corners.count);
    for (let i = 0; i < corners.count; ++i) this.index[this.corners++] = this.vertices + corners.getX(i);
    for (let i = 0; i < points.count; ++i, ++this.vertices) {
      this.at.fromBufferAttribute(points, i).applyMatrix4(place).toArray(this.positions, 3 * this.vertices);
      this.colours.set([colour.r, colour.g, colour.b, opacity], 4 * this.vertices);
    }
  }
  /** Shows what was added since begin(). */
  end(): void {
    const {geometry} = this.object;
    this.object.visible = this.corners > 0;
    geometry.setDrawRange(0, this.corners);
    for (const [attribute, count] of [
             [geometry.getAttribute('position'), 3 * this.vertices],
             [geometry.getAttribute('color'), 4 * this.vertices], [geometry.index, this.corners]] as const) {
      if (!(attribute instanceof three.BufferAttribute)) continue;  // nothing was ever added
      attribute.clearUpdateRanges();
      attribute.addUpdateRange(0, count);
      attribute.needsUpdate = true;
    }
  }

  private make_room(vertices: number, corners: number): void {
    if (3 * vertices <= this.positions.length && corners <= this.index.length) return;
    const more = <T extends Float32Array|Uint32Array>(old: T, made: T): T => {
      made.set(old as never);
      return made;
    };
    this.positions = more(this.positions, new Float32Array(6 * vertices));
    this.colours = more(this.colours, new Float32Array(8 * vertices));
    this.index = more(this.index, new Uint32Array(2 * corners));
    this.object.geometry.dispose();
    const geometry = (this.object.geometry = new three.BufferGeometry());
    const own = (array: Float32Array|Uint32Array, size: number) =>
        new three.BufferAttribute(array, size).setUsage(three.DynamicDrawUsage);
    geometry.setAttribute('position', own(this.positions, 3));
    geometry.setAttribute('color', own(this.colours, 4));
    geometry.setIndex(own(this.index, 1));
  }
}

/** A place for a shape whose own axis is y: `at`, y along `axis` (a unit vector), scaled along x, y and z. */
export function placed(at: three.Vector3, axis = UP, scale: three.Vector3 = ONCE): three.Matrix4 {
  return new three.Matrix4().compose(at, new three.Quaternion().setFromUnitVectors(UP, axis), scale);
}
