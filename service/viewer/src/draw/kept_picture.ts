// What stands still is drawn once: its colours and depths are kept, and laid under what moves until anything
// of it is another, the camera included.
import * as three from 'three';

const STILL = 3;        // the layer of what is kept; a headset's eyes have 1 and 2
const STANDS_MS = 120;  // chosen: what has stood for so long will go on to; a camera that is turned by hand
                        // does not rest so long

/** What is kept, and, beside what a mesh says itself, what else its picture hangs on. */
interface Still {
  object: three.Object3D;
  also: () => readonly unknown[]
}

/** What is drawn into, and what the picture in it hangs on; empty: there is none. */
interface Kept {
  target: three.WebGLRenderTarget;
  of: unknown[]
}
function room(): Kept {
  const target = new three.WebGLRenderTarget(1, 1, {
    colorSpace: three.SRGBColorSpace,
    internalFormat: 'RGBA8',
    minFilter: three.NearestFilter,
    magFilter: three.NearestFilter,
    generateMipmaps: false
  });
  // As the canvas has them, and as three does it for a headset: colours as they are shown, in eight bits.
  // Else they would be blended and rounded otherwise.
  (target as three.WebGLRenderTarget & {isXRRenderTarget: boolean}).isXRRenderTarget = true;
  target.depthTexture = new three.DepthTexture(1, 1, three.UnsignedIntType);
  return {target, of: []};
}

export class KeptPicture {
  private readonly still: Still[] = [];
  private readonly rooms =
      [room(), room()];  // the newest first: one for pictures of what moves, one for the sharp one at rest
  private readonly sheet: three.Mesh<three.BufferGeometry, three.RawShaderMaterial>;
  private seen: unknown[] = [];  // what the picture before hung on
  private since = -Infinity;     // when `seen` began, ms
  private changed = false;       // it did with the picture before
  private moves = false;

  constructor(
      private readonly renderer: three.WebGLRenderer, private readonly scene: three.Scene,
      private readonly camera: three.Camera) {
    const corners = new three.BufferGeometry();
    corners.setAttribute(
        'position', new three.BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
    this.sheet = new three.Mesh(corners, new three.RawShaderMaterial({
      glslVersion: three.GLSL3,
      depthFunc: three.AlwaysDepth,
      uniforms:
          {colours: {value: null as three.Texture | null}, depths: {value: null as three.Texture | null}},
      vertexShader: 'in vec3 position;\nvoid main() { gl_Position = vec4(position, 1.0); }',
      fragmentShader: `precision highp float;
        precision highp sampler2D;
        uniform sampler2D colours, depths;
        out vec4 colour;
        void main() {
          ivec2 at = ivec2(gl_FragCoord.xy);
          colour = texelFetch(colours, at, 0);
          gl_FragDepth = texelFetch(depths, at, 0).r;
        }`,
    }));
    this.sheet.frustumCulled = this.sheet.visible = false;
    this.sheet.renderOrder = -1;  // under all else
    scene.add(this.sheet);
    renderer.domElement.addEventListener('webglcontextrestored', () => this.forget());
  }

  /** Another that stands still. `also`: what its picture hangs on beside place, mesh, colour and opacity. */
  add(object: three.Object3D, also: () => readonly unknown[] = () => []): void {
    object.traverse((each) => each.layers.enable(STILL));
    this.still.push({object, also});
  }
  remove(object: three.Object3D): void {
    this.still.splice(this.still.findIndex((one) => one.object === object), 1);
  }
  /** A light that shines on it. */
  lit_by(light: three.Light): void {
    light.layers.enable(STILL);
  }
  forget(): void {
    for (const each of this.rooms) each.of = [];
  }

  /**
   * Looks at the scene before a picture: whether what should stand still does. One change, such as a part
   * that is hidden, is no motion; the second in a row is. `now` as requestAnimationFrame has it.
   */
  look(now: number): boolean {
    this.scene.updateMatrixWorld();
    const state = this.state();
    const changes = !same(state, this.seen);
    if (changes)
      this.moves = this.changed || now - this.since < STANDS_MS;
    else if (now - this.since >= STANDS_MS)
      this.moves = false;
    if (changes) {
      this.seen = state;
      this.since = now;
    }
    this.changed = changes;
    return !this.moves;
  }
  /**
   * Whether the next picture can be laid on what is kept, of a canvas of this many pixels for one of the
   * page.
   */
  get ready(): boolean {
    return this.fitting() !== undefined;
  }
  private fitting(): Kept|undefined {
    const wanted = [...this.seen, ...this.size()];
    return this.rooms.find(({of}) => same(of, wanted));
  }
  /** Whether it can be kept at all. What one sees through belongs between other things, not under them. */
  get may_keep(): boolean {
    return !this.still.some(
        ({object}) => shown(object) && meshes(object).some(({material}) => material.transparent));
  }

  /** Draws what `look` saw; `keep`: keeps what stands still for the pictures to come. */
  draw(keep: boolean): void {
    const {target} = this.fitting() ?? (keep && this.may_keep ? this.take() : {target: null});
    if (!target) {
      this.renderer.render(this.scene, this.camera);
      return;
    }
    this.sheet.material.uniforms['colours'].value = target.texture;
    this.sheet.material.uniforms['depths'].value = target.depthTexture;
    const hidden = this.still.map(({object}) => object).filter(({visible}) => visible);
    for (const object of hidden) object.visible = false;
    this.sheet.visible = true;
    this.renderer.render(this.scene, this.camera);
    this.sheet.visible = false;
    for (const object of hidden) object.visible = true;
  }
  private take(): Kept {
    const into = this.rooms.pop()!;
    this.rooms.unshift(into);
    const [width, height] = this.size();
    if (into.target.width !== width || into.target.height !== height) into.target.setSize(width, height);
    const {mask} = this.camera.layers;
    this.camera.layers.set(STILL);
    this.renderer.setRenderTarget(into.target);
    this.renderer.render(this.scene, this.camera);
    this.renderer.setRenderTarget(null);
    this.camera.layers.mask = mask;
    into.of = [...this.seen, width, height];
    return into;
  }
  private size(): [number, number] {
    const {x, y} = this.renderer.getDrawingBufferSize(new three.Vector2());
    return [x, y];
  }
  private state(): unknown[] {
    const {background} = this.scene;
    return [
      ...this.camera.matrixWorld.elements,
      ...this.camera.projectionMatrix.elements,
      background instanceof three.Color ? background.getHex() : background,
      ...(this.renderer.clippingPlanes as three.Plane[])
          .flatMap(({normal, constant}) => [normal.x, normal.y, normal.z, constant]),
      ...this.still.filter(({object}) => shown(object))
          .flatMap(
              ({object, also}) =>
                  [...meshes(object).flatMap(
                       ({matrixWorld, geometry, material}) =>
                           [...matrixWorld.elements,
                            geometry,
                            geometry.index,
                            material,
                            material.version,
                            material.opacity,
                            (material as three.MeshLambertMaterial).color.getHex(),
    ]),
                   ...also()]),
    ];
  }
}

type Drawn =
    three.Mesh<three.BufferGeometry, three.Material>|three.Line<three.BufferGeometry, three.Material>;
function meshes(object: three.Object3D): Drawn[] {
  const found: Drawn[] = [];
  object.traverseVisible((each) => {
    if (each instanceof three.Mesh || each instanceof three.Line) found.push(each as Drawn);
  });
  return found;
}
function shown(object: three.Object3D): boolean {
  for (let at: three.Object3D|null = object; at; at = at.parent)
    if (!at.visible) return false;
  return true;
}
const same = (a: readonly unknown[], b: readonly unknown[]): boolean =>
    a.length === b.length && a.every((value, i) => Object.is(value, b[i]));
