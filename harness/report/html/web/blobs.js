// Pictures behind the script: base64 of deflated bytes, inflated by the browser when first shown.

const read = new Map();
const parsed =
  document.readyState === "loading" ? new Promise((done) => addEventListener("DOMContentLoaded", done)) : Promise.resolve();

function decoded(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; ++i) bytes[i] = letters.charCodeAt(i);
  return bytes;
}

async function inflated(number) {
  await parsed;
  const bytes = decoded(document.getElementById(`blob${number}`).textContent);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** The bytes of a picture. */
export function blob(number) {
  if (!read.has(number)) read.set(number, inflated(number));
  return read.get(number);
}

/**
 * Planes of bytes, frame after frame, each kept less the one before it, modulo 256; `size` bytes a frame. They are large, and
 * only the caller has them.
 */
export async function frames(number, size) {
  const bytes = await inflated(number);
  for (let i = size; i < bytes.length; ++i) bytes[i] += bytes[i - size];
  return bytes;
}

/** The number of each byte in a table of 256. Float32Array.from() with a function takes many times as long as the loop. */
function lookedUp(bytes, table) {
  const numbers = new Float32Array(bytes.length);
  for (let i = 0; i < bytes.length; ++i) numbers[i] = table[bytes[i]];
  return numbers;
}

const sharesOfBytes = Float32Array.from({ length: 256 }, (_, value) => value / 255);

/** Shares of the light, 0 .. 1, from numbers of 8 or 12 bits: the upper 8 of every pixel, then the lower 4, two pixels a byte. */
export async function shares(number, bits) {
  const bytes = await blob(number);
  if (bits === 8) return lookedUp(bytes, sharesOfBytes);
  const pixels = Math.floor((2 * bytes.length) / 3);
  const numbers = new Float32Array(pixels);
  for (let i = 0; i < pixels; ++i) {
    const two = bytes[pixels + (i >> 1)];
    numbers[i] = ((bytes[i] << 4) | (i % 2 ? two & 15 : two >> 4)) / 4095;
  }
  return numbers;
}

const standardErrors = Float32Array.from({ length: 256 }, (_, code) => (code ? 10 ** ((6 * (code - 255)) / 254) : 0));

/** Standard errors of one byte each: 0 is 0, the others are powers from 1e-6 to 1, off by 2.8 % at most. */
export async function errors(number) {
  return lookedUp(await blob(number), standardErrors);
}

/** Colors from three planes of differences: 3 bytes a pixel. */
export async function colors(number) {
  const planes = await blob(number);
  const pixels = planes.length / 3;
  const rgb = new Uint8Array(planes.length);
  for (let channel = 0; channel < 3; ++channel)
    for (let i = 0, value = 0; i < pixels; ++i) {
      value = (value + planes[channel * pixels + i]) & 255;
      rgb[3 * i + channel] = value;
    }
  return rgb;
}
