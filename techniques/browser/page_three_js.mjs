// Runs in the browser: draws a scene with three.js, for page.mjs.

import * as THREE from "three";
import { ShadowMesh } from "three/addons/objects/ShadowMesh.js";

const types = { basic: THREE.BasicShadowMap, pcf: THREE.PCFShadowMap, pcf_soft: THREE.PCFSoftShadowMap, vsm: THREE.VSMShadowMap };
const scene = new THREE.Scene();
const camera = new THREE.PerspectiveCamera();
camera.matrixAutoUpdate = false;
// Of both sides: three.js turns their normals to the eye, and so what looks at a side turned from the light is black.
const white = new THREE.MeshLambertMaterial({ side: THREE.DoubleSide });
const bright = 1000; // of a light: no cosine then falls below what 16 bits hold
const black = { opacity: 1, side: THREE.DoubleSide }; // by default a ShadowMesh is gray and has one side
let renderer, target, light;
let meshes = [];
let projected = []; // { mesh: ShadowMesh, plane, place: of the light, homogeneous }
let lift = 0; // of shadows above their planes

export function start() {
  renderer = new THREE.WebGLRenderer();
  return { version: `r${THREE.REVISION}`, gl: renderer.getContext() };
}

export function relight({ kind, position, direction, inner, outer, near, far, settings: { shadows }, meshes: given }) {
  for (const mesh of meshes) mesh.removeFromParent().geometry.dispose();
  meshes = given.map(({ positions, normals, casts, receives, plane }) => {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
    geometry.setAttribute("normal", new THREE.BufferAttribute(normals, 3));
    const mesh = new THREE.Mesh(geometry, white);
    scene.add(mesh);
    return Object.assign(mesh, { castShadow: casts, receiveShadow: receives, plane });
  });
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
  if (kind === "directional") fit_box();
  else Object.assign(light.shadow.camera, { near, far }).updateProjectionMatrix();
  renderer.shadowMap.enabled = shadows in types;
  if (shadows in types) renderer.shadowMap.type = types[shadows];
  for (const { mesh } of projected) mesh.removeFromParent().material.dispose();
  projected = shadows === "planar" ? meshes.filter(({ plane }) => plane).flatMap(project_onto) : [];
}

function* corners_of({ geometry: { attributes: { position } } }) {
  for (let i = 0; i < position.count; ++i) yield new THREE.Vector3().fromBufferAttribute(position, i);
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

/** A ShadowMesh for each caster that reaches into the space between light and a receiver's plane, which is [nx, ny, nz, n.p]. */
function project_onto({ plane: [x, y, z, constant] }) {
  // What ShadowMesh calls a plane is where n.p = constant; to others of three.js it is where n.p = -constant.
  const plane = new THREE.Plane(new THREE.Vector3(x, y, z), constant);
  const place = light.isDirectionalLight
    ? new THREE.Vector4(...light.position.clone().sub(light.target.position), 0)
    : new THREE.Vector4(...light.position, 1);
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

export function prepare({ width, height, camera: { world, fov_y_degrees, near, far }, shadows, settings }) {
  if (target?.width !== width || target?.height !== height) {
    target?.dispose();
    // One number of 16 bits a pixel takes as long to draw as the four bytes of a canvas; four floats take a tenth longer.
    target = new THREE.WebGLRenderTarget(width, height, { format: THREE.RedFormat, type: THREE.HalfFloatType, stencilBuffer: true });
    renderer.setRenderTarget(target);
  }
  const { map_size, bias, normal_bias, radius, blur_samples, plane_offset } = settings;
  if (light.shadow.mapSize.x !== map_size) {
    light.shadow.dispose(); // three.js does not resize cubes
    Object.assign(light.shadow, { map: null, mapPass: null }).mapSize.set(map_size, map_size);
  }
  Object.assign(light.shadow, { bias, normalBias: normal_bias, radius, blurSamples: blur_samples });
  light.castShadow = shadows && renderer.shadowMap.enabled;
  lift = plane_offset;
  // A light below the lifted plane has no shadows on it, but ShadowMesh would draw some.
  for (const { mesh, plane, place } of projected) mesh.visible = shadows && plane.normal.dot(place) > (plane.constant + lift) * place.w;
  camera.matrix.fromArray(world);
  camera.matrixWorldNeedsUpdate = true;
  Object.assign(camera, { fov: fov_y_degrees, aspect: width / height, near, far }).updateProjectionMatrix();
}

export function draw() {
  // ShadowMeshes are moved before each frame, as their user does.
  for (const { mesh, plane, place } of projected) mesh.update(new THREE.Plane(plane.normal, plane.constant + lift), place);
  renderer.render(scene, camera);
}

export const framebuffer = () => renderer.properties.get(target).__webglFramebuffer;
