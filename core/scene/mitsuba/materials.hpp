// SPDX-License-Identifier: Apache-2.0
// Converts Mitsuba's BSDFs, with the emission and the media of the shapes that have them. docs/importing.md
// tells what is exact. Not thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "core/materials/material.hpp"
#include "core/scene/mitsuba/plugin.hpp"
#include "core/scene/mitsuba/textures.hpp"

namespace tessera::core::mitsuba {

// A BSDF as a material.
struct Surface {
  Material material;
  // Its inside is what Mitsuba calls the outside: the shape must be turned inside out.
  bool is_reversed = false;
};

// A surface of the model that is black on its back, and one whose sides are alike.
Surface one_sided(const Plugin& bsdf, MaterialModel model);
Surface open(const Plugin& bsdf, MaterialModel model);

// What a shape needs of its material. The site's attributes must live as long as the converter.
struct MaterialUse {
  std::optional<Plugin> bsdf{}, emitter{};
  MediumInterface media{};  // as Mitsuba names the sides
  TextureSite site{};
};

// The material of a shape.
struct MaterialIndex {
  std::uint32_t index = 0;
  bool is_reversed = false;  // as of Surface
};

class MaterialConverter {
 public:
  MaterialConverter(Conversion& conversion, TextureConverter& textures)
      : conversion_(conversion), textures_(textures) {}

  // Equal uses get the same material.
  MaterialIndex material(const MaterialUse& use);

 private:
  using Site = std::tuple<NodeId, UvLayout, const AttributeTextures*>;
  using Use = std::tuple<Site, NodeId, int, int>;  // with the emitter and the media

  // `depth` counts the blends around the BSDF.
  const Surface& surface(const Plugin& bsdf, const TextureSite& site, int depth = 0);
  Surface convert(const Plugin& bsdf, const TextureSite& site, int depth);

  Surface diffuse(const Plugin& bsdf, const TextureSite& site);
  Surface dielectric(const Plugin& bsdf, const TextureSite& site, bool is_rough);
  Surface thin_dielectric(const Plugin& bsdf, const TextureSite& site);
  Surface conductor(const Plugin& bsdf, const TextureSite& site, bool is_rough);
  Surface plastic(const Plugin& bsdf, const TextureSite& site, bool is_rough);
  Surface principled(const Plugin& bsdf, const TextureSite& site, bool is_thin);
  Surface blend(const Plugin& bsdf, const TextureSite& site, int depth);
  Surface mask(const Plugin& bsdf, const TextureSite& site, int depth);
  Surface two_sided(const Plugin& bsdf, const TextureSite& site, int depth);
  Surface normal_map(const Plugin& bsdf, const TextureSite& site, int depth);
  Surface bump_map(const Plugin& bsdf, const TextureSite& site, int depth);
  // A polarizing plate for light that is not polarized: `share` of it passes straight through.
  Surface straight(const Plugin& bsdf, const TextureSite& site, float share);
  Surface hair(const Plugin& bsdf, const TextureSite& site);
  Surface unsupported(const Plugin& bsdf);
  // The nearest for a BSDF of Mitsuba 0.x, with a warning; nullopt for other types.
  std::optional<Surface> earlier(const Plugin& bsdf, const TextureSite& site, int depth);
  Surface rough_diffuse(const Plugin& bsdf, const TextureSite& site);
  Surface phong(const Plugin& bsdf, const TextureSite& site);
  Surface ward(const Plugin& bsdf, const TextureSite& site);
  Surface diffuse_transmission(const Plugin& bsdf, const TextureSite& site);
  Surface coating(const Plugin& bsdf, const TextureSite& site, int depth, bool is_rough);
  Surface mixture(const Plugin& bsdf, const TextureSite& site, int depth);
  // The BSDF inside of another; a gray diffuse one if it is missing.
  Surface inner(const Plugin& bsdf, const TextureSite& site, int depth);
  // The surface of a blend of two of the scene's materials.
  Surface blended(const Plugin& bsdf, const Blend& model);
  // The scene's material of a part of a blend; `is_back` lights its back as its front.
  std::uint32_t part(const Plugin& bsdf, const TextureSite& site, int depth, bool is_back = false);

  // The roughness of a microfacet model, its anisotropy and direction, and the distribution.
  struct Roughness {
    ScalarParameter roughness = 0, anisotropy = 0;
    MicrofacetKind microfacets{};
    TangentDirection tangent{};
  };
  Roughness roughness(const Plugin& bsdf, const TextureSite& site);
  static MicrofacetKind microfacets(const Plugin& bsdf);
  ComplexIndex metal(const Plugin& bsdf);
  void set_emission(const Plugin& emitter, const TextureSite& site, Material& material);

  Conversion& conversion_;
  TextureConverter& textures_;
  std::map<Site, Surface> surfaces_;
  std::map<std::pair<Site, bool>, std::uint32_t> parts_;
  std::map<Use, MaterialIndex> materials_;
};

}  // namespace tessera::core::mitsuba
