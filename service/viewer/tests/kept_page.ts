// The page of kept.mjs: a picture of bodies with contact, cut, glass and parts, drawn both ways.
import * as three from 'three';
import type {Api} from '../src/server/api.js';
import type {Body} from '../src/server/binary.js';
import type {Frame} from '../src/server/protocol.js';
import {Bodies} from '../src/draw/bodies.js';
import {ContactLayer} from '../src/draw/contact_layer.js';
import {DARK, LIGHT} from '../src/draw/palette.js';
import {SceneView} from '../src/draw/scene_view.js';
import {TriangleStore} from '../src/draw/triangle_store.js';
import {PartPicture} from '../src/assembly/part_picture.js';

function body_of(geometry: three.BufferGeometry): Body {
  const corners = Uint32Array.from(geometry.index!.array);
  return {
    vertices: Float32Array.from(geometry.getAttribute('position').array),
    corners,
    ids: Uint32Array.from({length: corners.length / 3}, (_, i) => i)
  };
}
const mockup = body_of(new three.TorusKnotGeometry(0.1, 0.03, 160, 24));
const tool = body_of(new three.SphereGeometry(0.04, 32, 24));
const half = mockup.ids.length / 2;

const view = new SceneView(document.getElementById('host')!);
view.presenting = true;  // nothing is drawn but what the test draws
const shown = new three.Group();
view.scene.add(shown);
const bodies = new Bodies(shown);
view.kept.add(bodies.mockup_mesh);
const stores = [new TriangleStore({} as Api, 'static'), new TriangleStore({} as Api, 'tool')] as const;
const contact = new ContactLayer(...stores);
shown.add(contact.mockup.object);
bodies.tool.add(contact.tool.object);
const parts = new PartPicture();
parts.object.visible = false;
view.scene.add(parts.object);
view.kept.add(parts.object, () => parts.changes());
parts.load(
    {reduced: false, mockup, tool},
    [0, half].map(
        (first_triangle) =>
            ({file: 0, path: '', also: '', first_triangle, triangles: half, colour: null, box: null})),
    () => 1);
const looks = (colour: number, hidden = false) => parts.show([
  {colour: new three.Color(0x5588aa), hidden, with_tool: false},
  {colour: new three.Color(colour), hidden: false, with_tool: true}
]);
looks(0xaa8844);

bodies.set({reduced: false, mockup, tool});
stores[0].set_body(mockup, true);
stores[1].set_body(tool, true);
bodies.move([0.1, 0, 0.02, 0, 0, 0, 1]);
contact.set({
  cst: [],
  bst: Array.from({length: 900}, (_, i) => i),
  est: [],
  cmt: Array.from({length: 90}, (_, i) => i),
  bmt: [],
  imt: [],
  areas: []
} as unknown as Frame);
const theme = (of: typeof LIGHT) => {
  view.theme(of);
  bodies.theme(of);
};
theme(LIGHT);
view.set_bounds(new three.Box3().setFromObject(bodies.mockup_mesh));
view.look_at_all(true);

const gl = view.renderer.getContext() as WebGL2RenderingContext;
function pixels(draw: () => void): Uint8Array {
  draw();
  const {drawingBufferWidth: width, drawingBufferHeight: height} = gl;
  const out = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, out);
  return out;
}
let now = 0;
const as_kept = () => {
  view.kept.look(now += 1000);
  view.kept.draw(true);
};
const as_whole = () => {
  view.camera.updateMatrixWorld();
  view.renderer.render(view.scene, view.camera);
};

/** Pixels of two pictures that differ, those by more than two of 255, and the largest difference. */
interface Apart {
  differ: number;
  far: number;
  most: number
}
function apart(a: Uint8Array, b: Uint8Array): Apart {
  if (a.length !== b.length) return {differ: Infinity, far: Infinity, most: 255};
  let [differ, far, most] = [0, 0, 0];
  for (let i = 0; i < a.length; i += 4) {
    const way = Math.max(Math.abs(a[i] - b[i]), Math.abs(a[i + 1] - b[i + 1]), Math.abs(a[i + 2] - b[i + 2]));
    if (way > 0) ++differ;
    if (way > 2) ++far;
    most = Math.max(most, way);
  }
  return {differ, far, most};
}
let last = new Uint8Array(0);
/**
 * How the picture on what is kept differs from the whole one; whether it was kept; and in how many pixels it
 * is another than before.
 */
function compare(): Apart&{
  kept: boolean;
  new_pixels: number
}
{
  as_kept();
  const kept = view.kept.ready;
  const whole = pixels(as_whole);
  const result = {...apart(pixels(as_kept), whole), kept, new_pixels: apart(last, whole).differ};
  last = whole;
  return result;
}
/** The bodies drawn as three draws flat Lambert. */
function as_lambert(): Apart {
  const ours = pixels(as_whole);
  const meshes = [bodies.mockup_mesh, bodies.tool_mesh];
  const materials = meshes.map(({material}) => material);
  for (const mesh of meshes)
    Object.assign(
        mesh,
        {material: Object.assign(new three.MeshLambertMaterial().copy(mesh.material), {flatShading: true})});
  const theirs = pixels(as_whole);
  meshes.forEach((mesh, i) => {
    mesh.material = materials[i];
  });
  return apart(ours, theirs);
}

/** Contact triangles drawn as three draws unlit colours. */
function as_basic(): Apart {
  const ours = pixels(as_whole);
  const meshes = [contact.mockup, contact.tool].flatMap(({object}) => object.children as three.Mesh[]);
  const materials = meshes.map(({material}) => material as three.ShaderMaterial);
  for (const [i, mesh] of meshes.entries()) {
    const colours = mesh.geometry.getAttribute('colour');
    const linear = new three.BufferAttribute(new Float32Array(3 * colours.count), 3);
    for (let at = 0; at < colours.count; ++at)
      linear.setXYZ(
          at,
          ...new three.Color()
              .setRGB(colours.getX(at), colours.getY(at), colours.getZ(at), three.SRGBColorSpace)
              .toArray());
    mesh.geometry.setAttribute('color', linear);
    const {side, transparent, depthFunc, depthWrite, forceSinglePass, uniforms} = materials[i];
    mesh.material = new three.MeshBasicMaterial({
      vertexColors: true,
      opacity: uniforms['opacity'].value as number,
      side,
      transparent,
      depthFunc,
      depthWrite,
      forceSinglePass
    });
  }
  const theirs = pixels(as_whole);
  meshes.forEach((mesh, i) => {
    mesh.material = materials[i];
  });
  return apart(ours, theirs);
}

const plane = new three.Plane(new three.Vector3(-1, 0, 0), 0.02);
/** What is done, one after the other; after each the pictures are compared. */
const CHANGES: Record<string, () => void> = {
  'at first': () => {},
  'the tool moved': () => bodies.move([0.09, 0.02, 0, 0, 0, 0, 1]),
  'the camera turned': () => view.step(0.4, 0.2, 0),
  'the camera nearer': () => view.step(0, 0, 0.3),
  'a part hidden': () => bodies.hide(
      {static: [{path: 'a', triangles: half}, {path: 'b', triangles: half}], tool: []},
      {mockup: new Set([1]), tool: new Set()}),
  'a part shown again': () => bodies.hide(
      {static: [{path: 'a', triangles: half}, {path: 'b', triangles: half}], tool: []},
      {mockup: new Set(), tool: new Set()}),
  'a plane that cuts': () => {
    view.renderer.clippingPlanes = [plane];
  },
  'the plane moved': () => {
    plane.constant = -0.01;
  },
  'no plane': () => {
    view.renderer.clippingPlanes = [];
  },
  'dark': () => theme(DARK),
  'light': () => theme(LIGHT),
  'another size': () => {
    document.getElementById('host')!.style.height = '300px';
    view.renderer.setSize(500, 300);
    view.camera.aspect = 500 / 300;
    view.camera.updateProjectionMatrix();
  },
  'half the pixels': () => view.renderer.setPixelRatio(0.5),
  'all pixels': () => view.renderer.setPixelRatio(1),
  'y upwards': () => view.turn_up(),
  'glass': () => bodies.glass('mockup', true),
  'no glass': () => bodies.glass('mockup', false),
  'a solid tool': () => bodies.glass('tool', false),
  'coarser triangles': () =>
      bodies.set({reduced: true, mockup: body_of(new three.TorusKnotGeometry(0.1, 0.03, 60, 10)), tool}),
  'parts': () => {
    shown.visible = false;
    parts.object.visible = true;
  },
  'a part coloured': () => looks(0x22cc88),
  'a part moved': () => {
    parts.tool_matrix.makeTranslation(0.02, 0, 0.05);
  },
  'another part hidden': () => looks(0x22cc88, true),
};
Object.assign(window, {
  changes: Object.keys(CHANGES),
  change: (name: string) => {
    CHANGES[name]();
    return {...compare(), lambert: as_lambert(), basic: as_basic()};
  }
});
