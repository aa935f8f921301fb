// Runs in the browser: draws a scene with three.js and says how long a frame took.
//
// The winding of each triangle is turned to the light, and its normal with it: material of both sides, whose normals three.js turns
// to the eye, is then bright where the eye sees the lit side, and normal_bias moves to the light's side on open meshes, too.

import * as THREE from "three";
import { ShadowMesh } from "three/addons/objects/ShadowMesh.js";

const types = { basic: THREE.BasicShadowMap, pcf: THREE.PCFShadowMap, vsm: THREE.VSMShadowMap };
const least_near = 1e-3; // of the far plane of a light's camera: what is nearer to the light casts nothing
const scene = new THREE.Scene();
const camera = new THREE.PerspectiveCamera();
camera.matrixAutoUpdate = false;
const white = new THREE.MeshLambertMaterial({ side: THREE.DoubleSide });
const bright = 1000; // of a light: no cosine then falls below what 16 bits hold
const black = { opacity: 1, side: THREE.DoubleSide }; // by default a ShadowMesh is gray and has one side
const lost = "WebGL's context is lost: its process ended, or had not enough memory for maps or picture";
let renderer, gl, target, light;
let meshes = [];
let projected = []; // { mesh: ShadowMesh, plane, place: of the light, homogeneous }
const drawn = new Set(); // kinds of frames whose shaders, textures and buffers are there

export function start() {
  renderer = new THREE.WebGLRenderer();
  gl = renderer.getContext();
  gl.pixelStorei(gl.PACK_ALIGNMENT, 2); // rows of pictures of 16 bits are not padded
  const { UNMASKED_RENDERER_WEBGL } = gl.getExtension("WEBGL_debug_renderer_info");
  return { three: THREE.REVISION, gl: gl.getParameter(UNMASKED_RENDERER_WEBGL) };
}

/** Takes the geometry: `file` has the corners; a part is { first, end, casts, receives, plane }, counted in triangles. */
export async function build({ file, parts }) {
  const corners = new Float32Array(await (await fetch(`data/${file}`)).arrayBuffer());
  for (const mesh of meshes) mesh.removeFromParent().geometry.dispose();
  drawn.clear();
  meshes = parts.map(({ first, end, casts, receives, plane }) => {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(corners.slice(9 * first, 9 * end), 3));
    geometry.setAttribute("normal", new THREE.BufferAttribute(new Float32Array(9 * (end - first)), 3));
    const mesh = new THREE.Mesh(geometry, white);
    scene.add(mesh);
    return Object.assign(mesh, { castShadow: casts, receiveShadow: receives, plane });
  });
}

/** Takes a light, { kind, position, direction, inner, outer } with angles in radians, and the kind of its shadows. */
export function relight({ shadows, kind, position, direction, inner, outer }) {
  light?.removeFromParent().dispose();
  light?.target?.removeFromParent();
  if (kind === "directional") light = new THREE.DirectionalLight(0xffffff, bright);
  else if (kind === "spot") light = new THREE.SpotLight(0xffffff, bright, 0, outer, 1 - inner / outer, 0);
  else light = new THREE.PointLight(0xffffff, bright, 0, 0);
  light.position.set(...(position ?? [0, 0, 0]));
  scene.add(light);
  if (kind !== "point") scene.add(light.target);
  light.target?.position.copy(light.position).add(new THREE.Vector3(...direction));
  scene.updateMatrixWorld();
  for (const mesh of meshes) turn_to_light(mesh.geometry.attributes);
  if (kind === "directional") fit_box();
  else fit_depths(kind === "spot" ? Math.tan(outer) : 1);
  renderer.shadowMap.enabled = shadows in types;
  if (shadows in types) renderer.shadowMap.type = types[shadows];
  for (const { mesh } of projected) mesh.removeFromParent().material.dispose();
  drawn.clear();
  projected = shadows === "planar" ? meshes.filter(({ plane }) => plane).flatMap(project_onto) : [];
}

const corner = (position, i) => new THREE.Vector3().fromBufferAttribute(position, i);

function* corners_of({ geometry: { attributes: { position } } }) {
  for (let i = 0; i < position.count; ++i) yield corner(position, i);
}

const to_light = (from) => light.position.clone().sub(light.isDirectionalLight ? light.target.position : from);

function turn_to_light({ position, normal }) {
  for (let i = 0; i < position.count; i += 3) {
    const [a, b, c] = [i, i + 1, i + 2].map((k) => corner(position, k));
    const n = b.clone().sub(a).cross(c.clone().sub(a)).normalize();
    if (n.dot(to_light(a)) < 0) {
      n.negate();
      position.setXYZ(i + 1, ...c);
      position.setXYZ(i + 2, ...b);
    }
    for (const k of [i, i + 1, i + 2]) normal.setXYZ(k, ...n);
  }
  position.needsUpdate = normal.needsUpdate = true;
}

/** A directional light's image holds what casters and receivers share, its depths all of them. */
function fit_box() {
  const eye = light.shadow.camera;
  light.shadow.updateMatrices(light); // turns it
  const box_of = (chosen) => {
    const box = new THREE.Box3();
    for (const mesh of chosen) for (const p of corners_of(mesh)) box.expandByPoint(p.applyMatrix4(eye.matrixWorldInverse));
    return box;
  };
  const casters = box_of(meshes.filter(({ castShadow }) => castShadow));
  const receivers = box_of(meshes.filter(({ receiveShadow }) => receiveShadow));
  const [left, right] = [Math.max(casters.min.x, receivers.min.x), Math.min(casters.max.x, receivers.max.x)];
  const [bottom, top] = [Math.max(casters.min.y, receivers.min.y), Math.min(casters.max.y, receivers.max.y)];
  if (!(left < right && bottom < top)) return; // nothing casts on anything
  const [nearest, farthest] = [casters.max.z, Math.min(casters.min.z, receivers.min.z)]; // z is toward the light
  const margin = 1e-3 * (nearest - farthest) + 1e-6 * Math.max(Math.abs(nearest), Math.abs(farthest));
  Object.assign(eye, { left, right, bottom, top, near: -nearest - margin, far: -farthest + margin }).updateProjectionMatrix();
}

/** The depths of a light at a place hold all that its pyramids, whose sides lean by `tangent`, can show. */
function fit_depths(tangent) {
  let [nearest, farthest] = [Infinity, 0];
  const [triangle, p] = [new THREE.Triangle(), new THREE.Vector3()];
  for (const mesh of meshes) {
    const { position } = mesh.geometry.attributes;
    for (let i = 0; i < position.count; i += 3) {
      triangle.setFromAttributeAndIndices(position, i, i + 1, i + 2);
      nearest = Math.min(nearest, triangle.closestPointToPoint(light.position, p).distanceTo(light.position));
      for (const end of [triangle.a, triangle.b, triangle.c]) farthest = Math.max(farthest, end.distanceTo(light.position));
    }
  }
  if (farthest === 0) return; // there are no meshes
  const far = 1.001 * farthest;
  const near = Math.max((0.999 * nearest) / Math.hypot(1, tangent, tangent), least_near * far);
  Object.assign(light.shadow.camera, { near, far }).updateProjectionMatrix();
}

/** A ShadowMesh for each caster that reaches into the space between light and a receiver's plane, which is [nx, ny, nz, n.p]. */
function project_onto({ plane: [x, y, z, constant] }) {
  // What ShadowMesh calls a plane is where n.p = constant; to others of three.js it is where n.p = -constant.
  const plane = new THREE.Plane(new THREE.Vector3(x, y, z), constant);
  const place = new THREE.Vector4(...to_light(new THREE.Vector3()), light.isDirectionalLight ? 0 : 1);
  const height = (p) => plane.normal.dot(p) - plane.constant * (p.w ?? 1);
  if (height(place) < 0) plane.negate();
  const ceiling = place.w ? 0.99999 * height(place) : Infinity;
  const reaches_between = (mesh) => {
    let [lowest, highest] = [Infinity, 0];
    for (const p of corners_of(mesh)) {
      lowest = Math.min(lowest, height(p));
      highest = Math.max(highest, height(p) - 1e-5 * p.length()); // more than rounding above it
    }
    return highest > 0 && lowest < ceiling;
  };
  return meshes.filter((mesh) => mesh.castShadow && reaches_between(mesh)).map((caster) => {
    const mesh = new ShadowMesh(caster);
    Object.assign(mesh.material, black);
    scene.add(mesh);
    return { mesh, plane, place };
  });
}

/** Draws a frame of { width, height, camera: { world, fov_y_degrees, near, far }, shadows, settings }: { ms, picture }. */
export function frame({ width, height, camera: { world, fov_y_degrees, near, far }, shadows, settings }) {
  const { map_size, bias, normal_bias, radius, blur_samples, plane_offset } = settings;
  if (gl.isContextLost()) throw new Error(lost);
  const most = gl.getParameter(gl.MAX_TEXTURE_SIZE);
  if (Math.max(width, height, map_size) > most) throw new Error(`pictures and maps have no more than ${most} texels a side`);
  if (target?.width !== width || target?.height !== height) {
    target?.dispose();
    // One number of 16 bits a pixel takes as long to draw as the four bytes of a canvas; four floats take a tenth longer.
    target = new THREE.WebGLRenderTarget(width, height, { format: THREE.RedFormat, type: THREE.HalfFloatType, stencilBuffer: true });
    renderer.setRenderTarget(target);
    drawn.clear();
  }
  if (light.shadow.mapSize.x !== map_size) {
    light.shadow.dispose(); // three.js does not resize cubes
    Object.assign(light.shadow, { map: null, mapPass: null }).mapSize.set(map_size, map_size);
    drawn.clear();
  }
  Object.assign(light.shadow, { bias, normalBias: normal_bias, radius, blurSamples: blur_samples });
  light.castShadow = shadows && renderer.shadowMap.enabled;
  // A light below the lifted plane has no shadows on it, but ShadowMesh would draw some.
  for (const { mesh, plane, place } of projected)
    mesh.visible = shadows && plane.normal.dot(place) > (plane.constant + plane_offset) * place.w;
  camera.matrix.fromArray(world);
  camera.matrixWorldNeedsUpdate = true;
  Object.assign(camera, { fov: fov_y_degrees, aspect: width / height, near, far }).updateProjectionMatrix();

  const pixel = new Uint16Array(1);
  const draw = () => {
    const start = performance.now();
    // ShadowMeshes are moved before each frame, as their user does.
    for (const { mesh, plane, place } of projected) mesh.update(new THREE.Plane(plane.normal, plane.constant + plane_offset), place);
    renderer.render(scene, camera);
    renderer.readRenderTargetPixels(target, 0, 0, 1, 1, pixel); // ends the frame
    return performance.now() - start;
  };
  const kind = `${shadows} ${blur_samples}`;
  if (!drawn.has(kind)) draw(); // compiles and allocates
  drawn.add(kind);
  const ms = draw();

  const picture = new Uint16Array(width * height);
  renderer.readRenderTargetPixels(target, 0, 0, width, height, picture);
  const fault = gl.getError();
  if (fault) throw new Error(gl.isContextLost() ? lost : `WebGL's error ${fault}`);
  return { ms, picture: new Uint8Array(picture.buffer).toBase64() };
}
