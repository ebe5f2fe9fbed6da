// What surfaces are made of. A Material is a model with its parameters, possibly textured, and emission;
// bsdf.hpp evaluates and samples it at a point.
//
// How to add a model: a struct here with its parameters, its case in bsdf.cpp (evaluate, sample, pdf),
// its entry in the scene loader and in scenes/scene.schema.json, and its chi-square test.
#pragma once

#include <string>
#include <variant>

#include "core/textures/texture.hpp"

namespace tessera::core {

// Ideal diffuse reflection on both sides (Lambert 1760).
struct Lambert {
  ColorParameter albedo{Rgb::gray(0.5f)};
};

// Ideal mirror on both sides.
struct Mirror {
  ColorParameter reflectance{Rgb::gray(1)};
};

// Smooth dielectric boundary with exact Fresnel reflectance. The inside is the side the geometric normal
// points away from; outside is air.
struct Glass {
  float ior = 1.5f;  // of the inside, relative to the outside
  ColorParameter reflectance{Rgb::gray(1)};
  ColorParameter transmittance{Rgb::gray(1)};
};

using MaterialModel = std::variant<Lambert, Mirror, Glass>;

struct Material {
  std::string name;
  MaterialModel model;
  ColorParameter emission{Rgb{}};  // radiance leaving the surface, uniform over directions; black for none
  bool two_sided_emission = true;  // else only on the side the geometric normal points to
};

}  // namespace tessera::core
