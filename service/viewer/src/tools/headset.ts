// The scene in a headset (WebXR), where the browser has one: half a metre before the eyes, and a controller's
// trigger takes the tool.
import * as three from 'three';

import {element, write} from '../dom.js';

import type {SceneView} from '../draw/scene_view.js';
import type {Hand} from '../mouse/hand.js';

const RADIUS = 0.35;                               // of the mock-up as it is seen, m; chosen
const BEFORE = new three.Vector3(0, -0.15, -0.9);  // where its middle is, from the head that begins; chosen

export interface HeadsetHooks {
  /** Where the mock-up is. */
  bounds: () => three.Sphere;
  /** What a hand can hold; null: nothing. */
  hand: () => Hand | null;
  /** Before each picture. */
  frame: (now: number) => void;
  /** The headset is off; the page draws again. */
  ended: () => void;
  failed: (error: unknown) => void;
}

export class Headset {
  private readonly rig = new three.Group();
  private readonly button = element<HTMLButtonElement>('headset');
  private session: XRSession|null = null;
  /** A controller's place, and the tool's, when it was taken. */
  private grip: {hand: three.Object3D; hand_then: three.Matrix4; tool_then: three.Matrix4}|null = null;

  constructor(private readonly view: SceneView, private readonly hooks: HeadsetHooks) {
    const {xr} = navigator;
    if (!xr) return;
    this.button.addEventListener('click', () => void this.toggle(xr).catch(hooks.failed));
    for (const i of [0, 1]) {
      const hand = view.renderer.xr.getController(i);
      const ray = new three.Line(
          new three.BufferGeometry().setFromPoints([new three.Vector3(), new three.Vector3(0, 0, -0.15)]));
      hand.add(ray);
      hand.addEventListener('selectstart', () => this.take(hand));
      hand.addEventListener('selectend', () => {
        if (this.grip?.hand === hand) this.let_go();
      });
      this.rig.add(hand);
    }
    view.scene.add(this.rig);
    this.rig.visible = false;
    void xr.isSessionSupported('immersive-vr').then((on) => {
      element('headset-row').hidden = !on;
    }, hooks.failed);
  }

  private async toggle(xr: XRSystem): Promise<void> {
    if (this.session) {
      await this.session.end();
      return;
    }
    const session = await xr.requestSession('immersive-vr');
    this.session = session;
    const {view, rig} = this;
    const before = {
      position: view.camera.position.clone(),
      quaternion: view.camera.quaternion.clone(),
      near: view.camera.near,
      far: view.camera.far
    };
    session.addEventListener('end', () => {
      this.let_go();
      this.session = null;
      view.renderer.setAnimationLoop(null);
      view.renderer.xr.enabled = false;
      rig.visible = false;
      view.scene.add(view.camera);
      view.camera.position.copy(before.position);
      view.camera.quaternion.copy(before.quaternion);
      Object.assign(view.camera, {near: before.near, far: before.far});
      view.camera.scale.setScalar(1);
      view.camera.updateProjectionMatrix();
      view.presenting = false;
      document.body.classList.remove('in-headset');
      view.resize();
      write(this.button, 'Look with the headset');
      this.hooks.ended();
    });
    // The head is in the rig, which stands so before the mock-up that it looks RADIUS large.
    const {center, radius} = this.hooks.bounds();
    const size = radius / RADIUS;
    rig.scale.setScalar(size);
    rig.quaternion.setFromUnitVectors(new three.Vector3(0, 1, 0), view.camera.up);
    rig.position.copy(center).sub(BEFORE.clone().multiplyScalar(size).applyQuaternion(rig.quaternion));
    rig.visible = true;
    rig.add(view.camera);
    Object.assign(view.camera, {near: 0.02, far: 50});
    view.presenting = true;
    document.body.classList.add('in-headset');
    view.renderer.setPixelRatio(1);
    view.renderer.xr.enabled = true;
    view.renderer.xr.setReferenceSpaceType('local');
    await view.renderer.xr.setSession(session);
    view.renderer.setAnimationLoop((now) => {
      this.move();
      this.hooks.frame(now);
      view.renderer.render(view.scene, view.camera);
    });
    write(this.button, 'Put the headset down');
  }

  private take(hand: three.Object3D): void {
    const taken = this.hooks.hand();
    if (!taken || this.grip) return;
    hand.updateWorldMatrix(true, false);
    taken.held = true;
    this.grip = {
      hand,
      hand_then: hand.matrixWorld.clone(),
      tool_then: new three.Matrix4().compose(taken.position, taken.rotation, new three.Vector3(1, 1, 1))
    };
  }
  /** The target follows the hand as if it were fixed to it. */
  private move(): void {
    const taken = this.hooks.hand();
    if (!this.grip || !taken) return;
    const {hand, hand_then, tool_then} = this.grip;
    hand.updateWorldMatrix(true, false);
    const place = hand.matrixWorld.clone().multiply(hand_then.clone().invert()).multiply(tool_then);
    place.decompose(taken.target_position, taken.target_rotation, new three.Vector3());
  }
  private let_go(): void {
    this.grip = null;
    this.hooks.hand()?.let_go();
  }
}
