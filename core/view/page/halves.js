// SPDX-License-Identifier: Apache-2.0
// Half floats and colour scales, as numbers.

const float = new Float32Array(1);
const bits = new Uint32Array(float.buffer);

// The bits of the half float that equals `value`; values that no half float equals are rounded toward zero.
export function toHalf(value) {
  float[0] = value;
  const sign = (bits[0] >>> 16) & 0x8000;
  const exponent = (bits[0] >>> 23) & 0xff,
    fraction = bits[0] & 0x7fffff;
  if (exponent === 0xff) return sign | 0x7c00 | (fraction ? 0x200 : 0);
  if (exponent > 142) return sign | 0x7bff;
  if (exponent >= 113) return sign | ((exponent - 112) << 10) | (fraction >>> 13);
  if (exponent < 102) return sign;
  return sign | ((fraction | 0x800000) >>> (126 - exponent));
}

// Turbo (Mikhailov 2019), as in shaders.js.
export function turbo(x) {
  const polynomial = (c) => c.reduceRight((sum, a) => sum * x + a, 0);
  return [
    [0.13572138, 4.6153926, -42.66032258, 132.13108234, -152.94239396, 59.28637943],
    [0.09140261, 2.19418839, 4.84296658, -14.18503333, 4.27729857, 2.82956604],
    [0.1066733, 12.64194608, -60.58204836, 110.36276771, -89.90310912, 27.34824973],
  ].map((c) => Math.round(255 * Math.max(0, Math.min(1, polynomial(c)))));
}

// Dark blue over green to yellow, of even lightness steps: for quantities.
const kSequential = [
  [33, 30, 74],
  [52, 81, 139],
  [40, 128, 139],
  [56, 174, 110],
  [166, 214, 70],
  [250, 231, 90],
];
export function sequential(x) {
  const at = Math.max(0, Math.min(1, x)) * (kSequential.length - 1);
  const i = Math.min(kSequential.length - 2, Math.floor(at));
  return kSequential[i].map((from, c) => Math.round(from + (kSequential[i + 1][c] - from) * (at - i)));
}

// Distinct also for most colour-blind people (after Okabe and Ito 2008).
const kCategories = [
  [230, 159, 0],
  [86, 180, 233],
  [0, 158, 115],
  [240, 228, 66],
  [0, 114, 178],
  [213, 94, 0],
  [204, 121, 167],
  [160, 160, 160],
  [120, 94, 240],
  [165, 214, 167],
];
export const category = (index) => kCategories[index % kCategories.length];

export const css = (rgb) => `rgb(${rgb.join(',')})`;
