// SPDX-License-Identifier: Apache-2.0
// Numbers for people: three digits and a prefix, so that a small part reads in mm and its gaps in um.

const prefixes = [[1e9, 'G'], [1e6, 'M'], [1e3, 'k'], [1, ''], [1e-3, 'm'], [1e-6, '\u00b5'], [1e-9, 'n']];

export function si(x, unit, digits = 3) {
  if (!Number.isFinite(x)) return '\u2013';
  if (x === 0) return `0 ${unit}`;
  const [factor, prefix] = prefixes.find(([f]) => Math.abs(x) >= 0.9995 * f) ?? prefixes.at(-1);
  const scaled = x / factor;
  return Math.abs(scaled) < 0.01 ? `0 ${unit}` : `${scaled.toPrecision(digits)} ${prefix}${unit}`;
}

export const power = x => !Number.isFinite(x) ? '\u2013' : x === 0 ? '0' : x.toExponential(1);
