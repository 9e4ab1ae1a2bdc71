// Takes hold of the tool in the picture: drag moves it in the plane of the screen, the wheel nearer or
// farther, right button or Shift turns it.
import * as three from 'three';
import type {Bodies} from '../draw/bodies.js';
import type {Hand} from './hand.js';
import type {SceneView} from '../draw/scene_view.js';

const GRAB_PX = 10;  // how far beside the tool a press still takes it

const RADII_A_SECOND = 0.8, RADIANS_A_SECOND = 1.2;  // of a cap that is pushed as far as it goes; chosen
const NUDGE_MS = 400;                                // chosen: a key that repeats keeps the hand closed

export type Drag = 'move'|'turn'|'depth';

export class MouseDrag {
  /** The hand that is moved; null while the mouse is no device. */
  hand: Hand|null = null;
  holding: Drag|null = null;
  /** What a plain drag does: fingers have no other keys. */
  plain: Drag = 'move';
  private readonly plane = new three.Plane();
  private readonly last = new three.Vector3();
  private readonly ray = new three.Raycaster();
  private pointer = new three.Vector2();

  constructor(private readonly view: SceneView, private readonly bodies: Bodies) {
    const canvas = view.canvas;
    // Before the camera's controls see it.
    canvas.addEventListener('pointerdown', (event) => this.press(event), {capture: true});
    canvas.addEventListener('pointermove', (event) => this.move(event));
    for (const name of ['pointerup', 'pointercancel'] as const)
      canvas.addEventListener(name, () => this.release());
    canvas.addEventListener('wheel', (event) => this.wheel(event), {capture: true, passive: false});
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  }

  private aim(event: MouseEvent, dx = 0, dy = 0): void {
    const box = this.view.canvas.getBoundingClientRect();
    this.pointer.set(
        ((event.clientX + dx - box.left) / box.width) * 2 - 1,
        1 - ((event.clientY + dy - box.top) / box.height) * 2);
    this.ray.setFromCamera(this.pointer, this.view.camera);
  }
  private hit(event: MouseEvent): three.Vector3|null {
    if (!this.bodies.tool.visible) return null;
    this.bodies.tool.updateWorldMatrix(true, true);
    for (const [dx, dy] of [[0, 0], [GRAB_PX, 0], [-GRAB_PX, 0], [0, GRAB_PX], [0, -GRAB_PX]]) {
      this.aim(event, dx, dy);
      const hits = this.ray.intersectObject(this.bodies.tool_mesh, false);
      if (hits.length > 0) return hits[0].point;
    }
    return null;
  }

  private press(event: PointerEvent): void {
    if (!this.hand || this.holding || event.button === 1) return;
    const point = this.hit(event);
    if (!point) return;
    event.stopImmediatePropagation();
    this.view.canvas.setPointerCapture(event.pointerId);
    this.hand.held = true;
    this.holding = event.button === 2 || event.shiftKey || event.ctrlKey ? 'turn' : this.plain;
    this.plane.setFromNormalAndCoplanarPoint(this.view.camera.getWorldDirection(new three.Vector3()), point);
    this.last.copy(point);
    document.body.classList.add('holding');
  }
  private move(event: PointerEvent): void {
    if (!this.hand) return;
    if (!this.holding) {
      if (event.buttons === 0) this.view.canvas.style.cursor = this.hit(event) ? 'grab' : '';
      return;
    }
    if (this.holding === 'move') {
      this.aim(event);
      const point = this.ray.ray.intersectPlane(this.plane, new three.Vector3());
      if (!point) return;
      this.hand.target_position.add(point.clone().sub(this.last));
      this.last.copy(point);
    } else if (this.holding === 'depth') {
      this.deepen(-event.movementY * this.hand.radius * 0.01);
    } else {
      const turn = new three.Quaternion();
      const camera = this.view.camera.quaternion;
      for (const [axis, angle] of [
               [new three.Vector3(0, 1, 0), event.movementX],
               [new three.Vector3(1, 0, 0), event.movementY]] as const) {
        turn.premultiply(
            new three.Quaternion().setFromAxisAngle(axis.clone().applyQuaternion(camera), angle * 0.008));
      }
      this.turn(turn);
    }
    this.view.request();
  }
  /** Turns the target about the centre of mass. */
  turn(by: three.Quaternion): void {
    const {hand} = this;
    if (!hand) return;
    const centre = hand.gc(hand.target_position, hand.target_rotation);
    hand.target_rotation.premultiply(by).normalize();
    const moved = hand.gc(hand.target_position, hand.target_rotation);
    hand.target_position.add(centre.sub(moved));
  }
  /**
   * A small step by the keyboard: right, up and away as the camera sees it; or turns about these. The hand
   * lets go a moment later.
   */
  nudge(right: number, up: number, away: number, turning: boolean): void {
    const {hand} = this;
    if (!hand || this.holding) return;
    hand.held = true;
    const way = new three.Vector3(right, up, -away).applyQuaternion(this.view.camera.quaternion);
    if (turning)
      this.turn(new three.Quaternion().setFromAxisAngle(
          new three.Vector3(-up, right, -away).applyQuaternion(this.view.camera.quaternion), 0.02));
    else
      hand.target_position.addScaledVector(way, hand.radius * 0.02);
    this.let_go_later();
    this.view.request();
  }
  /**
   * A cap that is pushed moves the hand on for `seconds`: right, up, away and turns about these, −1 … 1
   * each. Returns whether it is pushed.
   */
  steer(wish: readonly number[], seconds: number): boolean {
    const {hand} = this;
    if (!hand || this.holding || wish.every((value) => value === 0)) return false;
    hand.held = true;
    const camera = this.view.camera.quaternion;
    const seen = (first: number) =>
        new three.Vector3(wish[first], wish[first + 1], -wish[first + 2]).applyQuaternion(camera);
    hand.target_position.addScaledVector(seen(0), hand.radius * RADII_A_SECOND * seconds);
    const turn = seen(3);
    const angle = turn.length();
    if (angle > 0)
      this.turn(new three.Quaternion().setFromAxisAngle(
          turn.divideScalar(angle), angle * RADIANS_A_SECOND * seconds));
    this.let_go_later();
    this.view.request();
    return true;
  }
  private let_go_later(): void {
    clearTimeout(this.nudged);
    this.nudged = window.setTimeout(() => {
      if (!this.holding) this.hand?.let_go();
    }, NUDGE_MS);
  }
  private nudged = 0;
  private release(): void {
    if (!this.holding) return;
    this.holding = null;
    this.hand?.let_go();  // an open hand presses on nothing
    document.body.classList.remove('holding');
    this.view.request();
  }
  private wheel(event: WheelEvent): void {
    if (!this.hand || !this.holding) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    this.deepen(-Math.sign(event.deltaY) * this.hand.radius * 0.08);
  }
  /** Moves what is held away from the eye, m. */
  private deepen(metres: number): void {
    const away = this.view.camera.getWorldDirection(new three.Vector3()).multiplyScalar(metres);
    this.hand?.target_position.add(away);
    this.plane.translate(away);
    this.last.add(away);
  }
}
