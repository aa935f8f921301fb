// Pictures behind the script: base64 of deflated bytes, inflated by the browser when first shown.

const read = new Map();
const parsed =
  document.readyState === "loading" ? new Promise((done) => addEventListener("DOMContentLoaded", done)) : Promise.resolve();

function decoded(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const letters = atob(text),
    bytes = new Uint8Array(letters.length);
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

/** Colors from three planes of differences: 3 bytes a pixel. */
export async function colors(number) {
  const planes = await blob(number);
  const pixels = planes.length / 3,
    rgb = new Uint8Array(planes.length);
  for (let channel = 0; channel < 3; ++channel)
    for (let i = 0, value = 0; i < pixels; ++i) {
      value = (value + planes[channel * pixels + i]) & 255;
      rgb[3 * i + channel] = value;
    }
  return rgb;
}
