// SPDX-License-Identifier: Apache-2.0
#include "scenes/modelling/cloth.hpp"

#include <cmath>
#include <cstddef>
#include <vector>

#include "scenes/modelling/curve.hpp"

namespace tessera::modelling {
namespace {

struct Link {
  std::size_t a, b;
  float length, stiffness;
};

class Simulation {
 public:
  explicit Simulation(const Cloth& cloth) : cloth_(cloth) {
    for (int j = 0; j <= cloth.rows; ++j) {
      for (int i = 0; i <= cloth.columns; ++i) {
        positions_.push_back(cloth.start(static_cast<float>(i) / static_cast<float>(cloth.columns),
                                         static_cast<float>(j) / static_cast<float>(cloth.rows)));
        add_links(i, j);
      }
    }
    previous_ = positions_;
  }

  void step() {
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      const Vec3 velocity = (positions_[i] - previous_[i]) * (1 - cloth_.damping);
      previous_[i] = positions_[i];
      positions_[i] += velocity - Vec3{0, cloth_.gravity, 0};
    }
    for (int i = 0; i < cloth_.iterations; ++i) {
      for (const Link& link : links_) shorten_or_stretch(link);
      for (std::size_t k = 0; k < positions_.size(); ++k) collide(k);
    }
  }

  const std::vector<Vec3>& positions() const { return positions_; }

 private:
  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(cloth_.columns + 1) +
           static_cast<std::size_t>(i);
  }

  // Threads, shear and bending: to neighbours on the left and above, diagonally, and two squares away.
  void add_links(int i, int j) {
    const auto link = [&](int di, int dj, float stiffness) {
      const int ni = i + di, nj = j + dj;
      if (ni < 0 || ni > cloth_.columns || nj < 0) return;
      const auto squares = std::sqrt(static_cast<float>(di * di + dj * dj));
      links_.push_back({index(ni, nj), index(i, j), squares * cloth_.spacing, stiffness});
    };
    link(-1, 0, 1);
    link(0, -1, 1);
    link(-1, -1, 0.4f);
    link(1, -1, 0.4f);
    link(-2, 0, cloth_.stiffness_bending);
    link(0, -2, cloth_.stiffness_bending);
  }

  void shorten_or_stretch(const Link& link) {
    const Vec3 apart = positions_[link.b] - positions_[link.a];
    const float distance = length(apart);
    if (distance == 0) return;
    const Vec3 half = apart * (0.5f * link.stiffness * (distance - link.length) / distance);
    positions_[link.a] += half;
    positions_[link.b] += -half;
  }

  // Out of the obstacle, and back along its surface by what friction takes of this step's movement.
  void collide(std::size_t k) {
    const Vec3 out = cloth_.push_out(positions_[k]), push = out - positions_[k];
    const float push_squared = length_squared(push);
    if (push_squared < 1e-12f) return;
    const Vec3 back = previous_[k] - out;
    positions_[k] = out + (back - push * (dot(back, push) / push_squared)) * cloth_.friction;
  }

  const Cloth& cloth_;
  std::vector<Vec3> positions_, previous_;
  std::vector<Link> links_;
};

// Puts a spline through each row of a grid of `width` points to a row, takes `refined_width` points of each,
// and turns rows into columns: twice, it refines a grid both ways.
std::vector<Vec3> refine_and_transpose(const std::vector<Vec3>& points, int width, int refined_width) {
  const auto row_length = static_cast<std::ptrdiff_t>(width);
  const std::size_t rows = points.size() / static_cast<std::size_t>(width);
  std::vector<Vec3> refined(rows * static_cast<std::size_t>(refined_width));
  for (std::size_t j = 0; j < rows; ++j) {
    const auto begin = points.begin() + static_cast<std::ptrdiff_t>(j) * row_length;
    const std::vector<Vec3> row(begin, begin + row_length);
    for (int i = 0; i < refined_width; ++i) {
      const float t = static_cast<float>(i) / static_cast<float>(refined_width - 1);
      refined[static_cast<std::size_t>(i) * rows + j] = spline(row, t);
    }
  }
  return refined;
}

}  // namespace

MeshDescription drape(const Cloth& cloth) {
  Simulation simulation(cloth);
  for (int i = 0; i < cloth.steps; ++i) simulation.step();
  const int columns = cloth.columns * cloth.refinement, rows = cloth.rows * cloth.refinement;
  const std::vector<Vec3> wide = refine_and_transpose(simulation.positions(), cloth.columns + 1, columns + 1);
  return grid_mesh({uniform_lines(columns), uniform_lines(rows)},
                   refine_and_transpose(wide, cloth.rows + 1, rows + 1));
}

}  // namespace tessera::modelling
