// SPDX-License-Identifier: Apache-2.0
// The shaders of the viewer. The first pass puts tiles of linear light where they are seen; the second
// develops them for the screen with the same formulas as core/image/display.cpp and srgb.cpp.

// A rectangle in pixels of the target, y downward; row 0 of the target is its top.
export const kPageVertex = `#version 300 es
uniform vec4 rect;
uniform vec2 target_size;
out vec2 uv;
void main() {
  uv = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  gl_Position = vec4(2.0 * mix(rect.xy, rect.zw, uv) / target_size - 1.0, 0.0, 1.0);
}`;

// Alpha is 1 where there are samples.
export const kPageFragment = `#version 300 es
precision highp float;
uniform highp sampler2D page;
in vec2 uv;
out vec4 light;
void main() {
  vec4 texel = texture(page, uv);
  if (texel.a == 0.0) discard;
  light = vec4(texel.a < 1.0 ? texel.rgb / texel.a : texel.rgb, 1.0);
}`;

export const kScreenVertex = `#version 300 es
void main() {
  gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0);
}`;

const kToneCurves = `
// Matrices with rows that sum to 1, as weights of channel differences: gray keeps its bits.
vec3 preserving_white(vec3 c, vec2 r, vec2 g, vec2 b) {
  return vec3(c.r + r.x * (c.g - c.r) + r.y * (c.b - c.r), c.g + g.x * (c.r - c.g) + g.y * (c.b - c.g),
              c.b + b.x * (c.r - c.b) + b.y * (c.g - c.b));
}

// Hill 2015.
vec3 aces(vec3 light) {
  vec3 v = preserving_white(light, vec2(0.35458, 0.04823), vec2(0.07600, 0.01566), vec2(0.02840, 0.13383));
  v = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
  return preserving_white(v, vec2(-0.53108, -0.07367), vec2(-0.10208, -0.00605), vec2(-0.00327, -0.07276));
}

// Wrensch 2023, after Sobotka.
vec3 agx(vec3 light) {
  vec3 v = preserving_white(light, vec2(0.0784336, 0.0792237), vec2(0.0423282, 0.0791661),
                            vec2(0.0423757, 0.0784336));
  vec3 stops = mix(vec3(-12.47393), log2(max(v, 1e-30)), greaterThan(v, vec3(0.0)));
  vec3 x = clamp((stops + 12.47393) / (4.026069 + 12.47393), 0.0, 1.0);
  x = (((((15.5 * x - 40.14) * x + 31.96) * x - 6.868) * x + 0.4298) * x + 0.1191) * x - 0.00232;
  x = preserving_white(x, vec2(-0.0980209, -0.0990297), vec2(-0.0528969, -0.0989612),
                       vec2(-0.0529716, -0.0980435));
  return pow(clamp(x, 0.0, 1.0), vec3(2.2));
}

// Khronos PBR Neutral (2024).
vec3 pbr_neutral(vec3 c) {
  const float start = 0.8 - 0.04, desaturation = 0.15;
  float darkest = min(c.r, min(c.g, c.b));
  c -= darkest < 0.08 ? darkest - 6.25 * darkest * darkest : 0.04;
  float peak = max(c.r, max(c.g, c.b));
  if (peak < start) return c;
  float d = 1.0 - start;
  float new_peak = 1.0 - d * d / (peak + d - start);
  c *= new_peak / peak;
  return mix(c, vec3(new_peak), 1.0 - 1.0 / (desaturation * (peak - new_peak) + 1.0));
}

// NaN becomes 0, as in display.cpp.
vec3 curve_input(vec3 light) {
  return mix(vec3(0.0), min(light, 1e6), greaterThan(light, vec3(0.0)));
}

vec3 tone_map(vec3 light) {
  if (curve == 0) return light;
  vec3 v = curve_input(light);
  return clamp(curve == 1 ? aces(v) : curve == 2 ? agx(v) : pbr_neutral(v), 0.0, 1.0);
}

vec3 srgb_encode(vec3 v) {
  v = clamp(curve_input(v), 0.0, 1.0);
  return mix(12.92 * v, 1.055 * pow(max(v, 1e-6), vec3(1.0 / 2.4)) - 0.055, greaterThan(v, vec3(0.0031308)));
}`;

const kFalseColour = `
float luminance(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }

// Turbo (Mikhailov 2019), a polynomial fit; encoded for the screen.
vec3 turbo(float x) {
  vec4 v4 = vec4(1.0, x, x * x, x * x * x);
  vec2 v2 = v4.zw * v4.z;
  vec3 low = vec3(dot(v4, vec4(0.13572138, 4.61539260, -42.66032258, 132.13108234)),
                  dot(v4, vec4(0.09140261, 2.19418839, 4.84296658, -14.18503333)),
                  dot(v4, vec4(0.10667330, 12.64194608, -60.58204836, 110.36276771)));
  vec3 high = vec3(dot(v2, vec2(-152.94239396, 59.28637943)), dot(v2, vec2(4.27729857, 2.82956604)),
                   dot(v2, vec2(-89.90310912, 27.34824973)));
  return clamp(low + high, 0.0, 1.0);
}

// Stops from -8 to +8 around 1.
vec3 false_colour(vec3 light) {
  return turbo(clamp((log2(max(luminance(light), 1e-12)) + 8.0) / 16.0, 0.0, 1.0));
}`;

export const kScreenFragment = `#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D image_a, image_b;
uniform int compare;      // 0: A alone; 1: A left of the split, B right of it; 2: |A - B|
uniform float split;      // in pixels of the target
uniform float scale;      // 2 to the power of the exposure
uniform int curve;        // 0: none, 1: aces, 2: agx, 3: PBR Neutral
uniform int channel;      // 0: RGB; 1, 2, 3: R, G, B; 4: luminance
uniform int is_false_colour;
uniform vec4 image_rect;  // in pixels of the target, y downward
uniform vec3 surround, unsampled;
uniform float target_height;
out vec4 colour;
${kToneCurves}
${kFalseColour}
vec3 chosen(vec3 c) {
  if (channel == 0) return c;
  return vec3(channel == 4 ? luminance(c) : channel == 1 ? c.r : channel == 2 ? c.g : c.b);
}

vec3 background(vec2 at) {
  bool is_inside = all(greaterThanEqual(at, image_rect.xy)) && all(lessThan(at, image_rect.zw));
  if (!is_inside) return surround;
  float stripe = step(0.5, fract((at.x + at.y) / 16.0));
  return unsampled * (0.92 + 0.08 * stripe);
}

void main() {
  vec2 at = vec2(gl_FragCoord.x, target_height - gl_FragCoord.y);
  ivec2 texel = ivec2(at);
  vec4 light = texelFetch(image_a, texel, 0);
  if (compare > 0) {
    vec4 other = texelFetch(image_b, texel, 0);
    if (compare == 2) light = vec4(abs(light.rgb - other.rgb), min(light.a, other.a));
    else if (at.x >= split) light = other;
  }
  if (light.a == 0.0) {
    colour = vec4(background(at), 1.0);
    return;
  }
  vec3 exposed = chosen(light.rgb) * scale;
  colour = vec4(is_false_colour == 1 ? false_colour(exposed) : srgb_encode(tone_map(exposed)), 1.0);
}`;
