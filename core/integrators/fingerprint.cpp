#include "core/integrators/fingerprint.hpp"

#include <fmt/format.h>
#include <xxhash.h>
#include <cassert>

#include "core/integrators/render.hpp"

namespace tessera::core {
namespace {

// A box open to the front with a lamp, a glass and a mirror sphere, seen through a lens: every kind of
// arithmetic that rendering has.
SceneDescription fingerprint_scene() {
  SceneDescription scene;
  scene.settings = {.width_px = 16, .height_px = 16, .spp = 8};
  scene.camera = {.position = {0, 1, 4}, .look_at = {0, 1, 0}, .aperture_radius = 0.05f, .focus_distance = 4};
  scene.materials = {{.name = "wall", .model = Lambert{{{0.7f, 0.5f, 0.3f}}}},
                     {.name = "lamp", .model = Lambert{}, .emission = {9, 8, 7}},
                     {.name = "glass", .model = Glass{}},
                     {.name = "mirror", .model = Mirror{}}};
  scene.shapes = {QuadDescription{{-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, 0},
                  QuadDescription{{-2, 0, -2}, {4, 0, 0}, {0, 3, 0}, 0},
                  QuadDescription{{-0.5f, 2.9f, -0.5f}, {1, 0, 0}, {0, 0, 1}, 1},
                  SphereDescription{{-0.7f, 0.6f, 0.3f}, 0.6f, 2},
                  SphereDescription{{0.8f, 0.7f, -0.5f}, 0.7f, 3},
                  SphereDescription{{1.3f, 2.2f, 0.5f}, 0.15f, 1}};
  return scene;
}

}  // namespace

std::string arithmetic_fingerprint() {
  const auto scene = Scene::build(fingerprint_scene(), 1);
  assert(scene.has_value());
  const RenderSettings& settings = scene->settings();
  const FilmTile tile =
      render(*scene, settings, {0, 0, settings.width_px, settings.height_px}, {0, settings.spp}, 1);
  return fmt::format("{:016x}", XXH3_64bits(tile.sums.data(), tile.sums.size() * sizeof(tile.sums[0])));
}

}  // namespace tessera::core
