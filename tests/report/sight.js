// Colors as eyes see them: the same as in tests/unit/report/figure_style_test.cpp.

const product = (rows, v) => rows.map((row) => row.reduce((sum, value, k) => sum + value * v[k], 0));

const to_xyz = [
  [0.4124564, 0.3575761, 0.1804375],
  [0.2126729, 0.7151522, 0.0721750],
  [0.0193339, 0.1191920, 0.9503041],
];
const white = product(to_xyz, [1, 1, 1]);
const to_cones = [
  [17.8824, 43.5161, 4.11935],
  [3.45565, 27.1554, 3.86714],
  [0.0299566, 0.184309, 1.46709],
];
/** The inverse of to_cones. */
const from_cones = [
  [0.0809444479, -0.130504409, 0.116721066],
  [-0.0102485335, 0.0540193266, -0.113614708],
  [-0.000365296938, -0.00412161469, 0.693511405],
];

/** Linear RGB of "#0072b2" by the curve of sRGB (IEC 61966-2-1). */
const linear = (color) =>
  [1, 3, 5]
    .map((at) => parseInt(color.slice(at, at + 2), 16) / 255)
    .map((value) => (value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4));

/** CIE L*a*b* of 1976. */
function lab(rgb) {
  const inside = rgb.map((value) => Math.max(0, Math.min(1, value)));
  const shares = product(to_xyz, inside).map((value, k) => value / white[k]);
  const [x, y, z] = shares.map((s) => (s > 216 / 24389 ? Math.cbrt(s) : ((24389 / 27) * s + 16) / 116));
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

/** What people with all cones, without green and without red ones see (Vienot, Brettel and Mollon 1999). */
function seen(rgb) {
  const [l, m, s] = product(to_cones, rgb);
  const cones = [[l, 0.494207 * l + 1.24827 * s, s], [2.02344 * m - 2.52581 * s, m, s]];
  return [rgb, ...cones.map((cone) => product(from_cones, cone))];
}

/** The distance in CIE Lab to those eyes to which it is smallest. */
export function distance(a, b) {
  const [p, q] = [a, b].map((color) => seen(linear(color)).map(lab));
  return Math.min(...p.map((color, eyes) => Math.hypot(...color.map((value, k) => value - q[eyes][k]))));
}

/** The contrast of two colors, 1 to 21 (WCAG 2). */
export function contrast(a, b) {
  const [dark, light] = [a, b].map((color) => product(to_xyz, linear(color))[1]).sort((p, q) => p - q);
  return (light + 0.05) / (dark + 0.05);
}
