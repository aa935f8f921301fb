// The same rounding as the tables of the program (harness/report/table/digits.h), for numbers that only the page makes: means,
// shares of a picture, ticks.

/** Without exponent, to `significant` digits; digits before the point are never dropped. */
export function rounded(value, significant) {
  if (value === 0) return "0";
  const decimalsFor = (x) => Math.min(20, Math.max(0, significant - 1 - Math.floor(Math.log10(Math.abs(x)))));
  const after = Number(value.toFixed(decimalsFor(value)));
  return value.toFixed(decimalsFor(after === 0 ? value : after));
}

export function measured(value) {
  const size = Math.abs(value);
  if (size >= 0.995 && size < 1) return value < 0 ? "-1.00" : "1.00";
  return rounded(value, size < 1 ? 2 : 3);
}

export const milliseconds = (value) => (value > 0 && value < 0.001 ? "<0.001" : rounded(value, 3));

/** A share of 1 in percent. */
export const percent = (share) => `${measured(100 * share)} %`;

/** A tick of an axis, to three digits without zeros behind the point. */
export function tick(value) {
  if (value === 0) return "0";
  const size = Math.abs(value);
  const short = (unit) => Number((value / unit).toPrecision(3));
  if (size >= 1e9) return `${short(1e9)} G`;
  if (size >= 1e6) return `${short(1e6)} M`;
  return size >= 1e4 ? `${short(1e3)} k` : String(short(1));
}
