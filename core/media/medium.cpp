// SPDX-License-Identifier: Apache-2.0
#include "core/media/medium.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/math/elementary.hpp"

namespace tessera::core {
namespace {

// Interpolation can exceed the values between which it interpolates by rounding.
constexpr float kMajorantMargin = 1 + 1e-5f;

double axis_of(const Vec3d& v, std::size_t axis) {
  return v[static_cast<int>(axis)];
}

float channel_transmittance(float sigma, double distance) {
  return sigma == 0 ? 1.0f : static_cast<float>(exp(-static_cast<double>(sigma) * distance));
}

}  // namespace

Rgb beam_transmittance(Rgb sigma, double distance) {
  const float r = channel_transmittance(sigma.r, distance);
  const float g = sigma.g == sigma.r ? r : channel_transmittance(sigma.g, distance);
  const float b = sigma.b == sigma.g ? g : channel_transmittance(sigma.b, distance);
  return {r, g, b};
}

Medium::Medium(const MediumDescription& description, Grids grids)
    : full_{description.sigma_a * description.scale, description.sigma_s * description.scale,
            description.emission},
      g_(description.g),
      scatters_(!is_black(full_.sigma_s)),
      absorption_grid_(description.absorption_grid),
      scattering_grid_(description.scattering_grid),
      emission_grid_(description.emission_grid),
      grids_(std::move(grids)) {
  if (!description.has_grid()) return;
  placement_.emplace(description.grid_to_world);
  find_majorants();
}

Rgb Medium::grid_value(int grid, Vec3 p) const {
  return grid < 0 ? Rgb::gray(1) : value_at((*grids_)[static_cast<std::size_t>(grid)], p);
}

Rgb Medium::grid_bound(int grid, Vec3 lower, Vec3 upper) const {
  return grid < 0 ? Rgb::gray(1) : bound_in((*grids_)[static_cast<std::size_t>(grid)], lower, upper);
}

MediumPoint Medium::at(Vec3 p) const {
  const Rgb absorption = grid_value(absorption_grid_, p);
  const Rgb scattering = scattering_grid_ == absorption_grid_ ? absorption : grid_value(scattering_grid_, p);
  const Rgb emission = is_black(full_.emission) ? Rgb{} : full_.emission * grid_value(emission_grid_, p);
  return {full_.sigma_a * absorption, full_.sigma_s * scattering, emission};
}

void Medium::find_majorants() {
  cells_.fill(1);
  for (const int grid : {absorption_grid_, scattering_grid_, emission_grid_})
    if (grid >= 0)
      for (std::size_t axis = 0; axis < 3; ++axis)
        cells_[axis] =
            std::max(cells_[axis], static_cast<int>(std::min<std::uint32_t>(
                                       kMaxCells, (*grids_)[static_cast<std::size_t>(grid)].size[axis])));
  const auto corner = [&](int x, int y, int z) {
    return Vec3{static_cast<float>(x) / static_cast<float>(cells_[0]),
                static_cast<float>(y) / static_cast<float>(cells_[1]),
                static_cast<float>(z) / static_cast<float>(cells_[2])};
  };
  for (int z = 0; z < cells_[2]; ++z)
    for (int y = 0; y < cells_[1]; ++y)
      for (int x = 0; x < cells_[0]; ++x) {
        const Vec3 lower = corner(x, y, z), upper = corner(x + 1, y + 1, z + 1);
        const Rgb most = full_.sigma_a * grid_bound(absorption_grid_, lower, upper) +
                         full_.sigma_s * grid_bound(scattering_grid_, lower, upper);
        majorants_.push_back(most * kMajorantMargin);
      }
}

Rgb Medium::majorant(const std::array<int, 3>& cell) const {
  return majorants_[static_cast<std::size_t>((cell[2] * cells_[1] + cell[1]) * cells_[0] + cell[0])];
}

MediumRay::MediumRay(const Medium& medium, const Ray& ray, float t_max)
    : medium_(medium), length_per_t_(length(ray.direction)) {
  const ObjectRay in_grid = medium.placement_->to_object(ray);
  origin_ = in_grid.origin;
  direction_ = in_grid.direction;
  enter_grid(static_cast<double>(std::min(t_max, kMediumReach / length_per_t_)));
}

// Clips the ray to the unit cube and finds the first cell.
void MediumRay::enter_grid(double t_max) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  double enter = 0, leave = t_max;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double o = axis_of(origin_, axis), d = axis_of(direction_, axis);
    if (d == 0) {
      if (!(o >= 0 && o <= 1)) leave = -1;
      continue;
    }
    const double a = (0 - o) / d, b = (1 - o) / d;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  done_ = !(enter < leave);
  if (done_) return;
  t_ = enter;
  t_end_ = leave;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double o = axis_of(origin_, axis), d = axis_of(direction_, axis);
    const int cells = medium_.cells_[axis];
    const double place = std::clamp((o + t_ * d) * cells, 0.0, static_cast<double>(cells - 1));
    cell_[axis] = static_cast<int>(place);
    step_[axis] = d > 0 ? 1 : -1;
    const int face = cell_[axis] + (d > 0 ? 1 : 0);
    next_t_[axis] = d == 0 ? kNever : (static_cast<double>(face) / cells - o) / d;
    delta_t_[axis] = d == 0 ? kNever : 1 / (cells * std::fabs(d));
  }
}

std::optional<MajorantSegment> MediumRay::next() {
  if (done_) return std::nullopt;
  const std::size_t yz = next_t_[2] < next_t_[1] ? 2 : 1;
  const std::size_t axis = next_t_[yz] < next_t_[0] ? yz : 0;
  const double t1 = std::clamp(next_t_[axis], t_, t_end_);
  const MajorantSegment segment{static_cast<float>(t_), static_cast<float>(t1), medium_.majorant(cell_)};
  t_ = t1;
  cell_[axis] += step_[axis];
  next_t_[axis] += delta_t_[axis];
  done_ = !(t_ < t_end_) || cell_[axis] < 0 || cell_[axis] >= medium_.cells_[axis];
  return segment;
}

MediumPoint MediumRay::at(float t) const {
  const double s = static_cast<double>(t);
  const auto coordinate = [&](std::size_t axis) {
    return static_cast<float>(axis_of(origin_, axis) + s * axis_of(direction_, axis));
  };
  return medium_.at({coordinate(0), coordinate(1), coordinate(2)});
}

}  // namespace tessera::core
