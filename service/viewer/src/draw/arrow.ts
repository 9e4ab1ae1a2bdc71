// An arrow that is a solid, so that it reads at any distance and any line width.
import * as three from 'three';

const SHAFT = new three.CylinderGeometry(1, 1, 1, 8).translate(0, 0.5, 0);
const HEAD = new three.ConeGeometry(2.6, 1, 12).translate(0, -0.5, 0);
const UP = new three.Vector3(0, 1, 0);

export class Arrow {
  readonly object = new three.Group();
  readonly material: three.MeshBasicMaterial;
  private readonly shaft: three.Mesh;
  private readonly head: three.Mesh;

  constructor(colour: number) {
    this.material =
        new three.MeshBasicMaterial({color: colour, toneMapped: false, depthTest: false, transparent: true});
    this.shaft = new three.Mesh(SHAFT, this.material);
    this.head = new three.Mesh(HEAD, this.material);
    this.shaft.renderOrder = this.head.renderOrder = 10;
    this.object.add(this.shaft, this.head);
    this.object.visible = false;
  }
  /**
   * `direction` is a unit vector; `length` and `width` in metres. A short arrow is thinner, so that it still
   * shows where it points.
   */
  set(from: three.Vector3, direction: three.Vector3, length: number, width: number): void {
    this.object.visible = length > width * 0.05;
    if (!this.object.visible) return;
    const thick = width * Math.min(1, Math.max(0.3, length / (width * 14)));
    const head = Math.min(thick * 7, length * 0.6);
    this.object.position.copy(from);
    this.object.quaternion.setFromUnitVectors(UP, direction);
    this.shaft.scale.set(thick, length - head, thick);
    this.head.scale.set(thick, head, thick);
    this.head.position.y = length;
  }
  hide(): void {
    this.object.visible = false;
  }
}
