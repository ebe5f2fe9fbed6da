// SPDX-License-Identifier: Apache-2.0
// A surface made of lobes in layers. Light that the upper layers reflect to the viewer is taken from the
// lower ones, by the directional albedo for the viewer's direction only: so no energy is gained or lost, at
// the price of reciprocity (Turquin 2019; OpenPBR 1.1, albedo scaling). Directions as in bsdf.hpp.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <variant>

#include "core/materials/lobes.hpp"

namespace tessera::core {

class LobeMixture {
 public:
  using Lobe = std::variant<DiffuseTransmissionLobe, DiffuseLobe, CoveredDiffuseLobe, SheenLobe,
                            GgxLobe<DielectricReflectance>, GgxLobe<ConductorReflectance>,
                            GgxLobe<EdgeTintReflectance>, GgxLobe<FilmReflectance>, GlassLobe, ThinGlassLobe>;

  // What a lobe does to the light of those added after it.
  struct Below {
    float cover = 0;  // the share of the surface where its albedo is taken off
    Rgb tint = Rgb::gray(1);
  };

  LobeMixture() = default;
  LobeMixture(const LobeMixture& other) { *this = other; }
  LobeMixture& operator=(const LobeMixture& other);  // copies no unused lobes

  // Adds at most kMaxLobes lobes, from the top. `weight` multiplies the lobe.
  static constexpr std::size_t kMaxLobes = 8;
  void add(const Lobe& lobe, Rgb weight, const Below& below);
  void add(const Lobe& lobe, Rgb weight) { add(lobe, weight, Below{}); }

  // Turns anisotropic lobes to the direction of increasing u. Its z is ignored.
  void orient(Vec3 tangent_local);

  bool is_delta() const;   // only delta lobes
  bool has_delta() const;  // any
  bool transmits() const;  // by lobes that are not delta
  float transmitted_eta() const;
  void scale_diffuse(float factor);
  BsdfValue evaluate(Vec3 wo_local, Vec3 wi_local, float diffuse_cos) const;
  std::optional<BsdfSample> sample(Vec3 wo_local, Vec2 u, float u_lobe) const;
  // The reflection and the transmission by delta lobes, weighted by their fractions of the light.
  std::array<std::optional<BsdfSample>, 2> delta_branches(Vec3 wo_local) const;

 private:
  struct Layer {
    Lobe lobe;
    Rgb weight;
    Below below;
  };
  // Of each lobe: the factor of its light, and the chance that a sample is its own.
  struct Shares {
    std::array<Rgb, kMaxLobes> light;
    std::array<float, kMaxLobes> chance;
  };

  Shares shares_at(float cos_o) const;
  BsdfValue evaluate(const Shares& shares, Vec3 wo, Vec3 wi, float diffuse_cos) const;
  Vec3 to_tangents(Vec3 w) const;
  Vec3 from_tangents(Vec3 w) const;
  template <typename Predicate>
  bool any_lobe(const Predicate& predicate) const;

  std::array<Layer, kMaxLobes> layers_;
  std::size_t count_ = 0;
  Vec2 tangent_{1, 0};
};

}  // namespace tessera::core
