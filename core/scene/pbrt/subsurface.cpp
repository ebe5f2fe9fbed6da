// SPDX-License-Identifier: Apache-2.0
// The material "subsurface", as a coated diffuse surface of the colour of a thick body.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/math/elementary.hpp"
#include "core/scene/loader/wording.hpp"
#include "core/scene/pbrt/materials.hpp"
#include "core/scene/pbrt/measured_media.hpp"

namespace tessera::core::pbrt {
namespace {

constexpr float kMaxMeanCosine = 0.999f;

// The diffuse reflectance of a half-space that scatters the share `albedo` of light at each event (Jensen et
// al. 2001, eq. 15, with the boundary of an index of refraction).
float diffuse_reflectance(float albedo, float index) {
  const float internal = -1.44f / (index * index) + 0.71f / index + 0.668f + 0.0636f * index;
  const float a = (1 + internal) / (1 - internal);
  const auto root = static_cast<double>(std::sqrt(3 * std::max(0.0f, 1 - albedo)));
  return 0.5f * albedo * static_cast<float>((1 + exp(-4.0 / 3 * static_cast<double>(a) * root)) * exp(-root));
}

Rgb diffuse_reflectance(Rgb absorption, Rgb scattering, float index) {
  const auto channel = [index](float a, float s) {
    return a + s > 0 ? diffuse_reflectance(s / (a + s), index) : 0.0f;
  };
  return {channel(absorption.r, scattering.r), channel(absorption.g, scattering.g),
          channel(absorption.b, scattering.b)};
}

}  // namespace

Materials::Model Materials::subsurface(const Parameters& p) {
  report_.warn(p.place(),
               "subsurface scattering is not supported; a coated diffuse surface of its colour is used");
  // The colour of a thick body does not depend on the length of the paths inside.
  for (const char* length : {"mfp", "scale"})
    if (p.has(length)) p.remark(length, "has no effect, because light leaves the surface where it enters");
  Plastic plastic;
  const float index = index_of_refraction(p, "eta", 1.33f);
  plastic.ior = index;
  plastic.nonlinear = false;
  auto rough = roughness(p, "", 0, false);
  if (!rough) return fail(rough.error());
  plastic.roughness = rough->value;
  if (p.text("name").empty() && p.has("reflectance")) {
    auto reflectance = color(p, "reflectance", Rgb::gray(0.5f));
    if (!reflectance) return fail(reflectance.error());
    plastic.diffuse = *reflectance;
  } else {
    const auto [absorbed, scattered] = scattering_below(p);
    plastic.diffuse = {diffuse_reflectance(absorbed, scattered, index), -1};
  }
  return plastic;
}

// The coefficients of absorption and of reduced scattering: measured ones are reduced; others are by the mean
// cosine (similarity theory; Jensen et al. 2001).
std::pair<Rgb, Rgb> Materials::scattering_below(const Parameters& p) {
  const MeasuredMedium& milk = *find_measured_medium("Wholemilk");
  const std::string name = p.text("name");
  if (name.empty()) {
    const float reduction = 1 - p.number_in("g", 0, -kMaxMeanCosine, kMaxMeanCosine);
    return {colors_.color(p, "sigma_a", SpectrumRole::kUnbounded, milk.sigma_a),
            colors_.color(p, "sigma_s", SpectrumRole::kUnbounded, milk.sigma_s) * reduction};
  }
  for (const char* ignored : {"g", "reflectance", "sigma_a", "sigma_s"})
    if (p.has(ignored)) p.remark(ignored, "is ignored, because there is a \"name\"");
  const MeasuredMedium* named = find_measured_medium(name);
  if (named == nullptr)
    report_.warn(p.place(), "medium of subsurface " + name,
                 fmt::format("the medium {} is not known; that of whole milk is used", in_quotes(name)));
  const MeasuredMedium& medium = named == nullptr ? milk : *named;
  return {medium.sigma_a, medium.sigma_s};
}

}  // namespace tessera::core::pbrt
