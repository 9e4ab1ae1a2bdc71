// Where the hand is while contact holds the tool back: the tool's edges there, and a line to it. Its length
// is the resistance.
import * as three from 'three';
import type {Bodies} from '../draw/bodies.js';
import type {Hand} from './hand.js';
import type {Theme} from '../draw/palette.js';
import {sharp_edges} from '../draw/sharp_edges.js';

const MOST_EDGES = 1500;  // chosen: more are a blot, and lines are slow where there is no GPU

export class Ghost {
  readonly object = new three.Group();
  private readonly shell: three.LineSegments<three.BufferGeometry, three.LineBasicMaterial>;
  private edges_of: unknown = null;
  private readonly line: three.Line<three.BufferGeometry, three.LineDashedMaterial>;

  constructor(private readonly bodies: Bodies) {
    this.shell = new three.LineSegments(
        new three.BufferGeometry(),
        new three.LineBasicMaterial({transparent: true, opacity: 0.25, depthWrite: false}));
    this.line = new three.Line(
        new three.BufferGeometry().setFromPoints([new three.Vector3(), new three.Vector3()]),
        new three.LineDashedMaterial({depthTest: false, transparent: true}));
    this.shell.frustumCulled = this.line.frustumCulled = false;
    this.object.add(this.shell, this.line);
    this.object.visible = false;
  }
  theme(theme: Theme): void {
    this.shell.material.color.setHex(theme.ghost);
    this.line.material.color.setHex(theme.ghost);
  }
  set(hand: Hand|null, holding: boolean): void {
    this.object.visible = false;
    if (!hand || !holding) return;
    const from = hand.gc();
    const to = hand.gc(hand.target_position, hand.target_rotation);
    const apart =
        from.distanceTo(to) > hand.radius * 0.02 || hand.rotation.angleTo(hand.target_rotation) > 0.03;
    if (!apart) return;
    this.object.visible = true;
    const {vertices, corners} = this.bodies.shape_of_tool();
    if (this.edges_of !== corners) {
      this.edges_of = corners;
      this.shell.geometry.dispose();
      this.shell.geometry = new three.BufferGeometry();
      this.shell.geometry.setAttribute('position', new three.BufferAttribute(vertices, 3));
      this.shell.geometry.setIndex(new three.BufferAttribute(sharp_edges(vertices, corners, MOST_EDGES), 1));
    }
    this.shell.position.copy(hand.target_position);
    this.shell.quaternion.copy(hand.target_rotation);
    this.line.geometry.setFromPoints([from, to]);
    this.line.material.dashSize = this.line.material.gapSize = hand.radius * 0.06;
    this.line.computeLineDistances();
  }
}
