// SPDX-License-Identifier: Apache-2.0
#include "scenes/still_life/mosaic_vase.hpp"

#include <array>
#include <cmath>
#include <cstdint>

#include "scenes/modelling/files.hpp"
#include "scenes/modelling/lathe.hpp"
#include "scenes/modelling/noise.hpp"

namespace tessera::still_life {
namespace {

using core::Rgb;
using core::Vec2;
using core::Vec3;
using modelling::Profile;
using modelling::random_at;
using modelling::srgb;

constexpr int kColumns = 96, kRows = 66;  // of stones
constexpr float kJoint = 0.1f;            // half the mortar's width, as a share of a stone's place
// Stones by their texture, and gold as a mirror: its reflectance at normal incidence.
constexpr const char* kMaterials = R"(newmtl stone
Kd 1 1 1
map_Kd vase.png

newmtl gold
illum 3
Ks 1 0.78 0.34
)";

constexpr std::size_t kFirstPoint = 3, kLastPoint = 15;  // of the profile, between which stones are set

Profile vase_profile() {
  return Profile({{0, 0},       {3.2f, 0},     {4.6f, 0.15f}, {5, 0.6f},       {4.7f, 1.4f},  {5.4f, 3.2f},
                  {7.2f, 7},    {8.5f, 11},    {8.6f, 14.6f}, {7.4f, 18.2f},   {5.4f, 20.9f}, {4.2f, 23},
                  {3.9f, 25},   {4.3f, 26.6f}, {5.1f, 27.5f}, {5.35f, 27.85f}, {5.1f, 28},    {4.1f, 26.8f},
                  {3.4f, 25},   {3.6f, 23.2f}, {4.8f, 20.6f}, {6.8f, 17.9f},   {8, 14.6f},    {7.9f, 11},
                  {6.6f, 7.2f}, {4.7f, 3.4f},  {3, 1.6f},     {0, 1.2f}});
}

enum class Stone { kIndigo, kBlue, kTurquoise, kCream, kGold };

// Overlapping scales with concentric rings, the pattern that Japanese potters call blue sea waves. The lower
// a scale, the nearer: it covers those above it.
Stone wave(int column, int row) {
  constexpr int kWidth = 16, kRise = 5;
  constexpr float kRadius = 8.2f;
  for (int scale_row = 0; scale_row * kRise <= row + kRise; ++scale_row) {
    const int shift = scale_row % 2 * kWidth / 2;
    const float dx = static_cast<float>((column + shift) % kWidth - kWidth / 2) + 0.5f;
    const float dy = static_cast<float>(row - (scale_row - 1) * kRise) + 0.5f;
    const float distance = std::sqrt(dx * dx + dy * dy);
    if (dy < 0 || distance > kRadius) continue;
    return distance > 7      ? Stone::kCream
           : distance > 5.6f ? Stone::kIndigo
           : distance > 4.2f ? Stone::kBlue
           : distance > 2.8f ? Stone::kTurquoise
                             : Stone::kGold;
  }
  return Stone::kIndigo;
}

// What is set in a place; rows count from the foot.
Stone stone_at(int column, int row) {
  constexpr int kWavesBegin = 7, kWavesEnd = 42, kTeethEnd = 50;
  if (row < 5) return Stone::kIndigo;
  if (row == 5 || row == kWavesEnd + 1 || row == kTeethEnd || row >= kRows - 2) return Stone::kGold;
  if (row < kWavesBegin || row == kWavesEnd || row == kWavesEnd + 2) return Stone::kCream;
  if (row < kWavesEnd) return wave(column, row - kWavesBegin);
  if (row < kTeethEnd) return column % 8 < kTeethEnd - row ? Stone::kTurquoise : Stone::kCream;
  const float height = static_cast<float>(row - kTeethEnd) / (kRows - 2 - kTeethEnd);
  const float chance = random_at(column, row, 1);
  if (chance < 0.04f) return Stone::kGold;
  return chance < 0.2f + 0.75f * height ? Stone::kIndigo : Stone::kBlue;
}

// No two stones are cut from one piece: each is a little lighter, darker or greener than its neighbour.
Rgb stone_color(Stone stone, int column, int row) {
  static const std::array<Rgb, 5> kColors{srgb(0x1d2f5e), srgb(0x2f62a3), srgb(0x3fa3a6), srgb(0xe9dfc6),
                                          srgb(0xc79a3b)};
  const Rgb base = kColors[static_cast<std::size_t>(stone)];
  const float light = 0.72f + 0.5f * random_at(column, row, 2),
              hue = 0.16f * (random_at(column, row, 3) - 0.5f);
  return {base.r * light * (1 - hue), base.g * light * (1 + hue), base.b * light};
}

// A place among the stones: which one, and where in it, x and y in [0, 1).
struct Place {
  int column, row;
  Vec2 inside;

  bool on_stone() const {
    return inside.x > kJoint && inside.x < 1 - kJoint && inside.y > kJoint && inside.y < 1 - kJoint;
  }
};

class Mosaic {
 public:
  explicit Mosaic(const Profile& profile)
      : v_begin_(profile.fraction_of_point(kFirstPoint)), v_end_(profile.fraction_of_point(kLastPoint)) {}

  bool covers(Vec2 uv) const { return uv.y > v_begin_ && uv.y < v_end_; }

  // Where covers(uv).
  Place place(Vec2 uv) const {
    const float x = uv.x * kColumns, y = (uv.y - v_begin_) / (v_end_ - v_begin_) * kRows;
    const float column = std::floor(x), row = std::floor(y);
    return {static_cast<int>(column) % kColumns, static_cast<int>(row), {x - column, y - row}};
  }

  // Mortar and the two edges of every stone; coarser where there are none.
  modelling::GridLines lines() const {
    constexpr std::array<float, 3> kInside{0, 1.5f * kJoint, 1 - 1.5f * kJoint};
    modelling::GridLines lines{{}, {}, true};
    for (int i = 0; i < kColumns; ++i) {
      for (const float x : kInside) lines.u.push_back((static_cast<float>(i) + x) / kColumns);
    }
    lines.u.push_back(1);
    constexpr int kBelow = 8, kAbove = 40;
    for (int i = 0; i < kBelow; ++i) lines.v.push_back(v_begin_ * static_cast<float>(i) / kBelow);
    for (int i = 0; i < kRows; ++i) {
      for (const float y : kInside) {
        lines.v.push_back(v_begin_ + (v_end_ - v_begin_) * (static_cast<float>(i) + y) / kRows);
      }
    }
    for (int i = 0; i < kAbove; ++i)
      lines.v.push_back(v_end_ + (1 - v_end_) * static_cast<float>(i) / kAbove);
    lines.v.push_back(1);
    return lines;
  }

 private:
  float v_begin_, v_end_;
};

// Stones stand out of the mortar and lean a little, each its own way.
float stone_height(const Place& place) {
  constexpr float kOut = 0.07f, kLean = 0.11f;
  if (!place.on_stone()) return 0;
  const float lean_x = random_at(place.column, place.row, 4) - 0.5f;
  const float lean_y = random_at(place.column, place.row, 5) - 0.5f;
  return kOut + kLean * (lean_x * (place.inside.x - 0.5f) + lean_y * (place.inside.y - 0.5f));
}

core::MeshDescription vase_mesh(const Profile& profile, const Mosaic& mosaic) {
  // Rows waver, as a hand sets them.
  core::MeshDescription mesh = modelling::grid_mesh(mosaic.lines(), [&](float u, float v) {
    const Vec3 p = modelling::revolve(profile.at(v), u);
    if (!mosaic.covers({u, v})) return p;
    const float along = 0.14f / kColumns * modelling::noise(p * 1.3f);
    const float up = 0.14f / (2 * kRows) * modelling::noise(p * 1.3f + Vec3{50, 0, 0});
    return modelling::revolve(profile.at(v + up), u + along);
  });
  modelling::displace(mesh,
                      [&](Vec3, Vec2 uv) { return mosaic.covers(uv) ? stone_height(mosaic.place(uv)) : 0; });
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec2 center = (mesh.uvs[a] + mesh.uvs[b] + mesh.uvs[c]) * (1.0f / 3);
    const Place place = mosaic.covers(center) ? mosaic.place(center) : Place{0, 0, {0, 0}};
    const bool gold = place.on_stone() && stone_at(place.column, place.row) == Stone::kGold;
    mesh.triangle_materials.push_back(gold ? 1 : 0);
  }
  return mesh;
}

core::Image vase_texture(const Profile& profile, const Mosaic& mosaic) {
  const Rgb mortar = srgb(0x8c8375), clay = srgb(0x9a6b4f);
  return modelling::paint(kColumns * 20, 1536, [&](float u, float v) {
    const Vec3 p = modelling::revolve(profile.at(v), u);
    const float grain = 1 + 0.12f * modelling::fractal_noise(p * 6, 3);
    if (!mosaic.covers({u, v})) return clay * grain;
    const Place place = mosaic.place({u, v});
    if (!place.on_stone()) return mortar * grain;
    return stone_color(stone_at(place.column, place.row), place.column, place.row) * grain;
  });
}

}  // namespace

Model mosaic_vase() {
  const Profile profile = vase_profile();
  const Mosaic mosaic(profile);
  return {vase_mesh(profile, mosaic), {"stone", "gold"}, kMaterials, vase_texture(profile, mosaic)};
}

}  // namespace tessera::still_life
