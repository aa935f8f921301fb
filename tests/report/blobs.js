// Pictures of a report, as its data says that they are kept.

/** The bytes of a picture. */
export const bytesOf = (page, number) =>
  page.evaluate(async (number) => {
    const bytes = Uint8Array.from(atob(document.getElementById(`blob${number}`).textContent), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    return [...new Uint8Array(await new Response(stream).arrayBuffer())];
  }, number);

/** Shares of the light, 0 .. 1. */
export async function sharesOf(page, number, bits) {
  const bytes = await bytesOf(page, number);
  if (bits === 8) return bytes.map((value) => value / 255);
  const pixels = (2 * bytes.length) / 3;
  const low = (i) => (bytes[pixels + Math.floor(i / 2)] / (i % 2 ? 1 : 16)) & 15;
  return Array.from({ length: pixels }, (_, i) => (16 * bytes[i] + low(i)) / 4095);
}
