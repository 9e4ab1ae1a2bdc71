// Mock-up and tool as solids. The tool is a group that moves with the pose; what belongs to its frame is added to it.
import * as three from 'three';
import type { Body, Geometry } from '../server/binary.js';
import type { Theme } from './palette.js';
import type { Pose } from '../server/protocol.js';

function mesh_of(body: Body): three.BufferGeometry {
  const geometry = new three.BufferGeometry();
  geometry.setAttribute('position', new three.BufferAttribute(body.vertices, 3));
  geometry.setIndex(new three.BufferAttribute(body.corners, 1));
  geometry.computeBoundingBox();
  geometry.computeBoundingSphere();
  return geometry;
}

export class Bodies {
  readonly tool = new three.Group();
  readonly mockup_mesh: three.Mesh<three.BufferGeometry, three.MeshLambertMaterial>;
  readonly tool_mesh: three.Mesh<three.BufferGeometry, three.MeshLambertMaterial>;

  constructor(scene: three.Object3D) {
    // Pushed back a little, so that contact triangles, which lie in the same planes, win.
    const material = () => new three.MeshLambertMaterial({ flatShading: true, side: three.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
    this.mockup_mesh = new three.Mesh(new three.BufferGeometry(), material());
    this.tool_mesh = new three.Mesh(new three.BufferGeometry(), material());
    this.tool_mesh.renderOrder = 1;
    this.tool.add(this.tool_mesh);
    this.tool.visible = false;
    scene.add(this.mockup_mesh, this.tool);
    this.glass('tool', true);
  }

  set(geometry: Geometry): void {
    for (const [mesh, body] of [[this.mockup_mesh, geometry.mockup], [this.tool_mesh, geometry.tool]] as const) {
      mesh.geometry.dispose();
      mesh.geometry = mesh_of(body);
    }
    this.tool.visible = true;
  }
  clear(): void {
    this.mockup_mesh.geometry = new three.BufferGeometry();
    this.tool_mesh.geometry = new three.BufferGeometry();
    this.tool.visible = false;
  }
  move(pose: Pose): void {
    this.tool.position.set(pose[0], pose[1], pose[2]);
    this.tool.quaternion.set(pose[3], pose[4], pose[5], pose[6]);
  }
  glass(which: 'mockup' | 'tool', on: boolean): void {
    const material = which === 'tool' ? this.tool_mesh.material : this.mockup_mesh.material;
    material.transparent = on;
    material.opacity = on ? (which === 'tool' ? 0.62 : 0.22) : 1;
    material.depthWrite = !on || which === 'tool';   // a glass tool hides its own far side, or it would look like a net
    material.needsUpdate = true;
  }
  theme(theme: Theme): void {
    this.mockup_mesh.material.color.setHex(theme.mockup);
    this.tool_mesh.material.color.setHex(theme.tool);
  }
  /** The smallest sphere about the tool's box, world frame: a tool may lie far from its file's origin. */
  tool_sphere(): three.Sphere {
    this.tool.updateMatrixWorld();
    return (this.tool_mesh.geometry.boundingSphere ?? new three.Sphere()).clone().applyMatrix4(this.tool.matrixWorld);
  }
}
