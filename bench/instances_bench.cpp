// SPDX-License-Identifier: Apache-2.0
// The cost of instances: the ratio of rays per second in a two-level scene to those in the same scene
// flattened. 25 copies of a bumpy body of 69,000 triangles, rotated and scaled, on a plane. Then the samples
// per second of one body of each material, as a mesh and as an instance of that mesh that stands where it was
// modelled; and of a scene wholly of instances with a textured layered material.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <ctime>
#include <memory>
#include <optional>
#include <vector>

#include "bench/soups.hpp"
#include "core/integrators/render.hpp"
#include "core/math/transform.hpp"
#include "core/sampling/sampler.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core {
namespace {

constexpr int kSide = 5, kRows = 132, kImageSide = 512, kRounds = 9;
constexpr float kHalf = 1.2f * kSide;

std::vector<Transform> placements() {
  std::vector<Transform> all;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const auto u = sampling::Sampler(1, i, j, 0).pad(0);
      const float size = 0.8f + 0.4f * u[0];
      const Vec3 place{2.4f * (static_cast<float>(i) + 0.5f) - kHalf, size,
                       2.4f * (static_cast<float>(j) + 0.5f) - kHalf};
      all.push_back(compose(translation(place),
                            compose(scaling({size, size, size}),
                                    rotation({u[1] - 0.5f, u[2] - 0.5f, u[3] - 0.5f}, 360 * u[3]))));
    }
  return all;
}

void add_ground(Primitives& primitives) {
  constexpr float w = 2 * kHalf;
  primitives.add_mesh({{-w, 0, -w}, {-w, 0, w}, {w, 0, w}, {w, 0, -w}}, {}, {}, {{0, 1, 2}, {0, 2, 3}}, {0});
}

Primitives flat_scene(const Soup& body) {
  Primitives primitives;
  for (const Transform& transform : placements()) {
    std::vector<Vec3> positions;
    for (const Vec3 p : body.positions) positions.push_back(transform.point(p));
    primitives.add_mesh(positions, {}, {}, body.triangles, {0});
  }
  add_ground(primitives);
  return primitives;
}

Primitives scene_of_two_levels(const Soup& body) {
  Primitives primitives;
  add_ground(primitives);
  primitives.add_object(body.primitives());
  for (const Transform& transform : placements()) primitives.add_instance({Placement(transform), 0});
  return primitives;
}

double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

struct Level {
  explicit Level(Primitives made) : primitives(std::move(made)), bvh(accel::Bvh::build(primitives, 2)) {}

  Primitives primitives;
  accel::Bvh bvh;
};

// The batch size of a renderer with this many active paths.
constexpr std::size_t kBatch = 512;

std::size_t closest_one_by_one(const Level& level, const std::vector<Ray>& rays) {
  std::size_t hits = 0;
  for (const Ray& ray : rays) hits += level.bvh.closest_hit(level.primitives, ray).found();
  return hits;
}

std::size_t any_one_by_one(const Level& level, const std::vector<Ray>& rays) {
  std::size_t hits = 0;
  for (const Ray& ray : rays) hits += level.bvh.any_hit(level.primitives, ray);
  return hits;
}

std::size_t closest_in_batches(const Level& level, const std::vector<Ray>& rays) {
  const Columns<Ray> columns{std::span(rays)};
  Columns<Hit> answers(kBatch);
  std::size_t hits = 0;
  for (std::size_t i = 0; i < rays.size(); i += kBatch) {
    const std::size_t count = std::min(kBatch, rays.size() - i);
    level.bvh.closest_hits(level.primitives, columns.all().rows(i, count), answers.all().rows(0, count));
    for (std::size_t k = 0; k < count; ++k) hits += answers[k].found();
  }
  return hits;
}

std::size_t any_in_batches(const Level& level, const std::vector<Ray>& rays) {
  const Columns<Ray> columns{std::span(rays)};
  std::array<accel::Occlusion, kBatch> answers;
  std::size_t hits = 0;
  for (std::size_t i = 0; i < rays.size(); i += kBatch) {
    const std::size_t count = std::min(kBatch, rays.size() - i);
    level.bvh.occlusions(level.primitives, columns.all().rows(i, count), {answers.data(), count});
    for (std::size_t k = 0; k < count; ++k) hits += answers[k] != accel::Occlusion::kNone;
  }
  return hits;
}

using Query = std::size_t (*)(const Level&, const std::vector<Ray>&);

struct Measured {
  std::size_t hits;
  double mega_rays_per_second;
};

// Measures both variants interleaved; returns the median of each.
std::array<Measured, 2> measure(const std::array<const Level*, 2>& levels, const std::vector<Ray>& rays,
                                Query query) {
  std::array<std::vector<double>, 2> seconds;
  std::array<Measured, 2> measured{};
  for (int round = 0; round < kRounds; ++round)
    for (std::size_t i = 0; i < 2; ++i) {
      const double begin = cpu_seconds();
      measured[i].hits = query(*levels[i], rays);
      seconds[i].push_back(cpu_seconds() - begin);
    }
  for (std::size_t i = 0; i < 2; ++i) {
    std::nth_element(seconds[i].begin(), seconds[i].begin() + kRounds / 2, seconds[i].end());
    measured[i].mega_rays_per_second = static_cast<double>(rays.size()) / seconds[i][kRounds / 2] / 1e6;
  }
  return measured;
}

void run() {
  const Soup body = blobs(1, kRows);
  const Level flat(flat_scene(body)), two(scene_of_two_levels(body));
  fmt::print("{} triangles; trees: flat {:.1f} MiB, of two levels {:.1f} MiB\n", flat.primitives.count(),
             static_cast<double>(flat.bvh.memory_bytes()) / (1 << 20),
             static_cast<double>(two.bvh.memory_bytes()) / (1 << 20));
  Soup camera;
  camera.eye = {0.3f * kHalf, 0.9f * kHalf, 1.7f * kHalf};
  camera.look_at = {0, 0.1f * kHalf, 0};
  camera.lamp = {{kHalf, 2 * kHalf, kHalf}, 0.15f * kHalf};
  const RaySets rays = make_rays(camera, flat.primitives, flat.bvh, kImageSide);
  fmt::print(
      "| rays | asked | flat | two levels | ratio | hits, two levels less flat "
      "|\n|---|---|---|---|---|---|\n");
  const auto row = [&](const char* name, const char* asked, const std::vector<Ray>& set, Query query) {
    const auto [a, b] = measure({&flat, &two}, set, query);
    fmt::print("| {} | {} | {:.2f} | {:.2f} | {:.2f} | {} |\n", name, asked, a.mega_rays_per_second,
               b.mega_rays_per_second, b.mega_rays_per_second / a.mega_rays_per_second,
               static_cast<long>(b.hits) - static_cast<long>(a.hits));
  };
  row("primary", "one by one", rays.primary, closest_one_by_one);
  row("primary", "in batches", rays.primary, closest_in_batches);
  row("bounce", "one by one", rays.bounce, closest_one_by_one);
  row("bounce", "in batches", rays.bounce, closest_in_batches);
  row("shadow", "one by one", rays.shadow, any_one_by_one);
  row("shadow", "in batches", rays.shadow, any_in_batches);
}

// Shading: what an instance costs by its material.

// A checkered image.
Texture checks() {
  constexpr int kChecksSide = 64;
  std::vector<std::uint8_t> bytes;
  for (int y = 0; y < kChecksSide; ++y)
    for (int x = 0; x < kChecksSide; ++x)
      for (const int dark : {40, 90, 20})
        bytes.push_back(static_cast<std::uint8_t>((x / 4 + y / 4) % 2 == 0 ? 220 : dark));
  return {.image = std::make_shared<TextureImage>(kChecksSide, kChecksSide, bytes), .scale = {4, 4}};
}

MeshDescription mesh_of(const Soup& body) {
  MeshDescription mesh;
  mesh.positions = body.positions;
  mesh.triangles = body.triangles;
  mesh.triangle_materials = {0};
  for (const Vec3 p : body.positions) mesh.uvs.push_back({p.x, p.y + p.z});
  return mesh;
}

// A body on a plane under a lamp and an even sky. Texture 0 is the checks.
SceneDescription lit_scene(const Material& material) {
  constexpr float w = 2 * kHalf;
  SceneDescription scene;
  scene.settings = {.width_px = 256, .height_px = 256};
  scene.camera = {.position = {0, 1.5f, 4}, .look_at = {0, 1, 0}};
  scene.textures = {checks()};
  scene.materials = {material, {.name = "lamp", .model = Lambert{}, .emission = {{20, 20, 20}}}};
  scene.shapes = {QuadDescription{{-w, -1, w}, {2 * w, 0, 0}, {0, 0, -2 * w}, 0},
                  SphereDescription{{4, 8, 4}, 1, 1}};
  scene.environment = EnvironmentDescription{.radiance = {Rgb::gray(0.5f)}};
  return scene;
}

SceneDescription with_mesh(const Material& material, const MeshDescription& mesh) {
  SceneDescription scene = lit_scene(material);
  scene.shapes.push_back(mesh);
  return scene;
}

SceneDescription with_instances(const Material& material, const MeshDescription& mesh,
                                const std::vector<Transform>& transforms) {
  SceneDescription scene = lit_scene(material);
  scene.objects = {{.name = "body", .shapes = {mesh}, .shape_names = {}}};
  for (const Transform& transform : transforms)
    scene.shapes.push_back(InstanceDescription{.object = 0, .to_world = transform, .material = std::nullopt});
  return scene;
}

std::vector<Material> materials() {
  const Principled textured{.base_color = {Rgb::gray(1), 0}, .specular_roughness = {0.5f, 0}};
  Principled coated = textured;
  coated.coat_weight = 0.5f;
  coated.base_metalness = 0.5f;
  return {{.name = "lambert", .model = Lambert{}},
          {.name = "lambert, textured", .model = Lambert{{Rgb::gray(1), 0}}},
          {.name = "lambert, normal map", .model = Lambert{}, .normal_map = {0, 0.2f}},
          {.name = "cook_torrance", .model = CookTorrance{.diffuse = {Rgb::gray(0.4f)}}},
          {.name = "phong", .model = Phong{}},
          {.name = "phong, specular 0", .model = Phong{.specular = {Rgb{}}}},
          {.name = "plastic", .model = Plastic{.roughness = 0.4f}},
          {.name = "conductor", .model = ConductorMaterial{.k = {Rgb::gray(4)}, .roughness = 0.4f}},
          {.name = "principled", .model = Principled{}},
          {.name = "principled, textured", .model = textured},
          {.name = "principled, coat and metal", .model = coated},
          {.name = "diffuse_transmission", .model = DiffuseTransmission{}},
          {.name = "glass, rough", .model = Glass{.roughness = 0.4f}},
          {.name = "mirror", .model = Mirror{}}};
}

// The medians of the samples per second of each scene, by one thread, in interleaved runs.
std::vector<double> mega_samples_per_second(const std::vector<Scene>& scenes, int rounds) {
  constexpr std::uint32_t kSamples = 4;
  std::vector<integrators::RenderPlan> plans;
  for (const Scene& scene : scenes) plans.push_back(integrators::prepare(scene, scene.settings(), 1));
  std::vector<std::vector<double>> seconds(scenes.size());
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      const RenderSettings& settings = scenes[i].settings();
      const double begin = cpu_seconds();
      render(plans[i], {0, 0, settings.width_px, settings.height_px}, {0, kSamples}, 1);
      seconds[i].push_back(cpu_seconds() - begin);
    }
  std::vector<double> speeds;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    auto& all = seconds[i];
    std::nth_element(all.begin(), all.begin() + rounds / 2, all.end());
    const RenderSettings& settings = scenes[i].settings();
    speeds.push_back(settings.width_px * settings.height_px * static_cast<double>(kSamples) / 1e6 /
                     all[static_cast<std::size_t>(rounds) / 2]);
  }
  return speeds;
}

void compare_shading() {
  constexpr int kShadingRounds = 5;
  const MeshDescription mesh = mesh_of(blobs(1, kRows));
  fmt::print("| material | mesh, M samples/s | identity instance | time ratio |\n|---|---|---|---|\n");
  for (const Material& material : materials()) {
    std::vector<Scene> scenes;
    scenes.push_back(Scene::build(with_mesh(material, mesh), 2).value());
    scenes.push_back(Scene::build(with_instances(material, mesh, {Transform{}}), 2).value());
    const auto speeds = mega_samples_per_second(scenes, kShadingRounds);
    fmt::print("| {} | {:.3f} | {:.3f} | {:.2f} |\n", material.name, speeds[0], speeds[1],
               speeds[0] / speeds[1]);
  }
  const Material textured = materials()[9];
  std::vector<Scene> scenes;
  scenes.push_back(Scene::build(with_instances(textured, mesh, placements()), 2).value());
  fmt::print("25 instances, {}: {:.3f} M samples/s\n", textured.name,
             mega_samples_per_second(scenes, kShadingRounds)[0]);
}

}  // namespace
}  // namespace tessera::core

int main() {
  tessera::core::compare_shading();
  tessera::core::run();
}
