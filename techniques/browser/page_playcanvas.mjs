// Runs in the browser: draws a scene with PlayCanvas, for page.mjs.

import * as pc from "playcanvas";

const types = {
  pcf1: { 16: pc.SHADOW_PCF1_16F, 32: pc.SHADOW_PCF1_32F },
  pcf3: { 16: pc.SHADOW_PCF3_16F, 32: pc.SHADOW_PCF3_32F },
  pcf5: { 16: pc.SHADOW_PCF5_16F, 32: pc.SHADOW_PCF5_32F },
  vsm: { 16: pc.SHADOW_VSM_16F, 32: pc.SHADOW_VSM_32F },
  pcss: { 32: pc.SHADOW_PCSS_32F },
};
const kinds = { point: "omni", spot: "spot", directional: "directional" };
const degrees = 180 / Math.PI;
const bright = 1000; // of a light: no cosine, and no share that its falloff leaves, then falls below what 16 bits hold
const down = new pc.Vec3(0, -1, 0); // where a light without rotation shines

let app, device, white, eye, target;
let entities = []; // of meshes
let lights = {}; // by whether it has shadows: the same light twice, of which one is on

export async function start() {
  const canvas = document.createElement("canvas");
  device = await pc.createGraphicsDevice(canvas, { deviceTypes: [pc.DEVICETYPE_WEBGL2], antialias: false });
  const options = new pc.AppOptions();
  const componentSystems = [pc.RenderComponentSystem, pc.CameraComponentSystem, pc.LightComponentSystem];
  app = new pc.AppBase(canvas);
  app.init(Object.assign(options, { graphicsDevice: device, componentSystems }));
  app.scene.ambientLight = new pc.Color(0, 0, 0);
  // Clustered lights share one atlas of one resolution and one filter; each of ours has its own map.
  app.scene.clusteredLightingEnabled = false;
  white = Object.assign(new pc.StandardMaterial(), { cull: pc.CULLFACE_NONE, useTonemap: false, useSkybox: false, useFog: false });
  white.update();
  eye = new pc.Entity();
  eye.addComponent("camera", { clearColor: new pc.Color(0, 0, 0, 0), toneMapping: pc.TONEMAP_NONE, gammaCorrection: pc.GAMMA_NONE });
  eye.camera.aspectRatioMode = pc.ASPECT_MANUAL;
  app.root.addChild(eye);
  return { version: pc.version, gl: device.gl };
}

function light_of({ kind, position, direction, inner, outer, far }, castShadows) {
  const entity = new pc.Entity();
  const cone = kind === "spot" ? { innerConeAngle: inner * degrees, outerConeAngle: outer * degrees } : {};
  const range = kind === "directional" ? {} : { range: far };
  entity.addComponent("light", { type: kinds[kind], intensity: bright, castShadows, ...cone, ...range });
  if (position) entity.setPosition(...position);
  if (direction) entity.setRotation(new pc.Quat().setFromDirections(down, new pc.Vec3(...direction).normalize()));
  entity.enabled = false;
  app.root.addChild(entity);
  return entity;
}

export function relight({ meshes, ...facts }) {
  for (const entity of [...entities, ...Object.values(lights)]) entity.destroy();
  lights = { true: light_of(facts, true), false: light_of(facts, false) };
  entities = meshes.map(({ positions, normals, casts, receives }) => {
    const mesh = new pc.Mesh(device);
    mesh.setPositions(positions);
    mesh.setNormals(normals);
    mesh.update(pc.PRIMITIVE_TRIANGLES);
    const entity = new pc.Entity();
    entity.addComponent("render", { meshInstances: [new pc.MeshInstance(mesh, white)], castShadows: casts, receiveShadows: receives });
    app.root.addChild(entity);
    return entity;
  });
}

function set_camera({ world, fov_y_degrees, near, far }, width, height) {
  if (target?.width !== width || target?.height !== height) {
    target?.destroyTextureBuffers();
    target?.destroy();
    const colorBuffer = new pc.Texture(device, { width, height, format: pc.PIXELFORMAT_R16F, mipmaps: false });
    target = new pc.RenderTarget({ colorBuffer, depth: true });
  }
  const placed = new pc.Mat4();
  placed.data.set(world);
  eye.setPosition(placed.getTranslation());
  eye.setRotation(new pc.Quat().setFromMat4(placed));
  const lens = { fov: fov_y_degrees, aspectRatio: width / height, nearClip: near, farClip: far };
  Object.assign(eye.camera, { ...lens, renderTarget: target });
}

export function prepare({ width, height, camera, shadows, settings }) {
  set_camera(camera, width, height);
  Object.assign(lights[true].light, {
    shadowType: types[settings.shadows][settings.depth_bits],
    shadowResolution: settings.map_size,
    shadowBias: settings.bias,
    normalOffsetBias: settings.normal_bias,
    shadowDistance: camera.far, // PlayCanvas draws no shadow that is farther from the eye
    numCascades: settings.cascades,
    cascadeDistribution: settings.split_blend,
    cascadeBlend: settings.cascade_blend,
    vsmBlurSize: settings.blur_texels,
    vsmBias: settings.variance_bias,
    penumbraSize: settings.penumbra_size,
    shadowSamples: settings.samples,
    shadowBlockerSamples: settings.samples,
  });
  for (const [has_shadows, entity] of Object.entries(lights)) entity.enabled = has_shadows === String(shadows);
}

export const draw = () => app.render();

export const framebuffer = () => target.impl._glFrameBuffer;
