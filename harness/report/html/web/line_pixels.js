// Lines of pixels through a picture.

/** A line where much happens, as two pixels {x, y}: along the row whose value changes most between shown neighbors, from
 *  somewhat before its first change to somewhat after its last one. */
export function suggestedLine({ width, height }, reference, isShown) {
  let best = { change: -1 };
  for (let y = 0; y < height; ++y) {
    let [change, first, last] = [0, null, null];
    for (let i = y * width + 1; i < (y + 1) * width; ++i) {
      if (!isShown(i) || !isShown(i - 1)) continue;
      const step = Math.abs(reference[i] - reference[i - 1]);
      change += step;
      if (step < 0.02) continue;
      first ??= i % width;
      last = i % width;
    }
    if (change > best.change && first !== null) best = { change, y, first, last };
  }
  const room = Math.ceil(0.06 * width);
  const from = Math.max(0, (best.first ?? Math.floor(width / 4)) - room);
  const to = Math.min(width - 1, (best.last ?? Math.floor((3 * width) / 4)) + room);
  return [from, to].map((x) => ({ x, y: best.y ?? Math.floor(height / 2) }));
}

/** The pixels from one end to the other, one for each step along the longer side: {x, y, i, distance}. */
export function pixelsOn([from, to], width) {
  const [dx, dy] = [to.x - from.x, to.y - from.y];
  const [steps, length] = [Math.max(Math.abs(dx), Math.abs(dy)), Math.hypot(dx, dy)];
  return Array.from({ length: steps + 1 }, (_, k) => {
    const share = steps ? k / steps : 0;
    const [x, y] = [Math.round(from.x + share * dx), Math.round(from.y + share * dy)];
    return { x, y, i: y * width + x, distance: share * length };
  });
}
