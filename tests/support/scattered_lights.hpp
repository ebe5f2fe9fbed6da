// SPDX-License-Identifier: Apache-2.0
// Lights of every kind that has a place, strewn over a cube.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/lights/light.hpp"
#include "core/lights/light_tree.hpp"
#include "core/math/frame.hpp"
#include "core/sampling/sampler.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::test {

// Numbers in [0, 1), four for each index.
inline std::array<float, 4> numbers(int index, std::uint32_t kind) {
  return core::sampling::Sampler(77, index, 0, 0).pad(kind);
}

inline core::Vec3 point_in_cube(int index, std::uint32_t kind) {
  const auto u = numbers(index, kind);
  return core::Vec3{u[0], u[1], u[2]} * 20 - core::Vec3{10, 10, 10};
}

inline core::Vec3 direction(int index, std::uint32_t kind) {
  const auto u = numbers(index, kind);
  return core::sampling::sample_sphere({u[0], u[1]});
}

// Their brightness spans six orders of magnitude.
inline std::vector<core::lights::Light> scattered_lights(int count) {
  using namespace core;
  std::vector<core::lights::Light> lights;
  for (int i = 0; i < count; ++i) {
    const Vec3 p = point_in_cube(i, 0), front = direction(i, 1);
    const Frame frame = Frame::around(front);
    const float size = 0.05f + 0.5f * numbers(i, 2)[0], brightness = 1e-3f / (1e-6f + numbers(i, 2)[1]);
    const core::lights::SurfaceEmission emission{
        {Rgb::gray(brightness)}, static_cast<double>(brightness), i % 2 == 0};
    const Vec3 u = frame.tangent * size, v = frame.bitangent * size;
    switch (i % 5) {
      case 0:
        lights.emplace_back(
            core::lights::AreaLight(core::lights::TriangleLight{p, p + u, p + v}, front, emission));
        break;
      case 1:
        lights.emplace_back(core::lights::AreaLight(core::lights::QuadLight{p, u, v}, front, emission));
        break;
      case 2:
        lights.emplace_back(core::lights::AreaLight(core::lights::SphereLight{p, size}, {}, emission));
        break;
      case 3:
        lights.emplace_back(core::lights::PointLight(p, Rgb::gray(brightness)));
        break;
      default:
        lights.emplace_back(
            core::lights::SpotLight(p, Rgb::gray(brightness), {front, 10 + 160 * size, 0.3f}));
    }
  }
  return lights;
}

inline std::vector<core::lights::LightTree::Item> tree_items(const std::vector<core::lights::Light>& lights) {
  std::vector<core::lights::LightTree::Item> items;
  for (std::uint32_t i = 0; i < lights.size(); ++i)
    if (const auto bounds = core::lights::bounds(lights[i])) items.push_back({*bounds, i});
  return items;
}

// Every other one is lit on one side.
inline core::lights::LightSampleContext light_context(int index) {
  return {point_in_cube(index, 10), index % 2 == 0 ? direction(index, 11) : core::Vec3{}};
}

}  // namespace tessera::test
