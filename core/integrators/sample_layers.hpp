// SPDX-License-Identifier: Apache-2.0
// Adds the layers of samples to a film tile (core/film/layout.hpp). Used by one thread for all samples of
// some pixels; others may use their own for other pixels of the tile meanwhile.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/film/film.hpp"
#include "core/integrators/first_hits.hpp"
#include "core/integrators/light_parts.hpp"
#include "core/sampling/sampler.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core::integrators {

class SampleLayers {
 public:
  // `tile` may be null: no layers. There are so many slots for samples under way. Keeps references.
  SampleLayers(const Scene& scene, FilmTile* tile, std::size_t slots);

  // Where integrators divide the light of the sample in each slot; empty or null without layers of light.
  std::span<LightParts> parts() { return parts_; }
  LightParts* parts_of(std::uint32_t slot) {
    if (parts_.empty()) return nullptr;
    parts_[slot].clear();
    return &parts_[slot];
  }

  // Whether a layer is of what camera rays hit. Then each sample that begins must be told with its ray; the
  // sampler is used by add_surfaces().
  bool see_surfaces() const { return sees_surfaces_; }
  void begin(const Ray& ray, SampleId id, const sampling::Sampler& sampler);
  // Adds what is seen of surfaces by all samples that have begun since the last call. Returns the number of
  // rays traced.
  std::uint64_t add_surfaces();
  // Adds the light of the sample in a slot, whose parts are complete.
  void add_light(std::uint32_t slot, SampleId id, const sampling::Sampler& sampler);
  // Adds what was counted aside. By one thread at a time, after all else.
  void finish();

 private:
  static constexpr std::array kCryptoLayers{Layer::kCryptoObject, Layer::kCryptoMaterial,
                                            Layer::kCryptoAsset};

  void divide_by_groups();
  std::uint32_t pixel_of(SampleId id) const;
  void add_word(Layer layer, std::size_t component, ChannelEncoding encoding, std::size_t pixel,
                std::uint64_t word);
  void add_color(Layer layer, std::size_t pixel, Rgb value, const std::array<double, 3>& dither);
  // To a plane and the two behind it.
  void add_to_planes(std::size_t plane, std::size_t pixel, Rgb value, const std::array<double, 3>& dither);
  void add_vector(Layer layer, std::size_t pixel, std::span<const float> values);
  void add_surface(std::uint32_t pixel, const FirstHit& hit, const std::array<double, 3>& dither);

  const Scene& scene_;
  FilmTile* const tile_;
  const LayerSet layers_;
  const bool sees_surfaces_;
  std::array<std::size_t, kLayerCount> first_planes_{};
  std::vector<LightParts> parts_;
  struct Group {
    std::uint32_t number;  // among those of the scene
    std::size_t first_plane;
  };
  std::vector<Group> groups_;         // of layers_
  std::vector<Rgb> light_of_groups_;  // where parts_ add it
  std::array<std::optional<IdCounter>, kCryptoLayers.size()> ids_;
  // The samples that have begun:
  std::vector<Ray> rays_;
  std::vector<const sampling::Sampler*> samplers_;
  std::vector<std::uint32_t> pixels_;
  std::vector<FirstHit> hits_;
};

}  // namespace tessera::core::integrators
