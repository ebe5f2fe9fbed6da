// SPDX-License-Identifier: Apache-2.0
// Vertices in lanes are to the bit what each is alone: materials that the plain scene lacks.
#include <utility>

#include "tests/unit/core_render/vertex_lanes.hpp"

namespace tessera::core::integrators {
namespace {

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

}  // namespace
}  // namespace tessera::core::integrators
