// SPDX-License-Identifier: Apache-2.0
#include "scenes/backdrops/backdrops.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/math/elementary.hpp"
#include "scenes/modelling/files.hpp"
#include "scenes/modelling/noise.hpp"
#include "scenes/modelling/painting.hpp"

namespace tessera::backdrops {
namespace {

using core::Rgb;
using core::Vec3;
using modelling::blend;
using modelling::smooth_step;
using modelling::srgb;

struct Stone {
  Rgb body, vein;
};

constexpr int kTiles = 8;

// Clouded, with thin veins where the noise crosses zero; each tile is another piece of the quarry.
Rgb polished(const Stone& stone, Vec3 p) {
  const float cloud = modelling::fractal_noise(p * 1.7f, 4);
  const float vein =
      1 - smooth_step(0, 0.06f, std::fabs(modelling::fractal_noise(p * 0.9f + Vec3{cloud, 7, 0}, 3)));
  return blend(stone.body, stone.vein, 0.55f * vein) * (1 + 0.14f * cloud);
}

core::Image tiles(const Stone& even, const Stone& odd, Rgb joint) {
  return modelling::paint(2048, 2048, [&](float u, float v) {
    const float x = u * kTiles, y = v * kTiles;
    const float column = std::floor(x), row = std::floor(y);
    const auto c = static_cast<int>(column), r = static_cast<int>(row);
    const float quarry = 40 * modelling::random_at(c, r, 5),
                tone = 0.94f + 0.1f * modelling::random_at(c, r, 6);
    const Rgb stone = polished((c + r) % 2 == 0 ? even : odd, {x, y, quarry}) * tone;
    const float across = x - column, along = y - row;
    const float from_edge = std::min(std::min(across, 1 - across), std::min(along, 1 - along));
    return blend(joint, stone, smooth_step(0.006f, 0.014f, from_edge));
  });
}

}  // namespace

core::Image terracotta_tiles() {
  const Stone ivory{srgb(0xe6dcc6), srgb(0xb59f7c)}, terracotta{srgb(0xa9512f), srgb(0x6f2f1c)};
  return tiles(terracotta, ivory, srgb(0x6b6156));
}

core::Image slate_tiles() {
  const Stone ivory{srgb(0xe9e4d8), srgb(0xb7ad9c)}, slate{srgb(0x2b3a4d), srgb(0x5c7187)};
  return tiles(slate, ivory, srgb(0x3a3a3c));
}

core::Image evening_sky() {
  const Rgb zenith{0.08f, 0.17f, 0.42f}, high{0.26f, 0.4f, 0.68f}, haze{0.62f, 0.55f, 0.6f};
  const Rgb horizon{0.95f, 0.56f, 0.34f}, glow{2.2f, 0.95f, 0.35f}, earth{0.05f, 0.045f, 0.04f};
  return modelling::paint(1024, 512, [&](float u, float v) {
    const float height = core::sin(core::kPi * (v - 0.5f));
    const float facing = 0.5f - 0.5f * core::cos(2 * core::kPi * u);  // 1 where the sun went down
    const float above = std::max(height, 0.0f);
    const Rgb low = blend(horizon, haze, smooth_step(0, 0.12f, above));
    Rgb sky = blend(blend(low, high, smooth_step(0.08f, 0.4f, above)), zenith, smooth_step(0.35f, 1, above));
    const float toward = facing * facing * facing;
    sky += glow * (toward * toward * (1 - smooth_step(0, 0.22f, above)));
    return blend(earth, sky, smooth_step(-0.02f, 0.01f, height));
  });
}

core::Result<core::Image> backdrop(std::string_view name) {
  if (name == "terracotta_tiles") return terracotta_tiles();
  if (name == "slate_tiles") return slate_tiles();
  if (name == "evening_sky") return evening_sky();
  return core::fail(core::ErrorCode::kInvalidArgument,
                    "there is no backdrop '" + std::string(name) +
                        "'; there are terracotta_tiles, slate_tiles and evening_sky");
}

}  // namespace tessera::backdrops
