// SPDX-License-Identifier: Apache-2.0
// The parameters of Disney's principled BSDF (Burley 2012, 2015), which core/shading/disney_bsdf.hpp
// computes. Its lobes are added without regard for each other, unlike the layers of Principled: at grazing
// angles bright surfaces scatter more light than they receive.
#pragma once

#include "core/materials/tangent_direction.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {

// By Burley's names. On both sides; if it transmits and is no thin sheet, a solid with the inside of Glass.
struct Disney {
  ColorParameter base_color{Rgb::gray(0.5f)};
  ScalarParameter metallic = 0;
  ScalarParameter roughness = 0.5f;
  ScalarParameter anisotropic = 0;  // the highlight is longer along its tangent
  ScalarParameter ior = 1.5f;
  ScalarParameter specular_tint = 0;  // of the dielectric's reflection, by the base colour
  ScalarParameter specular_transmission = 0;
  ScalarParameter flatness = 0;  // of diffuse reflection: flattened as by subsurface scattering
  ScalarParameter sheen = 0;
  ScalarParameter sheen_tint = 0;
  ScalarParameter clearcoat = 0;
  ScalarParameter clearcoat_gloss = 0;
  // Of thin sheets only, which have neither metal nor clearcoat: the share of diffuse light that goes
  // through.
  ScalarParameter diffuse_transmission = 0;
  bool thin_walled = false;
  TangentDirection tangent{};
};

// Whether the surface has an inside that light enters, or is a sheet.
inline bool transmits_light(const Disney& model) {
  return model.thin_walled || model.specular_transmission.texture >= 0 ||
         model.specular_transmission.value > 0;
}

}  // namespace tessera::core
