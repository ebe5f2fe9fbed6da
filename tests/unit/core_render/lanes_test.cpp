// SPDX-License-Identifier: Apache-2.0
// Vertices in lanes are to the bit what each is alone.
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "core/integrators/fingerprint.hpp"
#include "core/integrators/path_wavelength.hpp"
#include "core/integrators/shading_bins.hpp"
#include "core/integrators/vertex_batch.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core {
namespace {

bool has(MaskN mask, std::size_t lane) {
  return (mask.bits() >> lane & 1) != 0;
}

Ray in_lane(const RayOf<FloatN>& rays, std::size_t lane) {
  return {Vec3Lanes(rays.origin)[lane], Vec3Lanes(rays.direction)[lane], FloatLanes(rays.t_max)[lane]};
}

void expect_equal(const Ray& a, const Ray& b) {
  ASSERT_EQ(a.origin, b.origin);
  ASSERT_EQ(a.direction, b.direction);
  ASSERT_EQ(a.t_max, b.t_max);
}

MeshDescription as_mesh(const QuadDescription& quad) {
  const Vec3 c = quad.corner, u = quad.edge_u, v = quad.edge_v;
  return {.positions = {c, c + u, c + u + v, c + v},
          .normals = {},
          .uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}},
          .triangles = {{0, 1, 2}, {0, 2, 3}},
          .triangle_materials = {quad.material}};
}

template <Kernel kKernel>
bool is_of(const Material& material) {
  return kernel_of(material) == kKernel;
}

class VertexLanes : public testing::Test {
 protected:
  explicit VertexLanes(const SceneDescription& scene = fingerprint_scene())
      : scene_(Scene::build(scene, 1).value()) {}

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
    std::array<const Light*, kLaneCount> lights;
    FloatLanes u_x, u_y;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      lights[lane] = random() < 0.1f ? nullptr : &scene_.lights()[generator_() % scene_.lights().size()];
      u_x.set(lane, random()), u_y.set(lane, random());
    }
    const LightSamples samples = sample_lights(
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

TEST_F(VertexLanes, OfDiffuseTriangles) {
  compare_diffuse();
}

TEST_F(VertexLanes, OfGlossyTriangles) {
  compare_glossy();
}

// An image of each format that images are kept in.
std::vector<std::shared_ptr<const TextureImage>> images_of_every_format() {
  std::mt19937 generator(2);
  constexpr int kWidth = 37, kHeight = 21;
  std::vector<std::uint8_t> bytes(3 * kWidth * kHeight);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(generator());
  std::vector<float> exact, odd;
  for (const std::uint8_t byte : bytes) {
    exact.push_back(static_cast<float>(byte) / 8);
    odd.push_back(static_cast<float>(byte) / 3);
  }
  return {std::make_shared<TextureImage>(kWidth, kHeight, bytes),
          std::make_shared<TextureImage>(kWidth, kHeight, bytes, ColorSpace::kLinear),
          std::make_shared<TextureImage>(kWidth, kHeight, exact),
          std::make_shared<TextureImage>(1, 1, std::vector<std::uint8_t>{10, 100, 200}),
          std::make_shared<TextureImage>(1, 1, std::vector<float>{0.1f, 2, 3}),
          std::make_shared<TextureImage>(kWidth, kHeight, odd)};
}

TEST_F(VertexLanes, OfTextures) {
  const auto images = images_of_every_format();
  for (int i = 0; i < 2000; ++i) {
    std::array<Texture, kLaneCount> textures;
    std::array<const Texture*, kLaneCount> pointers;
    FloatLanes u, v, second_u, second_v;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      const auto& image = images[generator_() % (i % 2 == 0 ? 3 : images.size())];
      textures[lane] = {image, random() < 0.5f ? Wrap::kRepeat : Wrap::kClamp, {3, -2}, {0.2f, random()}};
      if (random() < 0.3f) textures[lane].wrap_v = Wrap::kMirror;
      if (random() < 0.2f) textures[lane].wrap = Wrap::kMirror;
      if (random() < 0.3f) textures[lane].filter = TextureFilter::kNearest;
      if (random() < 0.3f) textures[lane].shear = {0.7f, random()};
      if (i % 3 == 0 && random() < 0.5f) textures[lane].uv_set = UvSet::kSecond;
      pointers[lane] = &textures[lane];
      constexpr float kOdd[] = {std::numeric_limits<float>::quiet_NaN(),
                                std::numeric_limits<float>::infinity(),
                                -std::numeric_limits<float>::infinity(), 1e30f};
      u.set(lane, random() < 0.1f ? kOdd[generator_() % 4] : 2 * random() - 0.5f);
      v.set(lane, random() < 0.1f ? 0 : 3 * random() - 1);
      second_u.set(lane, random());
      second_v.set(lane, random());
    }
    using Uv = Vec2Of<FloatN>;
    const UvSetsOf<FloatN> uv(Uv{u.all(), v.all()}, Uv{second_u.all(), second_v.all()});
    const RgbLanes together(Texture::evaluate(pointers, uv));
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      const UvSets of_lane({u[lane], v[lane]}, {second_u[lane], second_v[lane]});
      ASSERT_EQ(together[lane], textures[lane].evaluate(of_lane));
    }
  }
}

TEST_F(VertexLanes, OfSurroundings) {
  auto images = images_of_every_format();
  images.push_back(nullptr);
  for (const auto& image : images) {
    const Environment environment({0.5f, 1, 2}, image, 40);
    for (int i = 0; i < 2000; ++i) {
      FloatLanes u_x, u_y;
      Vec3Lanes directions, normals;
      for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
        u_x.set(lane, random()), u_y.set(lane, random());
        directions.set(lane, {random() - 0.5f, random() < 0.1f ? 0 : random() - 0.5f, random() - 0.5f});
        normals.set(lane, random() < 0.2f ? Vec3{} : sample_sphere({random(), random()}));
      }
      const auto compensation = i % 2 == 0 ? MisCompensation::kOff : MisCompensation::kOn;
      const LightSamples samples =
          environment.sample(normals.all(), Vec2Of<FloatN>{u_x.all(), u_y.all()}, compensation);
      const auto [radiance, pdf] = environment.see(normals.all(), directions.all(), compensation);
      for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
        ASSERT_EQ(RgbLanes(radiance)[lane], environment.radiance(directions[lane]));
        ASSERT_EQ(FloatLanes(pdf)[lane], environment.pdf(normals[lane], directions[lane], compensation));
        const auto sample = environment.sample(normals[lane], {u_x[lane], u_y[lane]}, compensation);
        ASSERT_EQ(has(samples.found, lane), sample.has_value());
        if (!sample) continue;
        ASSERT_EQ(Vec3Lanes(samples.wi)[lane], sample->wi);
        ASSERT_EQ(RgbLanes(samples.radiance)[lane], sample->radiance);
        ASSERT_EQ(FloatLanes(samples.pdf)[lane], sample->pdf);
      }
    }
  }
}

TEST_F(VertexLanes, OfAllMaterialsAndShapes) {
  compare_all();
}

// The same scene whose triangles have vertex colours, with bump maps and lamps that let light pass.
SceneDescription with_vertex_colors_and_opacity() {
  SceneDescription scene = fingerprint_scene();
  for (ShapeDescription& shape : scene.shapes)
    if (const auto* quad = std::get_if<QuadDescription>(&shape)) shape = as_mesh(*quad);
  for (auto* shapes : {&scene.shapes, &scene.objects[0].shapes})
    for (ShapeDescription& shape : *shapes)
      if (auto* mesh = std::get_if<MeshDescription>(&shape))
        for (std::size_t i = 0; i < mesh->positions.size(); ++i)
          mesh->colors.push_back({1, 0.25f * static_cast<float>(i % 5), 0.5f});
  for (Material& material : scene.materials) {
    if (material.name == "varnish" || material.name == "tiles") material.bump = {0, 0.1f};
    if (material.name == "lamp") material.opacity = 0.5f;
    if (material.name == "screen") material.opacity = {0.5f, 2};
    if (material.name == "lacquer") std::get<CookTorrance>(material.model).diffuse = {Rgb{}};
  }
  return scene;
}

class ColoredLanes : public VertexLanes {
 protected:
  ColoredLanes() : VertexLanes(with_vertex_colors_and_opacity()) {}
};

TEST_F(ColoredLanes, OfDiffuseTriangles) {
  compare_diffuse();
}

TEST_F(ColoredLanes, OfGlossyTriangles) {
  compare_glossy();
}

TEST_F(ColoredLanes, OfAllMaterialsAndShapes) {
  compare_all();
}

// The same scene with layered and brushed surfaces, and a blend in place of its last material.
SceneDescription with_layers() {
  SceneDescription scene = fingerprint_scene();
  for (Material& material : scene.materials) {
    if (material.name == "cloth")
      material.model = ConductorMaterial{.roughness = 0.5f, .anisotropy = 0.7f, .tangent = {{0}, 0.2f}};
    if (material.name == "frosted")
      material.model = Principled{.base_diffuse_roughness = 0.4f,
                                  .base_metalness = {0.4f, 0},
                                  .specular_roughness_anisotropy = 0.3f,
                                  .transmission_weight = 0.5f,
                                  .coat_weight = 0.5f,
                                  .coat_roughness = {0.5f, 0},
                                  .coat_roughness_anisotropy = {0.6f, 0},
                                  .fuzz_weight = 0.5f,
                                  .thin_film_weight = {0.5f, 0},
                                  .tangent = {{}, {1, 0}},
                                  .coat_tangent = {{0}, 0.1f},
                                  .geometry_coat_normal = {0, 0.5f}};
    if (material.name == "glass")
      material.model = Principled{.subsurface_weight = 0.5f,
                                  .transmission_weight = {0.7f, 0},
                                  .coat_weight = {1, 0},
                                  .geometry_thin_walled = true};
    if (material.name == "varnish") material.model = Plastic{.roughness = {0.5f, 0}};
    if (material.name == "lacquer") material.model = Plastic{.roughness = 0.4f, .nonlinear = true};
    if (material.name == "gold") material.model = DiffuseTransmission{};
    if (material.name == "mirror") material.model = ThinDielectric{};
    if (material.name == "tiles")
      material.model =
          Disney{.metallic = {0.5f, 0}, .anisotropic = 0.5f, .sheen = 0.5f, .tangent = {{}, 0.3f}};
    if (material.name == "wall") material.two_sided = false;
    if (material.name == "varnish" || material.name == "wall")
      material.shading_normals = ShadingNormals::kPlain;
  }
  scene.materials.back().model = Blend{.first = 0, .second = 2};
  return scene;
}

class LayeredLanes : public VertexLanes {
 protected:
  LayeredLanes() : VertexLanes(with_layers()) {}
};

TEST_F(LayeredLanes, OfAllMaterialsAndShapes) {
  compare_all();
}

constexpr MicrofacetKind kBeckmann{MicrofacetDistribution::kBeckmann, SmithMasking::kCorrelated};
constexpr MicrofacetKind kSeparable{MicrofacetDistribution::kGgx, SmithMasking::kSeparable};

// The same scene with models that have no kernel of their own; those of a bin differ in their parameters.
SceneDescription with_rare_models() {
  SceneDescription scene = fingerprint_scene();
  for (Material& material : scene.materials) {
    if (material.name == "cloth") material.model = Hair{.eumelanin = {3, 0}, .beta_n = {0.9f, 0}};
    if (material.name == "wall")
      material.model = Hair{.pigment = HairPigment::kReflectance, .reflectance = {{0.8f, 0.5f, 0.3f}}};
    if (material.name == "leaf")
      material.model =
          Hair{.pigment = HairPigment::kAbsorption, .sigma_a = {{0.1f, 0.3f, 0.9f}}, .tilt_degrees = 5};
    if (material.name == "glass")
      material.model = Glass{.ior = 1.3f, .roughness = {0.9f, 0}, .microfacets = kBeckmann};
    if (material.name == "frosted") material.model = Glass{.roughness = 0.5f, .microfacets = kBeckmann};
    if (material.name == "varnish")
      material.model = Plastic{.roughness = {0.8f, 0}, .microfacets = kBeckmann, .compensated = false};
    if (material.name == "lacquer") material.model = Plastic{.microfacets = kBeckmann};
    if (material.name == "mirror")
      material.model =
          ConductorMaterial{.roughness = {0.8f, 0}, .anisotropy = 0.5f, .microfacets = kSeparable};
    if (material.name == "gold") material.model = ConductorMaterial{.microfacets = kSeparable};
    if (material.name == "tiles")
      material.model = Disney{.base_color = {{0.9f, 0.5f, 0.2f}},
                              .metallic = {0.5f, 0},
                              .anisotropic = 0.5f,
                              .specular_tint = 0.4f,
                              .specular_transmission = {0.7f, 0},
                              .flatness = 0.3f,
                              .sheen = 0.5f,
                              .clearcoat = {1, 0},
                              .tangent = {{}, 0.3f}};
    if (material.name == "copper") {
      material.sampling = Sampling::kBsdf;  // only cook_torrance has half-vectors
      material.model = Disney{.specular_transmission = 0.5f,
                              .sheen = 0.5f,
                              .sheen_tint = 0.5f,
                              .diffuse_transmission = {0.5f, 0},
                              .thin_walled = true};
    }
  }
  return scene;
}

class RareLanes : public VertexLanes {
 protected:
  RareLanes() : VertexLanes(with_rare_models()) {}
};

TEST_F(RareLanes, OfAllMaterialsAndShapes) {
  compare_all();
}

// The same scene with dispersion: smooth and rough, of both kinds of microfacets, beside what has none.
SceneDescription with_dispersion() {
  SceneDescription scene = fingerprint_scene();
  for (Material& material : scene.materials) {
    if (material.name == "glass") material.model = Glass{.ior = 1.7f, .dispersion = {1, 20}};
    if (material.name == "frosted") material.model = Glass{.dispersion = {0.5f, 30}, .roughness = {0.5f, 0}};
    if (material.name == "varnish")
      material.model = Glass{.dispersion = {1, 10}, .roughness = {0.9f, 0}, .microfacets = kBeckmann};
    if (material.name == "lacquer") material.model = Glass{.roughness = 0.5f, .microfacets = kBeckmann};
    if (material.name == "gold")
      material.model = Principled{.specular_roughness = {0.5f, 0},
                                  .transmission_weight = 0.8f,
                                  .transmission_dispersion = {1, 25},
                                  .coat_weight = 0.5f};
  }
  return scene;
}

class DispersiveLanes : public VertexLanes {
 protected:
  DispersiveLanes() : VertexLanes(with_dispersion()) {}
};

TEST_F(DispersiveLanes, OfAllMaterialsAndShapes) {
  compare_all();
}

// The same scenes, with directions sampled uniformly.
SceneDescription sampled_uniformly(SceneDescription scene) {
  for (Material& material : scene.materials) material.sampling = Sampling::kUniform;
  return scene;
}

class UniformLanes : public VertexLanes {
 protected:
  UniformLanes() : VertexLanes(sampled_uniformly(fingerprint_scene())) {}
};

TEST_F(UniformLanes, OfAllMaterialsAndShapes) {
  compare_all();
}

class UniformLayeredLanes : public VertexLanes {
 protected:
  UniformLayeredLanes() : VertexLanes(sampled_uniformly(with_layers())) {}
};

TEST_F(UniformLayeredLanes, OfAllMaterialsAndShapes) {
  compare_all();
}

class UniformRareLanes : public VertexLanes {
 protected:
  UniformRareLanes() : VertexLanes(sampled_uniformly(with_rare_models())) {}
};

TEST_F(UniformRareLanes, OfAllMaterialsAndShapes) {
  compare_all();
}

// Whether a mesh or sphere of one material reflects only.
bool only_reflects(const SceneDescription& scene, const ShapeDescription& shape) {
  const auto reflects = [&](std::uint32_t material) {
    return is_black(scene.materials[material].emission.value);
  };
  if (const auto* sphere = std::get_if<SphereDescription>(&shape)) return reflects(sphere->material);
  const auto* mesh = std::get_if<MeshDescription>(&shape);
  return mesh != nullptr && mesh->triangle_materials.size() == 1 && reflects(mesh->triangle_materials[0]);
}

// The same scene with such shapes in objects of their own, shown at two places: moved, turned, stretched and
// reflected.
SceneDescription with_instances() {
  SceneDescription scene = fingerprint_scene();
  const std::array places{compose(translation({0.2f, 0.1f, -0.1f}), rotation({0.3f, 1, 0.2f}, 7)),
                          compose(translation({-0.1f, 0.4f, 0.3f}),
                                  compose(rotation({1, 0.2f, -0.4f}, 25), scaling({-0.9f, 1.2f, 0.8f})))};
  std::vector<ShapeDescription> shapes;
  for (ShapeDescription& shape : scene.shapes) {
    if (const auto* quad = std::get_if<QuadDescription>(&shape)) shape = as_mesh(*quad);
    if (!only_reflects(scene, shape)) {
      shapes.push_back(shape);
      continue;
    }
    const auto object = static_cast<std::uint32_t>(scene.objects.size());
    scene.objects.push_back({.name = "part", .shapes = {shape}, .shape_names = {}});
    for (const Transform& place : places) shapes.push_back(InstanceDescription{object, place, std::nullopt});
  }
  scene.shapes = std::move(shapes);
  return scene;
}

class InstancedLanes : public VertexLanes {
 protected:
  InstancedLanes() : VertexLanes(with_instances()) {}
};

TEST_F(InstancedLanes, OfAllMaterialsAndShapes) {
  compare_all();
  int instanced = 0;
  for (int i = 0; i < 1000; ++i) {
    const Ray ray{random_point(), random_point()};
    instanced += scene_.bvh().closest_hit(scene_.primitives(), ray).in_instance() ? 1 : 0;
  }
  EXPECT_GT(instanced, 300);
}

TEST_F(InstancedLanes, OfTheKernelsOfFrequentMaterials) {
  const auto look_at_instances = [&](bool (*only_at)(const Material&)) {
    return look(
        [&](const Ray& ray, const Hit& hit) { return hit.in_instance() && only_at(scatterer(ray, hit)); });
  };
  for (int i = 0; i < 500 && !HasFatalFailure(); ++i) {
    compare_batch(look_at_instances(is_of<Kernel::kDiffuse>), false, diffuse_vertices);
    compare_batch(look_at_instances(is_of<Kernel::kGlossy>), false, glossy_vertices);
  }
  EXPECT_GT(samples_found_, 5000);
}

}  // namespace
}  // namespace tessera::core
