// SPDX-License-Identifier: Apache-2.0
// What compares vertices in lanes with what each is alone, of a scene of all materials and shapes.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "core/integrators/fingerprint.hpp"
#include "core/integrators/path_wavelength.hpp"
#include "core/integrators/shading_bins.hpp"
#include "core/integrators/vertex_batch.hpp"

namespace tessera::core::integrators {

class VertexLanes : public testing::Test {
 protected:
  explicit VertexLanes(const SceneDescription& scene = fingerprint_scene())
      : scene_(Scene::build(scene, 1).value()) {}

  static bool has(MaskN mask, std::size_t lane) { return (mask.bits() >> lane & 1) != 0; }
  template <Kernel kKernel>
  static bool is_of(const Material& material) {
    return kernel_of(material) == kKernel;
  }

  float random() { return std::uniform_real_distribution<float>(0, 1)(generator_); }
  Vec3 random_point() { return {3 * random() - 1.5f, 3 * random(), 4 * random() - 2}; }

  // Rays and what they hit.
  struct Observations {
    std::array<Ray, kLaneCount> rays;
    std::array<Hit, kLaneCount> hits;
  };
  // Only those that `wanted` accepts.
  template <typename Wanted>
  Observations look(const Wanted& wanted) {
    Observations observations;
    for (std::size_t lane = 0; lane < kLaneCount;) {
      const Ray ray{random_point(), random_point()};
      const Hit hit = scene_.bvh().closest_hit(scene_.primitives(), ray);
      if (!hit.found() || !wanted(ray, hit)) continue;
      observations.rays[lane] = ray;
      observations.hits[lane++] = hit;
    }
    return observations;
  }
  const Material& scatterer(const Ray& ray, const Hit& hit) const {
    return scatterer_of(scene_, hit, scene_.primitives().surface(ray, hit), normalize(-ray.direction));
  }

  // Compares the vertices that vertices_of() makes of a batch with those that each ray makes alone.
  template <typename VerticesOf>
  void compare_batch(const Observations& observations, bool plain_triangles, const VerticesOf& vertices_of) {
    const Columns<Ray> rays{std::span<const Ray>(observations.rays)};
    const Columns<Hit> hits{std::span<const Hit>(observations.hits)};
    WordLanes rows;
    for (std::uint32_t lane = 0; lane < kLaneCount; ++lane) rows.set(lane, lane);
    SurfaceBatch::Materials materials;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane)
      materials[lane] = &scatterer(observations.rays[lane], observations.hits[lane]);
    const HitRows of_hits(hits.all(), rows);
    SurfaceBatch batch(scene_, {rays.all(), rows}, of_hits, materials, plain_triangles);
    if (!scene_.has_dispersion()) return compare(observations, vertices_of(batch));
    FloatLanes nm, u;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane)
      nm.set(lane, random() < 0.5f ? 0 : 400 + 300 * random()), u.set(lane, random());
    const WavelengthOf<FloatN> light = wavelengths_at(nm.all(), u.all());
    batch.wavelength = &light;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) lights_[lane] = wavelength_at(nm[lane], u[lane]);
    compare(observations, vertices_of(batch));
  }

  // Compares vertices with those that each ray makes alone, and counts how often what is found.
  template <typename Vertices>
  void compare(const Observations& observations, const Vertices& together) {
    std::vector<PathVertex> alone;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane)
      alone.emplace_back(scene_, observations.rays[lane], observations.hits[lane], nullptr, lights_[lane]);
    compare_surfaces(alone, together);
    compare_samples(alone, together);
    compare_lights(alone, together);
  }

  static Ray in_lane(const RayOf<FloatN>& rays, std::size_t lane) {
    return {Vec3Lanes(rays.origin)[lane], Vec3Lanes(rays.direction)[lane], FloatLanes(rays.t_max)[lane]};
  }
  static void expect_equal(const Ray& a, const Ray& b) {
    ASSERT_EQ(a.origin, b.origin);
    ASSERT_EQ(a.direction, b.direction);
    ASSERT_EQ(a.t_max, b.t_max);
  }

  template <typename Vertices>
  void compare_surfaces(const std::vector<PathVertex>& alone, const Vertices& together) {
    const SurfacePointOf<FloatN>& surface = together.surface();
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      const SurfacePoint& point = alone[lane].surface();
      ASSERT_EQ(Vec3Lanes(surface.position)[lane], point.position);
      ASSERT_EQ(Vec3Lanes(surface.position_error)[lane], point.position_error);
      ASSERT_EQ(Vec3Lanes(surface.geometric_normal)[lane], point.geometric_normal);
      ASSERT_EQ(Vec3Lanes(surface.shading_normal)[lane], point.shading_normal);
      ASSERT_EQ(FloatLanes(surface.uv.x)[lane], point.uv.x);
      ASSERT_EQ(FloatLanes(surface.uv.y)[lane], point.uv.y);
      ASSERT_EQ(Vec3Lanes(together.wo())[lane], alone[lane].wo());
      ASSERT_EQ(Vec3Lanes(together.light_normal())[lane], alone[lane].light_context().normal);
      ASSERT_EQ(has(together.is_delta(), lane), alone[lane].is_delta());
    }
  }

  template <typename Vertices>
  void compare_samples(const std::vector<PathVertex>& alone, const Vertices& together) {
    FloatLanes u_x, u_y, u_lobe;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane)
      u_x.set(lane, random()), u_y.set(lane, random()), u_lobe.set(lane, random());
    const auto samples = together.sample({u_x.all(), u_y.all()}, u_lobe.all());
    const BsdfValueOf<FloatN> values = together.evaluate(samples.wi);
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      const auto sample = alone[lane].sample({u_x[lane], u_y[lane]}, u_lobe[lane]);
      ASSERT_EQ(has(samples.found, lane), sample.has_value());
      if (!sample) continue;
      ++samples_found_;
      ASSERT_EQ(Vec3Lanes(samples.wi)[lane], sample->wi);
      ASSERT_EQ(RgbLanes(samples.weight)[lane], sample->weight);
      ASSERT_EQ(has(samples.delta, lane), sample->delta);
      ASSERT_EQ(FloatLanes(samples.eta)[lane], sample->eta);
      expect_equal(in_lane(together.ray_along(samples.wi), lane), alone[lane].ray_along(sample->wi));
      if (sample->delta) continue;
      ASSERT_EQ(FloatLanes(samples.pdf)[lane], sample->pdf);
      const BsdfValue value = alone[lane].evaluate(sample->wi);
      ASSERT_EQ(RgbLanes(values.value)[lane], value.value);
      ASSERT_EQ(FloatLanes(values.pdf)[lane], value.pdf);
    }
  }

  template <typename Vertices>
  void compare_lights(const std::vector<PathVertex>& alone, const Vertices& together) {
    std::array<const lights::Light*, kLaneCount> lights;
    FloatLanes u_x, u_y;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      lights[lane] = random() < 0.1f ? nullptr : &scene_.lights()[generator_() % scene_.lights().size()];
      u_x.set(lane, random()), u_y.set(lane, random());
    }
    const lights::LightSamples samples = sample_lights(
        lights, scene_.textures(), {together.position(), together.light_normal()}, {u_x.all(), u_y.all()});
    const RayOf<FloatN> rays = together.rays_toward(samples);
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      const auto sample = lights[lane] ? sample_light(*lights[lane], scene_.textures(),
                                                      alone[lane].light_context(), {u_x[lane], u_y[lane]})
                                       : std::nullopt;
      ASSERT_EQ(has(samples.found, lane), sample.has_value());
      if (!sample) continue;
      ++lights_found_;
      ASSERT_EQ(Vec3Lanes(samples.wi)[lane], sample->wi);
      ASSERT_EQ(RgbLanes(samples.radiance)[lane], sample->radiance);
      ASSERT_EQ(FloatLanes(samples.pdf)[lane], sample->pdf);
      ASSERT_EQ(has(samples.delta, lane), sample->delta);
      expect_equal(in_lane(rays, lane), alone[lane].ray_toward(*sample));
    }
  }

  void compare_diffuse() { compare_kernel(is_of<Kernel::kDiffuse>, diffuse_vertices); }
  void compare_glossy() { compare_kernel(is_of<Kernel::kGlossy>, glossy_vertices); }
  // At plain triangles, and at surfaces of all kinds.
  template <typename VerticesOf>
  void compare_kernel(bool (*only_at)(const Material&), const VerticesOf& vertices_of) {
    for (int i = 0; i < 1000 && !HasFatalFailure(); ++i) {
      const bool plain = i % 2 == 0;
      const auto wanted = [&](const Ray& ray, const Hit& hit) {
        return only_at(scatterer(ray, hit)) && (!plain || scene_.primitives().is_plain_triangle(hit));
      };
      compare_batch(look(wanted), plain, vertices_of);
    }
    EXPECT_GT(samples_found_, 5000);
    EXPECT_GT(lights_found_, 4000);
  }
  // At surfaces of all materials.
  void compare_all() {
    const MaterialBins bins = material_bins(scene_);
    const auto any = [](const Ray&, const Hit&) { return true; };
    for (int i = 0; i < 2000 && !HasFatalFailure(); ++i) {
      const Observations some = look(any);
      compare_bin(bins, bin_of(bins, some.rays[0], some.hits[0]));
    }
    EXPECT_GT(samples_found_, 12000);
    EXPECT_GT(lights_found_, 8000);
  }
  std::uint32_t bin_of(const MaterialBins& bins, const Ray& ray, const Hit& hit) const {
    const Material& material = scatterer(ray, hit);
    return bins.of_materials[static_cast<std::size_t>(&material - scene_.materials().data())].bin;
  }
  // At surfaces that are shaded together.
  void compare_bin(const MaterialBins& bins, std::uint32_t bin) {
    const Observations observations =
        look([&](const Ray& ray, const Hit& hit) { return bin_of(bins, ray, hit) == bin; });
    switch (bins.kernels[bin]) {
      case Kernel::kDiffuse:
        return compare_batch(observations, false, diffuse_vertices);
      case Kernel::kGlossy:
        return compare_batch(observations, false, glossy_vertices);
      case Kernel::kPhong:
        return compare_batch(observations, false, phong_vertices);
      case Kernel::kSpecular:
        return compare_batch(observations, false, specular_vertices);
      case Kernel::kLayered:
        return compare_batch(observations, false, layered_vertices);
      case Kernel::kGeneral:
        return compare_batch(observations, false, general_vertices);
    }
  }

  Scene scene_;
  std::array<std::optional<Wavelength>, kLaneCount> lights_;  // if the scene disperses light
  std::mt19937 generator_{1};
  int samples_found_ = 0, lights_found_ = 0;
};

}  // namespace tessera::core::integrators
