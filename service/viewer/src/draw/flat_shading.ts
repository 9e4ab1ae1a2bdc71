// Flat triangles, lit once each and not at every pixel: a triangle's colour is made where one of its corners
// is, which no other triangle has its colour from. Colours are those of three's flat Lambert material. Where
// WebGL is drawn without a GPU that is a half to two thirds of a near picture's time.
import * as three from 'three';

let own_is_first = false;

/**
 * The corner that decides a triangle's colour: the first where one can have that, for on some systems the
 * last has to be imitated. Before any mesh is made.
 */
export function choose_corner(gl: WebGL2RenderingContext): void {
  const order = gl.getExtension('WEBGL_provoking_vertex') as {
    provokingVertexWEBGL: (mode: number) => void;
    FIRST_VERTEX_CONVENTION_WEBGL: number
  }
  |null;
  order?.provokingVertexWEBGL(order.FIRST_VERTEX_CONVENTION_WEBGL);
  own_is_first = order !== null;
}

/**
 * A mesh in which each triangle has a corner of its own. `faces`: four numbers a vertex, the normal of the
 * triangle whose own it is. `copied`: which vertices the last ones are copies of.
 */
export interface Faced {
  vertices: Float32Array;
  corners: Uint32Array;
  faces: Int16Array;
  copied: Uint32Array
}
export function with_faces(vertices: Float32Array, corners: Uint32Array): Faced {
  const before = vertices.length / 3;
  const triangles = corners.length / 3;
  const taken = new Uint8Array(before);
  const own = new Uint8Array(triangles);  // which corner; 3: a copy of the first
  let copies = 0;
  for (let t = 0; t < triangles; ++t) {
    let k = 0;
    while (k < 3 && taken[corners[3 * t + k]]) ++k;
    own[t] = k;
    if (k < 3)
      taken[corners[3 * t + k]] = 1;
    else
      ++copies;
  }
  const out = {
    vertices: new Float32Array(3 * (before + copies)),
    corners: new Uint32Array(corners.length),
    faces: new Int16Array(4 * (before + copies)),
    copied: new Uint32Array(copies)
  };
  out.vertices.set(vertices);
  const [a, b, c] = [new three.Vector3(), new three.Vector3(), new three.Vector3()];
  copies = 0;
  for (let t = 0; t < triangles; ++t) {
    const k = own[t] % 3;
    let mine = corners[3 * t + k];
    const [next, last] = [corners[3 * t + ((k + 1) % 3)], corners[3 * t + ((k + 2) % 3)]];
    b.fromArray(vertices, 3 * next).sub(a.fromArray(vertices, 3 * mine));
    c.fromArray(vertices, 3 * last).sub(a);
    b.cross(c).normalize().multiplyScalar(32767);
    if (own[t] === 3) {
      out.copied[copies] = mine;
      a.toArray(out.vertices, 3 * (mine = before + copies++));
    }
    out.faces.set([Math.round(b.x), Math.round(b.y), Math.round(b.z)], 4 * mine);
    out.corners.set(own_is_first ? [mine, next, last] : [next, last, mine], 3 * t);
  }
  return out;
}
export function geometry_of({vertices, corners, faces}: Faced): three.BufferGeometry {
  const geometry = new three.BufferGeometry();
  geometry.setAttribute('position', new three.BufferAttribute(vertices, 3));
  geometry.setAttribute(
      'face', new three.InterleavedBufferAttribute(new three.InterleavedBuffer(faces, 4), 3, 0, true));
  geometry.setIndex(new three.BufferAttribute(corners, 1));
  geometry.computeBoundingBox();
  geometry.computeBoundingSphere();
  return geometry;
}

/** Triangles of plain colours, unlit: the attribute `colour` of their corners, as it is shown (sRGB). */
export function coloured_material(
    opacity = 1, parameters: three.ShaderMaterialParameters = {}): three.ShaderMaterial {
  return new three.ShaderMaterial({
    ...parameters,
    transparent: opacity < 1,
    side: three.DoubleSide,
    forceSinglePass: true,  // which side is drawn first can't be told
    clipping: true,
    uniforms: {opacity: {value: opacity}},
    vertexShader: `
      #include <clipping_planes_pars_vertex>
      attribute vec3 colour;
      flat varying vec3 shade;
      void main() {
        #include <begin_vertex>
        #include <project_vertex>
        #include <clipping_planes_vertex>
        shade = colour;
      }`,
    fragmentShader: `
      #include <clipping_planes_pars_fragment>
      uniform float opacity;
      flat varying vec3 shade;
      void main() {
        #include <clipping_planes_fragment>
        gl_FragColor = vec4(shade, opacity);
      }`,
  });
}

/** `change`: what else the shaders are to do. */
export function flat_material(
    parameters: three.MeshLambertMaterialParameters,
    change: (shader: three.WebGLProgramParametersWithUniforms) => void =
        () => {}): three.MeshLambertMaterial {
  const material = new three.MeshLambertMaterial({...parameters, side: three.DoubleSide});
  material.customProgramCacheKey = () => `flat ${String(change)}`;
  material.onBeforeCompile = (shader) => {
    shader.vertexShader = `
      #include <common>
      #include <bsdfs>
      #include <lights_pars_begin>
      #include <clipping_planes_pars_vertex>
      uniform vec3 diffuse;
      attribute vec3 face;
      flat varying vec3 shade;   // as it is shown: sRGB
      void main() {
        vec3 colour = diffuse;
        #include <begin_vertex>
        #include <project_vertex>
        #include <clipping_planes_vertex>
        vec3 normal = normalize(normalMatrix * face);
        if (dot(normal, mvPosition.xyz) > 0.0) normal = -normal;   // the side that is seen
        vec3 light = vec3(0.0);
        #if NUM_HEMI_LIGHTS > 0
          for (int i = 0; i < NUM_HEMI_LIGHTS; ++i) light += getHemisphereLightIrradiance(hemisphereLights[i], normal);
        #endif
        #if NUM_DIR_LIGHTS > 0
          for (int i = 0; i < NUM_DIR_LIGHTS; ++i) light += directionalLights[i].color * saturate(dot(normal, directionalLights[i].direction));
        #endif
        vec3 seen = BRDF_Lambert(colour) * light;
        shade = mix(1.055 * pow(seen, vec3(0.41666)) - 0.055, 12.92 * seen, vec3(lessThanEqual(seen, vec3(0.0031308))));
      }`;
    shader.fragmentShader = `
      #include <clipping_planes_pars_fragment>
      uniform float opacity;
      flat varying vec3 shade;
      void main() {
        #include <clipping_planes_fragment>
        gl_FragColor = vec4(shade, opacity);
      }`;
    change(shader);
  };
  return material;
}
