// Runs in the browser: draws a scene with Babylon.js, for page.mjs.

import { Camera } from "@babylonjs/core/Cameras/camera.js";
import { Engine } from "@babylonjs/core/Engines/engine.js";
import { DirectionalLight } from "@babylonjs/core/Lights/directionalLight.js";
import { PointLight } from "@babylonjs/core/Lights/pointLight.js";
import { SpotLight } from "@babylonjs/core/Lights/spotLight.js";
import { CascadedShadowGenerator } from "@babylonjs/core/Lights/Shadows/cascadedShadowGenerator.js";
import { ShadowGenerator } from "@babylonjs/core/Lights/Shadows/shadowGenerator.js";
import "@babylonjs/core/Lights/Shadows/shadowGeneratorSceneComponent.js";
import { StandardMaterial } from "@babylonjs/core/Materials/standardMaterial.js";
import { RenderTargetTexture } from "@babylonjs/core/Materials/Textures/renderTargetTexture.js";
import { Color3, Color4 } from "@babylonjs/core/Maths/math.color.js";
import { Matrix, Vector3 } from "@babylonjs/core/Maths/math.vector.js";
import { Mesh } from "@babylonjs/core/Meshes/mesh.js";
import { VertexData } from "@babylonjs/core/Meshes/mesh.vertexData.js";
import { Scene } from "@babylonjs/core/scene.js";

const filters = {
  basic: ShadowGenerator.FILTER_NONE,
  poisson: ShadowGenerator.FILTER_POISSONSAMPLING,
  pcf: ShadowGenerator.FILTER_PCF,
  contact_hardening: ShadowGenerator.FILTER_PCSS,
  exponential: ShadowGenerator.FILTER_EXPONENTIALSHADOWMAP,
  blurred_exponential: ShadowGenerator.FILTER_BLUREXPONENTIALSHADOWMAP,
  close_exponential: ShadowGenerator.FILTER_CLOSEEXPONENTIALSHADOWMAP,
  blurred_close_exponential: ShadowGenerator.FILTER_BLURCLOSEEXPONENTIALSHADOWMAP,
  cascaded: ShadowGenerator.FILTER_PCF,
};
const qualities = { low: ShadowGenerator.QUALITY_LOW, medium: ShadowGenerator.QUALITY_MEDIUM, high: ShadowGenerator.QUALITY_HIGH };
const [half_float, red] = [Engine.TEXTURETYPE_HALF_FLOAT, Engine.TEXTUREFORMAT_R];

/** A camera at a matrix. */
class FixedCamera extends Camera {
  view = Matrix.Identity();

  _getViewMatrix() {
    return this.view;
  }

  _isSynchronizedViewMatrix() {
    return false;
  }

  place({ world, fov_y_degrees, near, far }, aspect) {
    Object.assign(this, { minZ: near, maxZ: far, view: Matrix.Invert(Matrix.FromArray(world)) });
    const projection = new Matrix();
    Matrix.PerspectiveFovRHToRef((fov_y_degrees * Math.PI) / 180, aspect, near, far, projection);
    this.freezeProjectionMatrix(projection);
  }
}

let engine, scene, camera, white, target, generator, made_of;
let meshes = [];
let lights = {}; // by whether it has shadows: the same light twice, of which one is on

export function start() {
  engine = new Engine(document.createElement("canvas"), false);
  engine.getCaps().parallelShaderCompile = undefined; // a shader is compiled when it is wanted
  scene = new Scene(engine);
  Object.assign(scene, { useRightHandedSystem: true, clearColor: new Color4(0, 0, 0, 0) });
  camera = new FixedCamera("eye", Vector3.Zero(), scene);
  white = new StandardMaterial("white", scene);
  Object.assign(white, { specularColor: Color3.Black(), backFaceCulling: false });
  return { version: Engine.Version, gl: engine._gl };
}

function light_of({ kind, position, direction, outer, near, far }) {
  const [place, way] = [Vector3.FromArray(position ?? [0, 0, 0]), Vector3.FromArray(direction ?? [0, -1, 0]).normalize()];
  const light =
    kind === "directional" ? new DirectionalLight("sun", way, scene)
    : kind === "spot" ? new SpotLight("spot", place, way, 2 * outer, 0, scene)
    : new PointLight("point", place, scene);
  // The image of a sun's light is fitted to the casters by Babylon.js itself, its depths by us: they have to hold all receivers.
  Object.assign(light, { position: place, specular: Color3.Black(), shadowMinZ: near, shadowMaxZ: far });
  light.setEnabled(false);
  return light;
}

export function relight({ meshes: given, ...facts }) {
  generator?.dispose();
  for (const light of Object.values(lights)) light.dispose();
  for (const mesh of meshes) mesh.dispose();
  lights = { true: light_of(facts), false: light_of(facts) };
  generator = made_of = undefined;
  meshes = given.map(({ positions, normals, casts, receives }) => {
    const mesh = Object.assign(new Mesh("mesh", scene), { material: white, receiveShadows: receives, casts });
    const indices = Uint32Array.from({ length: positions.length / 3 }, (_, i) => i);
    Object.assign(new VertexData(), { positions, normals, indices }).applyToMesh(mesh);
    return mesh;
  });
}

function make_generator(settings) {
  const { shadows, map_size, depth_bits } = settings;
  const Kind = shadows === "cascaded" ? CascadedShadowGenerator : ShadowGenerator;
  const made = new Kind(map_size, lights[true], depth_bits === "32");
  Object.assign(made, {
    filter: filters[shadows],
    filteringQuality: qualities[settings.quality],
    bias: settings.bias,
    normalBias: settings.normal_bias,
    contactHardeningLightSizeUVRatio: settings.light_size,
    depthScale: settings.depth_scale,
    blurScale: settings.blur_scale,
    blurBoxOffset: settings.blur_texels,
  });
  if (shadows === "cascaded") {
    const { cascades, split_blend, cascade_blend } = settings;
    Object.assign(made, { numCascades: cascades, lambda: split_blend, cascadeBlendPercentage: cascade_blend });
  }
  made.getShadowMap().renderList = meshes.filter(({ casts }) => casts);
  return made;
}

export function prepare({ width, height, camera: eye, shadows, settings }) {
  if (target?.getRenderWidth() !== width || target?.getRenderHeight() !== height) {
    target?.dispose();
    target = new RenderTargetTexture("picture", { width, height }, scene, { type: half_float, format: red, generateMipMaps: false });
    camera.outputRenderTarget = target;
  }
  camera.place(eye, width / height);
  scene.activeCamera = camera;
  const wanted = JSON.stringify(settings);
  if (wanted !== made_of) {
    generator?.dispose();
    generator = make_generator(settings);
    made_of = wanted;
  }
  if (settings.shadows === "cascaded") {
    generator.shadowMaxZ = eye.far;
    generator.splitFrustum();
  }
  for (const [has_shadows, light] of Object.entries(lights)) light.setEnabled(has_shadows === String(shadows));
}

export function draw() {
  engine.beginFrame();
  scene.render();
  engine.endFrame();
}

export const framebuffer = () => target.renderTarget._framebuffer;

export const is_ready = () => scene.isReady(true);
