// How far the free tool is from the mock-up: a line between the nearest two points, its length, and whose
// they are. The server measures; one question at a time.
import * as three from 'three';

import {length_words} from '../assembly/units.js';
import {element, write} from '../dom.js';
import {clearance_words} from '../words/clearance_words.js';

import type {Api} from '../server/api.js';
import type {ClearanceAnswer, Pose} from '../server/protocol.js';
import type {SceneView} from '../draw/scene_view.js';
import type {Theme} from '../draw/palette.js';

const PAUSE_MS = 60;  // between an answer and the next question, for what else the server has to do; chosen

export class ClearanceLine {
  readonly object: three.Line<three.BufferGeometry, three.LineBasicMaterial>;
  private readonly label = element('clearance-label');
  private readonly words = element('clearance-words');
  private on = false;
  private asked = '';  // the pose of the last question, as text
  private busy = false;
  private answer: ClearanceAnswer|null = null;
  private turn = 0;

  /** `arrived`: there is an answer, and the picture another. */
  constructor(
      private readonly api: Api, private readonly view: SceneView, private readonly arrived: () => void,
      private readonly failed: (error: unknown) => void) {
    this.object = new three.Line(
        new three.BufferGeometry(), new three.LineBasicMaterial({depthTest: false, transparent: true}));
    this.object.renderOrder = 11;
    this.object.frustumCulled = false;
    this.show();
    view.before_draw.push(() => this.place());
  }
  theme(theme: Theme): void {
    this.object.material.color.setHex(theme.force);
  }
  set_on(on: boolean): void {
    this.on = on;
    this.forget();
  }
  /** Another scene, or none: what was measured holds no longer. */
  forget(): void {
    ++this.turn;
    this.asked = '';
    this.busy = false;
    this.answer = null;
    this.show();
  }
  /** The tool is at `pose` of `scene`; in contact there is nothing to measure. */
  want(scene: string, pose: Pose, contact: boolean): void {
    if (!this.on) return;
    if (contact) {
      if (this.answer || this.busy) this.forget();
      return;
    }  // an answer that is still under way is of where it was
    const text = pose.join();
    if (this.busy || text === this.asked) return;
    this.busy = true;
    this.asked = text;
    const {turn} = this;
    void this.api.clearance(scene, pose)
        .then(
            (answer) => {
              if (turn !== this.turn) return;
              this.answer = answer;
              this.show();
              this.arrived();
            },
            (error: unknown) => {
              if (turn === this.turn) {
                this.answer = null;
                this.show();
                this.failed(error);
              }
            })
        .then(() => new Promise((resolve) => setTimeout(resolve, PAUSE_MS)))
        .finally(() => {
          if (turn === this.turn) {
            this.busy = false;
            this.arrived();
          }
        });
  }
  private show(): void {
    const {answer} = this;
    write(this.words, answer ? clearance_words(answer) : '');
    const ends = answer?.on_static && answer.on_mobile ?
        [new three.Vector3(...answer.on_static), new three.Vector3(...answer.on_mobile)] :
        null;
    this.object.visible = ends !== null;
    if (ends) this.object.geometry.setFromPoints(ends);
    this.view.request();
  }
  private place(): void {
    const {answer} = this;
    const middle = answer?.on_static && answer.on_mobile ? new three.Vector3(...answer.on_static)
                                                               .add(new three.Vector3(...answer.on_mobile))
                                                               .multiplyScalar(0.5) :
                                                           null;
    const at = middle && this.view.project(middle);
    this.label.hidden = !at || document.body.classList.contains('building');
    if (!at || !answer || answer.clearance === null) return;
    write(this.label, length_words(answer.clearance));
    this.label.style.transform = `translate(${Math.round(at.x + 8)}px, ${Math.round(at.y + 8)}px)`;
  }
}
