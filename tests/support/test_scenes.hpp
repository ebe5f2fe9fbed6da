// SPDX-License-Identifier: Apache-2.0
// Small scenes that several tests render, built without files.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/scene/description.hpp"
#include "core/scene/scene.hpp"

namespace tessera::test {

// Collects materials and shapes of a description.
class SceneMaker {
 public:
  explicit SceneMaker(core::CameraDescription camera) { description_.camera = camera; }

  std::uint32_t material(core::MaterialModel model, core::Rgb emission = {}, bool two_sided = true) {
    const std::string name = "m" + std::to_string(description_.materials.size());
    description_.materials.push_back({name, std::move(model), {emission}, two_sided});
    return static_cast<std::uint32_t>(description_.materials.size() - 1);
  }
  void add(core::ShapeDescription shape) { description_.shapes.push_back(std::move(shape)); }

  core::SceneDescription& description() { return description_; }

  // Fails the process with the error's sentence if the scene is wrong.
  core::Scene build() const { return core::Scene::build(description_, 1).value(); }

 private:
  core::SceneDescription description_;
};

inline core::Lambert lambert(float albedo) {
  return core::Lambert{{core::Rgb::gray(albedo), -1}};
}

// A room lit by a quad, with a diffuse, a mirror and a glass sphere, and an emissive one.
inline core::SceneDescription room() {
  SceneMaker maker({.position = {0, 1, 3.8f}, .look_at = {0, 1, 0}, .aperture_radius = 0.03f});
  const auto white = maker.material(lambert(0.7f));
  const auto red = maker.material(core::Lambert{{{0.6f, 0.1f, 0.1f}, -1}});
  const auto lamp = maker.material(lambert(0), {12, 11, 9}, false);
  const auto ember = maker.material(lambert(0.2f), {3, 1, 0.3f});
  const auto mirror = maker.material(core::Mirror{{{0.9f, 0.9f, 0.8f}, -1}});
  const auto glass = maker.material(core::Glass{});
  maker.add(core::QuadDescription{{-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, white});  // floor
  maker.add(core::QuadDescription{{-1, 2, 1}, {0, 0, -2}, {2, 0, 0}, white});  // ceiling
  maker.add(core::QuadDescription{{-1, 0, -1}, {2, 0, 0}, {0, 2, 0}, white});  // back
  maker.add(core::QuadDescription{{-1, 0, 1}, {0, 0, -2}, {0, 2, 0}, red});    // left
  maker.add(core::QuadDescription{{1, 0, 1}, {0, 2, 0}, {0, 0, -2}, white});   // right
  maker.add(core::QuadDescription{{-0.3f, 1.99f, -0.3f}, {0.6f, 0, 0}, {0, 0, 0.6f}, lamp});
  maker.add(core::SphereDescription{{-0.5f, 0.35f, -0.4f}, 0.35f, mirror});
  maker.add(core::SphereDescription{{0.45f, 0.35f, 0.2f}, 0.35f, glass});
  maker.add(core::SphereDescription{{0.1f, 0.12f, 0.6f}, 0.12f, ember});
  maker.description().settings = {.width_px = 48, .height_px = 32, .spp = 16};
  return maker.description();
}

}  // namespace tessera::test
