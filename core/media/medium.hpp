// SPDX-License-Identifier: Apache-2.0
// A participating medium ready to render. Immutable, shared by all threads.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "core/geometry/placement.hpp"
#include "core/geometry/ray.hpp"
#include "core/media/medium_description.hpp"
#include "core/media/voxel_grid.hpp"

namespace tessera::core {

// Media end at this distance from a ray's origin, so that positions there can be computed.
inline constexpr float kMediumReach = 1e15f;

// A medium at a point.
struct MediumPoint {
  Rgb sigma_a{}, sigma_s{};  // per unit of length in the world
  Rgb emission{};            // radiance; sigma_a * emission is emitted per unit of length

  Rgb sigma_t() const { return sigma_a + sigma_s; }
};

// A part of a ray along which sigma_t nowhere exceeds the majorant.
struct MajorantSegment {
  float t0 = 0, t1 = 0;
  Rgb majorant{};
};

class Medium {
 public:
  using Grids = std::shared_ptr<const std::vector<VoxelGrid>>;

  // Both must be valid (validate_scene).
  Medium(const MediumDescription& description, Grids grids);

  // Mean cosine of scattering (henyey_greenstein).
  float g() const { return g_; }
  bool is_homogeneous() const { return majorants_.empty(); }
  // Whether it scatters anywhere; else it only absorbs and emits.
  bool scatters() const { return scatters_; }
  bool emits() const { return !is_black(full_.sigma_a * full_.emission); }
  // Of a homogeneous medium: the same everywhere.
  const MediumPoint& everywhere() const { return full_; }

 private:
  friend class MediumRay;
  static constexpr int kMaxCells = 16;  // of the majorants along an axis

  // At a point of the unit cube.
  MediumPoint at(Vec3 p) const;
  Rgb grid_value(int grid, Vec3 p) const;
  Rgb grid_bound(int grid, Vec3 lower, Vec3 upper) const;
  void find_majorants();
  Rgb majorant(const std::array<int, 3>& cell) const;

  MediumPoint full_;  // where the grids are 1
  float g_;
  bool scatters_;
  int absorption_grid_, scattering_grid_, emission_grid_;
  Grids grids_;
  std::optional<Placement> placement_;  // of the grids
  std::array<int, 3> cells_{};          // that the unit cube is divided into
  std::vector<Rgb> majorants_;          // of sigma_t, by cell; x runs fastest. Empty if homogeneous
};

// A ray's way through a medium of grids: its majorants from front to back (a digital differential analyser
// over their cells, Amanatides and Woo 1987), and the medium along it. For use by one thread.
class MediumRay {
 public:
  // Up to t_max, which may be infinite, or kMediumReach. Keeps references.
  MediumRay(const Medium& medium, const Ray& ray, float t_max);

  // The next segment, or nothing behind the last.
  std::optional<MajorantSegment> next();
  MediumPoint at(float t) const;
  // Of the ray's direction.
  float length_per_t() const { return length_per_t_; }

 private:
  void enter_grid(double t_max);

  const Medium& medium_;
  float length_per_t_;
  double t_ = 0, t_end_ = 0;
  bool done_ = false;
  // In the space of the grids.
  Vec3d origin_{}, direction_{};
  std::array<int, 3> cell_{}, step_{};
  std::array<double, 3> next_t_{}, delta_t_{};  // of the next face along each axis, and between faces
};

// exp(-sigma * distance), by channel. 1 if sigma is 0, at any distance.
Rgb beam_transmittance(Rgb sigma, double distance);

}  // namespace tessera::core
