// SPDX-License-Identifier: Apache-2.0
// Materials. A Material is a model with its parameters, possibly textured, and emission; bsdf.hpp evaluates
// and samples it at a point. docs/materials.md gives the formulae.
//
// To add a model: add a struct with its parameters here, its case in visit_parameters and in bsdf.cpp, its
// BSDF in its own file, its entry in the scene loader, in scenes/scene.schema.json and in the
// documentation, and its rows in the tests of all BSDFs.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "core/materials/conductor.hpp"
#include "core/materials/fresnel.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {

// Upper limits of parameters; texture values are clamped to them.
inline constexpr float kMaxIor = 10, kMaxExponent = 1e5f;

// Ideal diffuse reflection on both sides (Lambert 1760).
struct Lambert {
  ColorParameter albedo{Rgb::gray(0.5f)};
};

// Ideal mirror on both sides.
struct Mirror {
  ColorParameter reflectance{Rgb::gray(1)};
};

// Dielectric boundary, smooth or with GGX microfacets (Walter et al. 2007). The inside is the side that the
// geometric normal points away from; outside is air.
struct Glass {
  ScalarParameter ior = 1.5f;  // of the inside, relative to the outside
  ColorParameter reflectance{Rgb::gray(1)};
  ColorParameter transmittance{Rgb::gray(1)};
  DielectricFresnel fresnel = DielectricFresnel::kExact;
  ScalarParameter roughness = 0;  // alpha is its square; smooth if that is below kMinAlpha
};

// The sampling density of Phong's highlight, by the angle alpha to the mirror direction: proportional to
// cos^n or to cos^(n + 1) alpha.
enum class PhongLobe { kNPlus1, kNPlus2 };

// Modified Phong (Lafortune and Willems 1994), on both sides. If diffuse + specular exceed 1, both are
// scaled down to that.
struct Phong {
  ColorParameter diffuse{Rgb::gray(0.5f)};
  ColorParameter specular{Rgb::gray(0.3f)};
  ScalarParameter exponent = 30;
  PhongLobe lobe = PhongLobe::kNPlus1;
};

enum class Masking {
  kSmith,    // height-correlated (Heitz 2014)
  kSchlick,  // separable, by Schlick's approximation (Schlick 1994), k = alpha / 2
};

// GGX microfacet reflection (Cook and Torrance 1982; Walter et al. 2007) over a diffuse base, on both
// sides. If diffuse + specular exceed 1, both are scaled down to that.
struct CookTorrance {
  ColorParameter diffuse{Rgb::gray(0)};
  ColorParameter specular{Rgb::gray(1)};
  ColorParameter f0{Rgb::gray(0.04f)};   // reflectance at normal incidence, with Schlick's approximation; or:
  std::optional<Conductor> conductor{};  // exact reflectance of a metal
  ScalarParameter roughness = 0.3f;      // alpha is its square, at least kMinAlpha
  Masking masking = Masking::kSmith;
};

using MaterialModel = std::variant<Lambert, Mirror, Glass, Phong, CookTorrance>;

// The sampling strategy for directions.
enum class Sampling {
  kBsdf,        // approximately in proportion to the scattered light
  kUniform,     // uniformly over the hemisphere, or the sphere for transmission; delta lobes
                // of ideal mirrors and smooth glass are unchanged
  kHalfVector,  // CookTorrance: the half-vector in proportion to the microfacets' projected area
};

// Perturbs shading normals: a texture's red, green and blue are x, y and z from -1 to 1 in the frame of u,
// v and the normal.
struct NormalMap {
  int texture = -1;    // index among the scene's textures, -1 for none
  float strength = 1;  // multiplies x and y
};

// Tilts shading normals as if the surface were displaced by the heights in a texture's red channel (Blinn
// 1978).
struct BumpMap {
  int texture = -1;  // index among the scene's textures, -1 for none
  float height = 1;  // of a texel of 1, in world units; if negative, bright texels are lower
};

struct Material {
  std::string name;
  MaterialModel model;
  ColorParameter emission{Rgb{}};  // radiance leaving the surface, uniform over directions; black for none
  bool two_sided_emission = true;  // else only on the side the geometric normal points to
  Sampling sampling = Sampling::kBsdf;
  NormalMap normal_map{};
  BumpMap bump{};  // applied after the normal map
  // The probability that light hits the surface; else it passes straight through. In [0, 1]; texture values
  // are clamped. It multiplies emission.
  ScalarParameter opacity = 1;
};

// Whether light passes through the surface only by its model's transmission.
inline bool is_opaque(const Material& material) {
  return material.opacity.texture < 0 && material.opacity.value >= 1;
}

// Whether f0 is the base colour, as for a metal.
inline bool f0_is_base_color(const CookTorrance& model) {
  return model.diffuse.texture < 0 && is_black(model.diffuse.value);
}

// Calls visit(key, parameter) for each ColorParameter and ScalarParameter of `model`, with its key in scene
// files.
template <typename Visit>
void visit_parameters(const Lambert& model, const Visit& visit) {
  visit("albedo", model.albedo);
}
template <typename Visit>
void visit_parameters(const Mirror& model, const Visit& visit) {
  visit("reflectance", model.reflectance);
}
template <typename Visit>
void visit_parameters(const Glass& model, const Visit& visit) {
  visit("ior", model.ior);
  visit("reflectance", model.reflectance);
  visit("transmittance", model.transmittance);
  visit("roughness", model.roughness);
}
template <typename Visit>
void visit_parameters(const Phong& model, const Visit& visit) {
  visit("diffuse", model.diffuse);
  visit("specular", model.specular);
  visit("exponent", model.exponent);
}
template <typename Visit>
void visit_parameters(const CookTorrance& model, const Visit& visit) {
  visit("diffuse", model.diffuse);
  visit("specular", model.specular);
  visit("f0", model.f0);
  visit("roughness", model.roughness);
}
template <typename Visit>
void visit_parameters(const MaterialModel& model, const Visit& visit) {
  std::visit([&](const auto& m) { visit_parameters(m, visit); }, model);
}

}  // namespace tessera::core
