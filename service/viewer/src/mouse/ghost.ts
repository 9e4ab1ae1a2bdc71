// Where the hand is while contact holds the tool back: the tool's outline there, and a line to it. Its length is the resistance.
import * as three from 'three';
import type { Bodies } from '../draw/bodies.js';
import type { Coupling } from './coupling.js';
import type { Theme } from '../draw/palette.js';

const MOST_CORNERS = 150_000;   // an outline of more lines is a blot

export class Ghost {
  readonly object = new three.Group();
  private readonly shell: three.Mesh<three.BufferGeometry, three.MeshBasicMaterial>;
  private readonly line: three.Line<three.BufferGeometry, three.LineDashedMaterial>;

  constructor(private readonly bodies: Bodies) {
    this.shell = new three.Mesh(new three.BufferGeometry(), new three.MeshBasicMaterial({ wireframe: true, transparent: true, opacity: 0.12, depthWrite: false }));
    this.line = new three.Line(new three.BufferGeometry().setFromPoints([new three.Vector3(), new three.Vector3()]), new three.LineDashedMaterial({ depthTest: false, transparent: true }));
    this.shell.frustumCulled = this.line.frustumCulled = false;
    this.object.add(this.shell, this.line);
    this.object.visible = false;
  }
  theme(theme: Theme): void {
    this.shell.material.color.setHex(theme.ghost);
    this.line.material.color.setHex(theme.ghost);
  }
  set(coupling: Coupling | null, holding: boolean): void {
    this.object.visible = false;
    if (!coupling || !holding) return;
    const from = coupling.gc();
    const to = coupling.gc(coupling.target_position, coupling.target_rotation);
    const apart = from.distanceTo(to) > coupling.radius * 0.02 || coupling.rotation.angleTo(coupling.target_rotation) > 0.03;
    if (!apart) return;
    this.object.visible = true;
    this.shell.geometry = this.bodies.tool_mesh.geometry;
    this.shell.visible = (this.shell.geometry.index?.count ?? 0) < MOST_CORNERS;
    this.shell.position.copy(coupling.target_position);
    this.shell.quaternion.copy(coupling.target_rotation);
    this.line.geometry.setFromPoints([from, to]);
    this.line.material.dashSize = this.line.material.gapSize = coupling.radius * 0.06;
    this.line.computeLineDistances();
  }
}
