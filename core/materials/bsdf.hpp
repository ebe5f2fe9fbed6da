// How a surface scatters light at one point: a material's model with its textures looked up.
//
// Directions are unit vectors pointing away from the surface, in a local frame whose +z is the shading normal
// on the side of wo. Densities are per solid angle.
#pragma once

#include <array>
#include <optional>
#include <variant>
#include <vector>

#include "core/materials/material.hpp"
#include "core/math/rgb.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

struct BsdfSample {
  Vec3 wi_local;
  Rgb weight;     // bsdf * |cos| / pdf
  float pdf = 0;  // meaningless where `delta`
  bool delta = false;
  bool transmitted = false;
  float eta = 1;  // transmitted: index of refraction on the far side over that on the near side
};

class Bsdf {
 public:
  // `outside`: wo is on the side that the outward geometric normal points to.
  Bsdf(const MaterialModel& model, const std::vector<Texture>& textures, Vec2 uv, bool outside);

  // Scatters into single directions only: evaluate and pdf are zero.
  bool is_delta() const;

  // bsdf * |cos(wi)|.
  Rgb evaluate(Vec3 wo_local, Vec3 wi_local) const;
  float pdf(Vec3 wo_local, Vec3 wi_local) const;
  // Nothing where no light is scattered. u_lobe chooses among lobes.
  std::optional<BsdfSample> sample(Vec3 wo_local, Vec2 u, float u_lobe) const;
  // Every direction that a delta BSDF scatters to, each with its share of the light in the weight: what is
  // reflected, and what is refracted.
  std::array<std::optional<BsdfSample>, 2> delta_branches(Vec3 wo_local) const;

 private:
  struct Diffuse {
    Rgb albedo;
  };
  struct Specular {
    Rgb reflectance;
  };
  struct Dielectric {
    float eta;  // of the far side over the near side
    Rgb reflectance, transmittance;
  };
  using AtPoint = std::variant<Diffuse, Specular, Dielectric>;

  static AtPoint look_up(const MaterialModel& model, const std::vector<Texture>& textures, Vec2 uv,
                         bool outside);

  static std::optional<BsdfSample> sample(const Diffuse& diffuse, Vec3 wo_local, Vec2 u, float u_lobe);
  static std::optional<BsdfSample> sample(const Specular& specular, Vec3 wo_local, Vec2 u, float u_lobe);
  static std::optional<BsdfSample> sample(const Dielectric& dielectric, Vec3 wo_local, Vec2 u, float u_lobe);

  AtPoint at_point_;
};

}  // namespace tessera::core
