// Runs in the browser: what the pages of all engines share, geometry, the time of a frame, its picture.
//
// The page of an engine exports
//   start()           makes the engine; answers { version, gl: its WebGL context }
//   relight(request)  takes a light { kind, position, direction, inner, outer, near, far, settings }, angles in radians, and `meshes`:
//                     { casts, receives, positions, normals, ... }, three numbers a corner, the winding turned to the light
//   prepare(request)  takes the size, camera, settings and shadows (true or false) of frames
//   draw()            draws such a frame
//   framebuffer()     the framebuffer that it was drawn into: one number of 16 bits a pixel
//   is_ready()        optional: whether the last frame was drawn whole, with nothing left to compile

const lost = "WebGL's context is lost: its process ended, or had not enough memory for maps or picture";
let engine, gl;
let last; // what the last frame was of

export async function start(script) {
  engine = script;
  const { version, gl: context } = await engine.start();
  gl = context;
  const { UNMASKED_RENDERER_WEBGL } = gl.getExtension("WEBGL_debug_renderer_info");
  return { version, gl: gl.getParameter(UNMASKED_RENDERER_WEBGL) };
}

/** Takes geometry and light. `file` has the corners, then their normals; a part is { first, end, ... }, counted in triangles. */
export async function relight({ file, parts, ...light }) {
  const numbers = new Float32Array(await (await fetch(`data/${file}`, { cache: "no-store" })).arrayBuffer());
  const [positions, normals] = [numbers.subarray(0, numbers.length / 2), numbers.subarray(numbers.length / 2)];
  const cut = (of, { first, end }) => of.slice(9 * first, 9 * end);
  const meshes = parts.map((part) => ({ ...part, positions: cut(positions, part), normals: cut(normals, part) }));
  last = undefined;
  await engine.relight({ ...light, meshes });
}

function read(width, height) {
  const before = gl.getParameter(gl.READ_FRAMEBUFFER_BINDING);
  const picture = new Uint16Array(width * height);
  gl.bindFramebuffer(gl.READ_FRAMEBUFFER, engine.framebuffer());
  gl.pixelStorei(gl.PACK_ALIGNMENT, 2); // rows of 16-bit numbers are not padded
  gl.readPixels(0, 0, width, height, gl.RED, gl.HALF_FLOAT, picture);
  gl.bindFramebuffer(gl.READ_FRAMEBUFFER, before);
  return picture;
}

function timed_draw() {
  const start = performance.now();
  engine.draw();
  read(1, 1); // ends the frame
  return performance.now() - start;
}

/** Draws a frame of { width, height, camera: { world, fov_y_degrees, near, far }, shadows, settings }: { ms, picture }. */
export async function frame(request) {
  const { width, height, shadows, settings } = request;
  if (gl.isContextLost()) throw new Error(lost);
  const most = gl.getParameter(gl.MAX_TEXTURE_SIZE);
  if (Math.max(width, height, settings.map_size) > most) throw new Error(`pictures and maps have no more than ${most} texels a side`);
  await engine.prepare(request);
  // The first frame of its kind compiles, allocates, and goes through materials to find their shaders. A user does not switch shadows
  // on and off from frame to frame.
  const kind = JSON.stringify([width, height, shadows, settings]);
  if (kind !== last) {
    timed_draw();
    while (!(engine.is_ready?.() ?? true)) {
      await new Promise((done) => setTimeout(done, 1));
      timed_draw();
    }
  }
  last = kind;
  const ms = timed_draw();
  const picture = read(width, height);
  const fault = gl.getError();
  if (fault) throw new Error(gl.isContextLost() ? lost : `WebGL's error ${fault}`);
  return { ms, picture: new Uint8Array(picture.buffer).toBase64() };
}
