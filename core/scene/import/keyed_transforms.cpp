// SPDX-License-Identifier: Apache-2.0
#include "core/scene/import/keyed_transforms.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/math/quaternion.hpp"

namespace tessera::core {
namespace {

// A linear map in double, row by row.
using Linear = std::array<std::array<double, 3>, 3>;

// Differences of linear maps that rounding explains, relative to their size.
constexpr double kRoundingOfMaps = 1e-5;

template <typename Entry>
Linear linear_of(const Entry& entry) {
  Linear m{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) m[i][j] = entry(i, j);
  return m;
}

Linear linear_part(const Transform& t) {
  return linear_of([&](std::size_t i, std::size_t j) {
    const Vec3& column = j == 0 ? t.x_axis : j == 1 ? t.y_axis : t.z_axis;
    return double{column[static_cast<int>(i)]};
  });
}

double cofactor(const Linear& m, std::size_t row, std::size_t column) {
  const std::size_t r1 = (row + 1) % 3, r2 = (row + 2) % 3, c1 = (column + 1) % 3, c2 = (column + 2) % 3;
  return m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1];
}

double determinant(const Linear& m) {
  return m[0][0] * cofactor(m, 0, 0) + m[0][1] * cofactor(m, 0, 1) + m[0][2] * cofactor(m, 0, 2);
}

double largest_difference(const Linear& a, const Linear& b) {
  double largest = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) largest = std::max(largest, std::fabs(a[i][j] - b[i][j]));
  return largest;
}

// The orthogonal map nearest to a linear one (Higham 1986); nullopt if it has no inverse.
std::optional<Linear> nearest_orthogonal(const Linear& linear) {
  constexpr int kMaxSteps = 100;
  Linear q = linear;
  for (int step = 0; step < kMaxSteps; ++step) {
    const double det = determinant(q);
    if (!std::isnormal(det)) return std::nullopt;
    const Linear next =
        linear_of([&](std::size_t i, std::size_t j) { return (q[i][j] + cofactor(q, i, j) / det) / 2; });
    const double change = largest_difference(next, q);
    q = next;
    if (!std::isfinite(change)) return std::nullopt;
    if (change < 1e-14) break;
  }
  return q;
}

// Of unit length, from the largest of its components (Shepperd 1978).
Quaternion quaternion_of(const Linear& m) {
  const double trace = m[0][0] + m[1][1] + m[2][2];
  const std::array<double, 4> squares{1 + trace, 1 + 2 * m[0][0] - trace, 1 + 2 * m[1][1] - trace,
                                      1 + 2 * m[2][2] - trace};  // four times those of w, x, y and z
  const auto largest =
      static_cast<std::size_t>(std::max_element(squares.begin(), squares.end()) - squares.begin());
  const double wx = m[2][1] - m[1][2], wy = m[0][2] - m[2][0], wz = m[1][0] - m[0][1];
  const double xy = m[1][0] + m[0][1], xz = m[0][2] + m[2][0], yz = m[2][1] + m[1][2];
  const std::array<std::array<double, 4>, 4> multiples{{{squares[0], wx, wy, wz},
                                                        {wx, squares[1], xy, xz},
                                                        {wy, xy, squares[2], yz},
                                                        {wz, xz, yz, squares[3]}}};
  const auto& q = multiples[largest];
  const double size = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  const auto part = [&](std::size_t i) { return static_cast<float>(q[i] / size); };
  return {part(0), part(1), part(2), part(3)};
}

// A stretch, then a rotation.
struct Parts {
  Linear stretch;
  Quaternion rotation;
  bool reflects;  // the stretch is negative
};

std::optional<Parts> parts_of(const Transform& transform) {
  const Linear linear = linear_part(transform);
  const auto nearest = nearest_orthogonal(linear);
  if (!nearest) return std::nullopt;
  const bool reflects = determinant(*nearest) < 0;
  const double sign = reflects ? -1 : 1;
  const Linear turn = linear_of([&](std::size_t i, std::size_t j) { return sign * (*nearest)[i][j]; });
  const Linear stretch = linear_of([&](std::size_t i, std::size_t j) {
    return turn[0][i] * linear[0][j] + turn[1][i] * linear[1][j] + turn[2][i] * linear[2][j];
  });
  return Parts{stretch, quaternion_of(turn), reflects};
}

bool is_near(const Linear& a, const Linear& b) {
  return largest_difference(a, b) <=
         kRoundingOfMaps * std::max(largest_difference(a, {}), largest_difference(b, {}));
}

bool is_diagonal(const Linear& m) {
  return is_near(m, linear_of([&](std::size_t i, std::size_t j) { return i == j ? m[i][j] : 0; }));
}

Transform transform_of(const Linear& m) {
  const auto column = [&](std::size_t j) {
    return Vec3{static_cast<float>(m[0][j]), static_cast<float>(m[1][j]), static_cast<float>(m[2][j])};
  };
  return {column(0), column(1), column(2), {}};
}

// The step that stretches; constant if it is not exact.
MotionStep stretch_step(const std::vector<float>& frames, const std::vector<Parts>& parts, bool& is_exact) {
  const auto all = [&](const auto& holds) { return std::all_of(parts.begin(), parts.end(), holds); };
  const Transform first = transform_of(parts[0].stretch);
  is_exact = true;
  if (all([&](const Parts& each) { return is_near(each.stretch, parts[0].stretch); })) return first;
  is_exact = all([](const Parts& each) { return is_diagonal(each.stretch); });
  if (!is_exact) return first;
  ScaleMotion scale{{frames, {}}};
  for (const Parts& each : parts) {
    const Transform axes = transform_of(each.stretch);
    scale.factors.values.push_back({axes.x_axis.x, axes.y_axis.y, axes.z_axis.z});
  }
  return scale;
}

}  // namespace

std::optional<TransformMotion> motion_through(const KeyedTransforms& keys) {
  std::vector<float> frames;
  std::vector<Parts> parts;
  RotationMotion turn;
  TranslationMotion move;
  for (const auto& [frame, transform] : keys) {
    const auto each = parts_of(transform);
    if (!each || (!parts.empty() && each->reflects != parts[0].reflects)) return std::nullopt;
    frames.push_back(frame);
    parts.push_back(*each);
    turn.rotations.values.push_back(each->rotation);
    move.offsets.values.push_back(transform.origin);
  }
  turn.rotations.frames = move.offsets.frames = frames;
  TransformMotion motion;
  motion.steps.push_back(stretch_step(frames, parts, motion.is_exact));
  motion.steps.emplace_back(std::move(turn));
  motion.steps.emplace_back(std::move(move));
  return motion;
}

Vec3 look_at_along(Vec3 position, Vec3 forward) {
  return position + normalize(forward) * std::max(1.0f, length(position));
}

// Keyframes are so close that what lies between them is all but straight.
bool animate_camera(const KeyedTransforms& keys, CameraDescription& camera, CameraAnimation& animation) {
  const auto motion = motion_through(keys);
  if (!motion) return false;
  constexpr int kParts = 32;
  const auto add = [&](float frame) {
    if (!animation.position.empty() && !(frame > animation.position.frames.back())) return;
    const Transform at = transform_at(motion->steps, frame);
    for (Track<Vec3>* track : {&animation.position, &animation.look_at, &animation.up})
      track->frames.push_back(frame);
    animation.position.values.push_back(at.origin);
    animation.look_at.values.push_back(look_at_along(at.origin, at.z_axis));
    animation.up.values.push_back(at.y_axis);
  };
  add(keys[0].frame);
  for (std::size_t i = 1; i < keys.size(); ++i)
    for (int part = 1; part <= kParts; ++part)
      add(FrameInterval{keys[i - 1].frame, keys[i].frame}.at(static_cast<float>(part) / kParts));
  camera.position = value_at(animation.position, 0, camera.position);
  camera.look_at = value_at(animation.look_at, 0, camera.look_at);
  camera.up = value_at(animation.up, 0, camera.up);
  return true;
}

}  // namespace tessera::core
