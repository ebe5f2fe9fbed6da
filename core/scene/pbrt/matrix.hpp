// SPDX-License-Identifier: Apache-2.0
// Affine maps in double precision, as the transformation directives of a scene file compose them. Stateless;
// thread-safe.
#pragma once

#include <array>
#include <optional>

#include "core/math/transform.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core::pbrt {

// Three rows; the fourth column is the translation.
struct Matrix {
  std::array<std::array<double, 4>, 3> rows{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

  bool operator==(const Matrix&) const = default;
  // Negative if the map reflects.
  double determinant() const;
  Transform transform() const;
  Vec3 point(Vec3 p) const;
  Vec3 direction(Vec3 d) const;
};

// Applies `inner`, then `outer`.
Matrix operator*(const Matrix& outer, const Matrix& inner);
// nullopt for a map that flattens space.
std::optional<Matrix> inverse(const Matrix& matrix);

Matrix translate(double x, double y, double z);
Matrix scale(double x, double y, double z);
// Counter-clockwise seen from the tip of the axis; the identity for an axis of length 0.
Matrix rotate(double degrees, Vec3 axis);
// From the world to a camera at `eye`: z toward `at`, y up, x to the right (left-handed). nullopt if these
// directions are not defined.
std::optional<Matrix> look_at(Vec3 eye, Vec3 at, Vec3 up);

}  // namespace tessera::core::pbrt
