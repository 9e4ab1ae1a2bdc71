// Moves and turns the tool before there is a scene: three's handles about the tool's middle, and six numbers.
import * as three from 'three';
import {TransformControls} from 'three/examples/jsm/controls/TransformControls.js';
import type {SceneView} from '../draw/scene_view.js';
import type {Pose} from '../server/protocol.js';

const FIELDS = ['x', 'y', 'z', 'rx', 'ry', 'rz'] as const;

/** Pose as position of the middle from where it was, mm, and turns about x, y, z, degrees; and back. */
export function numbers_of(place: Pose, middle: three.Vector3): number[] {
  const rotation = new three.Quaternion(place[3], place[4], place[5], place[6]);
  const moved = middle.clone()
                    .applyQuaternion(rotation)
                    .add(new three.Vector3(place[0], place[1], place[2]))
                    .sub(middle);
  const turn = new three.Euler().setFromQuaternion(rotation, 'XYZ');
  return [
    ...moved.toArray().map((value) => value * 1000), ...[turn.x, turn.y, turn.z].map(three.MathUtils.radToDeg)
  ];
}
export function place_of(numbers: readonly number[], middle: three.Vector3): Pose {
  const [rx, ry, rz] = numbers.slice(3).map(three.MathUtils.degToRad);
  const rotation = new three.Quaternion().setFromEuler(new three.Euler(rx, ry, rz, 'XYZ'));
  const position = middle.clone()
                       .add(new three.Vector3(numbers[0], numbers[1], numbers[2]).multiplyScalar(1e-3))
                       .sub(middle.clone().applyQuaternion(rotation));
  return [position.x, position.y, position.z, rotation.x, rotation.y, rotation.z, rotation.w];
}

export class Gizmo {
  private readonly pivot = new three.Object3D();
  private readonly controls: TransformControls;
  private middle = new three.Vector3();

  /** `moved`: while it is dragged; `done`: when it is let go. */
  constructor(
      private readonly view: SceneView, private readonly fields: HTMLInputElement[],
      moved: (place: Pose) => void, done: (place: Pose) => void) {
    this.controls = new TransformControls(view.camera, view.canvas);
    this.controls.setSize(0.9);
    view.scene.add(this.pivot, this.controls.getHelper());
    this.controls.addEventListener('dragging-changed', (event) => {
      view.controls.enabled = !event.value;
      if (!event.value) done(this.place());
    });
    this.controls.addEventListener('objectChange', () => {
      moved(this.place());
      this.write();
      view.request();
    });
    this.controls.addEventListener('change', () => view.request());
    for (const field of fields)
      field.addEventListener('change', () => {
        const numbers = fields.map((input) => input.valueAsNumber);
        if (numbers.every(Number.isFinite))
          done(place_of(numbers, this.middle));
        else
          this.write();
      });
    this.hide();
  }
  /** Whether a press would take a handle. */
  get grips(): boolean {
    return this.controls.axis !== null;
  }
  set turning(on: boolean) {
    this.controls.setMode(on ? 'rotate' : 'translate');
    this.view.request();
  }
  show(place: Pose, middle: three.Vector3): void {
    this.middle = middle.clone();
    const rotation = new three.Quaternion(place[3], place[4], place[5], place[6]);
    this.pivot.quaternion.copy(rotation);
    this.pivot.position.copy(middle).applyQuaternion(rotation).add(
        new three.Vector3(place[0], place[1], place[2]));
    this.controls.attach(this.pivot);
    this.controls.enabled = true;
    this.write();
    this.view.request();
  }
  hide(): void {
    this.controls.detach();
    this.controls.enabled = false;
    this.view.request();
  }
  private place(): Pose {
    const {position, quaternion: q} = this.pivot;
    const at = position.clone().sub(this.middle.clone().applyQuaternion(q));
    return [at.x, at.y, at.z, q.x, q.y, q.z, q.w];
  }
  private write(): void {
    const numbers = numbers_of(this.place(), this.middle);
    FIELDS.forEach((_, i) => {
      this.fields[i].value = String(Number(numbers[i].toFixed(3)) + 0);
    });
  }
}
