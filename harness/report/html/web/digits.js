// The same rounding as the tables of the program (harness/report/table/digits.h), for numbers that only the page makes: means,
// shares of a picture, ticks.

/** Without exponent, to `significant` digits; digits before the point are never dropped. */
export function rounded(value, significant) {
  if (value === 0) return "0";
  const decimalsFor = (x) => Math.max(0, significant - 1 - Math.floor(Math.log10(Math.abs(x))));
  let decimals = Math.min(decimalsFor(value), 20);
  const after = Number(value.toFixed(decimals));
  if (after !== 0) decimals = Math.min(decimalsFor(after), 20);
  return value.toFixed(decimals);
}

export function measured(value) {
  const size = Math.abs(value);
  if (size >= 0.995 && size < 1) return value < 0 ? "-1.00" : "1.00";
  return rounded(value, size < 1 ? 2 : 3);
}

export const milliseconds = (value) => (value > 0 && value < 0.001 ? "<0.001" : rounded(value, 3));

/** A share of 1 in percent. */
export const percent = (share) => `${measured(100 * share)} %`;

/** A tick of an axis: no digits that say nothing. */
export function tick(value) {
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e9) return `${Number((value / 1e9).toPrecision(3))} G`;
  if (size >= 1e6) return `${Number((value / 1e6).toPrecision(3))} M`;
  if (size >= 1e4) return `${Number((value / 1e3).toPrecision(3))} k`;
  return String(Number(value.toPrecision(3)));
}
