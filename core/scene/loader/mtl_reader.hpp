// SPDX-License-Identifier: Apache-2.0
// Parses an MTL file; mtl_material.hpp converts its materials to the renderer's. Stateless; thread-safe.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/math/rgb.hpp"
#include "core/scene/loader/file_warnings.hpp"
#include "core/scene/loader/mtl_map.hpp"

namespace tessera::core {

// The supported statements of one "newmtl". Numbers are within their ranges.
struct MtlMaterial {
  using Map = std::optional<MtlMap>;

  std::string name;
  std::optional<Rgb> ambient, diffuse, specular, transmission, emission;  // Ka, Kd, Ks, Tf, Ke
  std::optional<float> dissolve, transparency;                            // d, Tr
  std::optional<float> ior, exponent, illum;                              // Ni, Ns, illum
  std::optional<float> roughness, metallic, coat, coat_roughness;         // Pr, Pm, Pc, Pcr
  std::optional<Rgb> sheen;                                               // Ps
  std::optional<float> anisotropy, anisotropy_rotation;                   // aniso, anisor
  Map diffuse_map, specular_map, emission_map;                            // map_Kd, map_Ks, map_Ke
  Map dissolve_map, exponent_map, roughness_map, metallic_map;            // map_d, map_Ns, map_Pr, map_Pm
  Map coat_map, coat_roughness_map, sheen_map;                            // map_Pc, map_Pcr, map_Ps
  Map normal_map, bump_map;                                               // norm, bump
};

struct MtlFile {
  std::vector<MtlMaterial> materials;
  FileWarnings warnings;
};

// Lines and values that cannot be parsed are skipped with a warning.
MtlFile read_mtl(std::string_view bytes, const WarningLimits& warnings = {});

}  // namespace tessera::core
