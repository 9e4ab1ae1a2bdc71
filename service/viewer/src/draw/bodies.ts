// Mock-up and tool as solids. The tool is a group that moves with the pose; what belongs to its frame is
// added to it.
import * as three from 'three';
import type {HiddenParts} from '../scene_parts_panel.js';
import type {Body, Geometry} from '../server/binary.js';
import type {Theme} from './palette.js';
import type {NamedPart, Pose, SceneParts} from '../server/protocol.js';
import {flat_material, geometry_of, with_faces} from './flat_shading.js';
import {shown_corners} from './shown_parts.js';
import {is_solid} from './solid_surface.js';

export class Bodies {
  readonly tool = new three.Group();
  readonly mockup_mesh: three.Mesh<three.BufferGeometry, three.MeshLambertMaterial>;
  readonly tool_mesh: three.Mesh<three.BufferGeometry, three.MeshLambertMaterial>;
  private drawn: {mockup: Body; tool: Body}|null = null;
  private few: {body: Body; geometry: three.BufferGeometry}|null = null;  // the tool for coarse pictures
  private whole_tool = new three.BufferGeometry();
  private shape: Body = {
    vertices: new Float32Array(0),
    corners: new Uint32Array(0),
    ids: new Uint32Array(0)
  };  // the tool as it came: each vertex once
  private shape_corners = this.shape.corners;
  private solid = false;  // the tool as it is drawn
  private parts: SceneParts = {static: [], tool: []};
  private hidden: HiddenParts = {mockup: new Set(), tool: new Set()};

  constructor(scene: three.Object3D) {
    // Pushed back a little, so that contact triangles, which lie in the same planes, win.
    const material = () =>
        flat_material({polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1});
    this.mockup_mesh = new three.Mesh(new three.BufferGeometry(), material());
    this.tool_mesh = new three.Mesh(new three.BufferGeometry(), material());
    this.tool_mesh.renderOrder = 1;
    this.tool.add(this.tool_mesh);
    this.tool.visible = false;
    scene.add(this.mockup_mesh, this.tool);
    this.glass('tool', true);
  }

  /** `few`: the tool in fewer triangles, for coarse pictures. */
  set(geometry: Geometry, few: Body|null = null): void {
    this.dispose();
    const faced = (body: Body): {body: Body; geometry: three.BufferGeometry} => {
      const made = with_faces(body.vertices, body.corners);
      return {body: {...body, vertices: made.vertices, corners: made.corners}, geometry: geometry_of(made)};
    };
    this.shape = geometry.tool;
    const mockup = faced(geometry.mockup), tool = faced(geometry.tool);
    this.mockup_mesh.geometry = mockup.geometry;
    this.tool_mesh.geometry = this.whole_tool = tool.geometry;
    this.few = few ? faced(few) : null;
    this.drawn = {mockup: mockup.body, tool: tool.body};
    this.leave_out();
    this.tool.visible = true;
  }
  private dispose(): void {
    for (const geometry of [this.mockup_mesh.geometry, this.whole_tool, this.few?.geometry])
      geometry?.dispose();
  }
  /** Whether the next picture is a coarse one. All else asks the whole tool, so it is back after each. */
  draw_few(on: boolean): void {
    this.tool_mesh.geometry = on && this.few ? this.few.geometry : this.whole_tool;
  }
  /** Of these parts those that are hidden are not drawn; boxes and spheres stay those of the whole. */
  hide(parts: SceneParts, hidden: HiddenParts): void {
    this.parts = parts;
    this.hidden = {mockup: new Set(hidden.mockup), tool: new Set(hidden.tool)};
    this.leave_out();
  }
  private leave_out(): void {
    if (!this.drawn) return;
    const leave_out =
        (geometry: three.BufferGeometry, body: Body, parts: readonly NamedPart[],
         hidden: ReadonlySet<number>) => {
          const corners = shown_corners(body, parts, hidden);
          if (geometry.index?.array !== corners) geometry.setIndex(new three.BufferAttribute(corners, 1));
        };
    leave_out(this.mockup_mesh.geometry, this.drawn.mockup, this.parts.static, this.hidden.mockup);
    leave_out(this.whole_tool, this.drawn.tool, this.parts.tool, this.hidden.tool);
    if (this.few) leave_out(this.few.geometry, this.few.body, this.parts.tool, this.hidden.tool);
    this.shape_corners = shown_corners(this.shape, this.parts.tool, this.hidden.tool);
    this.solid = is_solid(this.shape.vertices, this.shape_corners);
  }
  /** The tool's triangles that are drawn, in its frame; each vertex once. */
  shape_of_tool(): {vertices: Float32Array; corners: Uint32Array} {
    return {vertices: this.shape.vertices, corners: this.shape_corners};
  }
  clear(): void {
    this.dispose();
    this.drawn = this.few = null;
    this.hidden = {mockup: new Set(), tool: new Set()};
    this.mockup_mesh.geometry = new three.BufferGeometry();
    this.tool_mesh.geometry = this.whole_tool = new three.BufferGeometry();
    this.tool.visible = false;
  }
  move(pose: Pose): void {
    this.tool.position.set(pose[0], pose[1], pose[2]);
    this.tool.quaternion.set(pose[3], pose[4], pose[5], pose[6]);
  }
  glass(which: 'mockup'|'tool', on: boolean): void {
    const material = which === 'tool' ? this.tool_mesh.material : this.mockup_mesh.material;
    material.transparent = on;
    material.opacity = on ? (which === 'tool' ? 0.62 : 0.22) : 1;
    material.depthWrite =
        !on || which === 'tool';  // a glass tool hides its own far side, or it would look like a net
    material.needsUpdate = true;
  }
  /**
   * Whether a tool of glass shows its far side, too, which takes as long again. One that is no solid always
   * does.
   */
  show_far_side(on: boolean): void {
    const {material} = this.tool_mesh;
    const side = on || !this.solid ? three.DoubleSide : three.FrontSide;
    if (material.side === side) return;
    material.side = side;
    material.needsUpdate = true;
  }
  theme(theme: Theme): void {
    this.mockup_mesh.material.color.setHex(theme.mockup);
    this.tool_mesh.material.color.setHex(theme.tool);
  }
  /** The smallest sphere about the tool's box, world frame: a tool may lie far from its file's origin. */
  tool_sphere(): three.Sphere {
    this.tool.updateMatrixWorld();
    return (this.tool_mesh.geometry.boundingSphere ?? new three.Sphere())
        .clone()
        .applyMatrix4(this.tool.matrixWorld);
  }
}
