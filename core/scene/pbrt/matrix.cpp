// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pbrt/matrix.hpp"

#include <cmath>
#include <cstddef>

#include "core/math/elementary.hpp"

namespace tessera::core::pbrt {
namespace {

float narrowed(double value) {
  return static_cast<float>(value);
}

// Column `i` of the matrix; 3 is the translation.
Vec3 column(const Matrix& m, std::size_t i) {
  return {narrowed(m.rows[0][i]), narrowed(m.rows[1][i]), narrowed(m.rows[2][i])};
}

double cofactor(const Matrix& m, std::size_t row, std::size_t col) {
  const std::size_t r1 = (row + 1) % 3, r2 = (row + 2) % 3, c1 = (col + 1) % 3, c2 = (col + 2) % 3;
  return m.rows[r1][c1] * m.rows[r2][c2] - m.rows[r1][c2] * m.rows[r2][c1];
}

}  // namespace

double Matrix::determinant() const {
  return rows[0][0] * cofactor(*this, 0, 0) + rows[0][1] * cofactor(*this, 0, 1) +
         rows[0][2] * cofactor(*this, 0, 2);
}

Transform Matrix::transform() const {
  return {column(*this, 0), column(*this, 1), column(*this, 2), column(*this, 3)};
}

Vec3 Matrix::point(Vec3 p) const {
  return direction(p) + column(*this, 3);
}

Vec3 Matrix::direction(Vec3 d) const {
  const auto x = static_cast<double>(d.x), y = static_cast<double>(d.y), z = static_cast<double>(d.z);
  const auto dot_row = [&](const std::array<double, 4>& row) {
    return narrowed(row[0] * x + row[1] * y + row[2] * z);
  };
  return {dot_row(rows[0]), dot_row(rows[1]), dot_row(rows[2])};
}

Matrix operator*(const Matrix& outer, const Matrix& inner) {
  Matrix result;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 4; ++j) {
      double sum = j == 3 ? outer.rows[i][3] : 0;
      for (std::size_t k = 0; k < 3; ++k) sum += outer.rows[i][k] * inner.rows[k][j];
      result.rows[i][j] = sum;
    }
  return result;
}

std::optional<Matrix> inverse(const Matrix& matrix) {
  const double determinant = matrix.determinant();
  if (determinant == 0 || !std::isfinite(1 / determinant)) return std::nullopt;
  Matrix result;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) result.rows[i][j] = cofactor(matrix, j, i) / determinant;
    result.rows[i][3] = -(result.rows[i][0] * matrix.rows[0][3] + result.rows[i][1] * matrix.rows[1][3] +
                          result.rows[i][2] * matrix.rows[2][3]);
  }
  return result;
}

Matrix translate(double x, double y, double z) {
  return {{{{1, 0, 0, x}, {0, 1, 0, y}, {0, 0, 1, z}}}};
}

Matrix scale(double x, double y, double z) {
  return {{{{x, 0, 0, 0}, {0, y, 0, 0}, {0, 0, z, 0}}}};
}

// Rodrigues 1840.
Matrix rotate(double degrees, Vec3 axis) {
  const double x = static_cast<double>(axis.x), y = static_cast<double>(axis.y),
               z = static_cast<double>(axis.z);
  const double length = std::sqrt(x * x + y * y + z * z);
  if (!(length > 0) || !std::isfinite(length)) return {};
  const std::array<double, 3> a{x / length, y / length, z / length};
  const double turns = degrees / 360;
  const SinCos angle = sin_cos_turns(narrowed(turns - std::floor(turns)));
  const auto s = static_cast<double>(angle.sin), c = static_cast<double>(angle.cos);
  return {
      {{{c + a[0] * a[0] * (1 - c), a[0] * a[1] * (1 - c) - a[2] * s, a[0] * a[2] * (1 - c) + a[1] * s, 0},
        {a[1] * a[0] * (1 - c) + a[2] * s, c + a[1] * a[1] * (1 - c), a[1] * a[2] * (1 - c) - a[0] * s, 0},
        {a[2] * a[0] * (1 - c) - a[1] * s, a[2] * a[1] * (1 - c) + a[0] * s, c + a[2] * a[2] * (1 - c), 0}}}};
}

std::optional<Matrix> look_at(Vec3 eye, Vec3 at, Vec3 up) {
  const Vec3 view = normalize(at - eye);
  const Vec3 right = normalize(cross(normalize(up), view));
  const Vec3 above = cross(view, right);
  if (!is_finite(view) || !is_finite(right) || !is_finite(above)) return std::nullopt;
  Matrix camera;
  const Vec3 axes[3] = {right, above, view};
  for (std::size_t i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) camera.rows[static_cast<std::size_t>(j)][i] = static_cast<double>(axes[i][j]);
  for (int j = 0; j < 3; ++j) camera.rows[static_cast<std::size_t>(j)][3] = static_cast<double>(eye[j]);
  return inverse(camera);
}

}  // namespace tessera::core::pbrt
