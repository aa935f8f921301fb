// Lines of pixels through a picture.

/** A line where much happens: along the row that goes up and down most from pixel to pixel, both shown, from somewhat before its
 *  first change to somewhat after its last one; two pixels {x, y}. */
export function suggestedLine({ width, height }, reference, isShown) {
  let best = { change: -1 };
  for (let y = 0; y < height; ++y) {
    let change = 0,
      first = null,
      last = null;
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
  const y = best.y ?? Math.floor(height / 2),
    room = Math.ceil(0.06 * width);
  const from = Math.max(0, (best.first ?? Math.floor(width / 4)) - room),
    to = Math.min(width - 1, (best.last ?? Math.floor((3 * width) / 4)) + room);
  return [
    { x: from, y },
    { x: to, y },
  ];
}

/** The pixels from one end to the other, one for each step along the longer side: {x, y, i, distance}. */
export function pixelsOn([from, to], width) {
  const dx = to.x - from.x,
    dy = to.y - from.y;
  const steps = Math.max(Math.abs(dx), Math.abs(dy)),
    length = Math.hypot(dx, dy);
  return Array.from({ length: steps + 1 }, (_, k) => {
    const share = steps ? k / steps : 0;
    const x = Math.round(from.x + share * dx),
      y = Math.round(from.y + share * dy);
    return { x, y, i: y * width + x, distance: share * length };
  });
}
