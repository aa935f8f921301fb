// Lines along which a picture has one value, traced through the cells between the centers of its pixels.

/**
 * By the corners that are at the level or above (bits: left top, right top, right bottom, left bottom): the sides of the cell
 * that a line joins: 0 top, 1 right, 2 bottom, 3 left. Null where there is no line, or two.
 */
const joins = [null, [3, 0], [0, 1], [3, 1], [1, 2], null, [0, 2], [3, 2], [2, 3], [2, 0], null, [2, 1], [1, 3], [1, 0], [0, 3], null];

/**
 * The level's lines as lists of points [x, y] in pixels, (0.5, 0.5) the first pixel's center; a closed line ends where it
 * begins. A cell between four centers has lines where `isShown(i)` is true of all four pixels. In a cell with two lines the mean
 * of the corners decides which of the sides each line joins.
 */
export function isolines({ width, height }, mask, level, isShown) {
  // From the side of a cell to one or two others. A side's number is that of its first pixel, twice, plus 1 where it goes down.
  const links = new Map();
  const link = (p, q) => {
    for (const [from, to] of [[p, q], [q, p]]) {
      if (links.has(from)) links.get(from).push(to);
      else links.set(from, [to]);
    }
  };
  for (let y = 0; y + 1 < height; ++y)
    for (let x = 0; x + 1 < width; ++x) {
      const i = y * width + x;
      const corners = [i, i + 1, i + width + 1, i + width];
      const above = corners.reduce((bits, k, bit) => bits | (mask[k] >= level ? 1 << bit : 0), 0);
      if (above === 0 || above === 15 || !corners.every(isShown)) continue;
      const sides = [2 * i, 2 * (i + 1) + 1, 2 * (i + width), 2 * i + 1];
      if (joins[above]) {
        link(sides[joins[above][0]], sides[joins[above][1]]);
        continue;
      }
      const is_joined = corners.reduce((sum, k) => sum + mask[k], 0) >= 4 * level;
      const splits = (above === 5) === is_joined ? [0, 1, 2, 3] : [3, 0, 1, 2];
      link(sides[splits[0]], sides[splits[1]]);
      link(sides[splits[2]], sides[splits[3]]);
    }
  const point = (side) => {
    const i = side >> 1;
    const other = side % 2 ? i + width : i + 1;
    const part = (level - mask[i]) / (mask[other] - mask[i]);
    const [x, y] = [(i % width) + 0.5, Math.floor(i / width) + 0.5];
    return side % 2 ? [x, y + part] : [x + part, y];
  };
  const lines = [];
  const follow = (start) => {
    const line = [point(start)];
    for (let at = start; links.get(at)?.length; ) {
      const next = links.get(at).pop();
      const back = links.get(next);
      back.splice(back.indexOf(at), 1);
      line.push(point(next));
      at = next;
    }
    if (line.length > 1) lines.push(line);
  };
  for (const [side, others] of links) if (others.length === 1) follow(side);
  for (const side of links.keys()) follow(side);
  return lines;
}
