// SPDX-License-Identifier: Apache-2.0
#include "core/scene/import/emission_only.hpp"

namespace tessera::core {
namespace {

void stop_scattering(Material& material) {
  if (auto* pane = std::get_if<ThinDielectric>(&material.model)) pane->reflectance = {Rgb{}};
  const bool stays = std::holds_alternative<Null>(material.model) || passes_straight(material) ||
                     std::holds_alternative<Blend>(material.model);
  if (stays) return;
  material.model = Lambert{{Rgb{}}};
  material.sampling = Sampling::kBsdf;
  material.normal_map = {};
  material.bump = {};
}

float share(float part, float rest) {
  return part + rest > 0 ? part / (part + rest) : 0;
}

// The emission is per absorption.
bool absorb_what_scatters(MediumDescription& medium) {
  const Rgb absorbed = medium.sigma_a, scattered = medium.sigma_s;
  medium.sigma_s = {};
  if (is_black(scattered)) return true;
  const bool shares_grid = medium.scattering_grid == medium.absorption_grid;
  medium.scattering_grid = -1;
  if (!shares_grid) return false;
  medium.sigma_a = absorbed + scattered;
  medium.emission = medium.emission * Rgb{share(absorbed.r, scattered.r), share(absorbed.g, scattered.g),
                                          share(absorbed.b, scattered.b)};
  return true;
}

}  // namespace

bool show_emission_only(SceneDescription& scene) {
  for (Material& material : scene.materials) stop_scattering(material);
  bool all = true;
  for (MediumDescription& medium : scene.media) all &= absorb_what_scatters(medium);
  return all;
}

}  // namespace tessera::core
