// Voxels of one class, as cubes while they are few, else as points. Fetched when they are asked for.
import * as three from 'three';
import type {Voxels} from '../server/binary.js';
import type {Theme} from './palette.js';

const MOST_CUBES = 60_000;

export class VoxelLayer {
  readonly object = new three.Group();
  private colour = new three.Color(0xffffff);

  show(voxels: Voxels): void {
    this.clear();
    const [nx, ny] = voxels.counts;
    const n = voxels.cells.length;
    const centre = (cell: number, out: three.Vector3): three.Vector3 => out.set(
        voxels.origin[0] + voxels.size * ((cell % nx) + 0.5),
        voxels.origin[1] + voxels.size * ((Math.floor(cell / nx) % ny) + 0.5),
        voxels.origin[2] + voxels.size * (Math.floor(cell / (nx * ny)) + 0.5));
    const place = new three.Vector3();
    if (n <= MOST_CUBES) {
      const size = voxels.size * 0.92;
      const cubes = new three.InstancedMesh(
          new three.BoxGeometry(size, size, size),
          new three.MeshLambertMaterial(
              {color: this.colour, transparent: true, opacity: 0.16, depthWrite: false}),
          n);
      const matrix = new three.Matrix4();
      for (let i = 0; i < n; ++i) cubes.setMatrixAt(i, matrix.setPosition(centre(voxels.cells[i], place)));
      cubes.frustumCulled = false;
      cubes.renderOrder = 4;
      this.object.add(cubes);
      return;
    }
    const positions = new Float32Array(3 * n);
    for (let i = 0; i < n; ++i) centre(voxels.cells[i], place).toArray(positions, 3 * i);
    const geometry = new three.BufferGeometry();
    geometry.setAttribute('position', new three.BufferAttribute(positions, 3));
    this.object.add(new three.Points(geometry, new three.PointsMaterial({
      color: this.colour,
      size: voxels.size * 0.6,
      transparent: true,
      opacity: 0.5,
      depthWrite: false
    })));
  }
  clear(): void {
    for (const child of [...this.object.children]) {
      const drawn = child as three.InstancedMesh | three.Points;
      drawn.geometry.dispose();
      (drawn.material as three.Material).dispose();
      this.object.remove(child);
    }
  }
  theme(theme: Theme): void {
    this.colour.setHex(theme.voxel);
    for (const child of this.object.children)
      ((child as three.Points).material as three.PointsMaterial).color.copy(this.colour);
  }
}
