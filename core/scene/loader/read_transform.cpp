// SPDX-License-Identifier: Apache-2.0
// Reads transforms of a scene file, which are lists of steps.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "core/scene/loader/scene_file.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

Vec3 read_scale(const Field& field) {
  if (field.value().get_if<JsonValue::Array>()) return read_vec3(field, ranges::kNotZero);
  const float factor = read_float(field, ranges::kNotZero);
  return {factor, factor, factor};
}

// The axis of a rotation. Not zero, also after a mistake.
Vec3 read_axis(const Field& rotation, const ObjectReader& object) {
  const Vec3 axis = read_or(object, "axis", Vec3{0, 1, 0}, read_vec3, ranges::kAny);
  if (length(axis) > 0 && std::isfinite(length(axis))) return axis;
  rotation.mistake("'axis' must have a length that is greater than 0 and can be computed");
  return {0, 1, 0};
}

// [w, x, y, z], of unit length.
Quaternion read_quaternion(const Field& field) {
  constexpr std::size_t kCount = 4;
  const auto* items = field.value().get_if<JsonValue::Array>();
  std::array<float, kCount> q{1, 0, 0, 0};
  if (items == nullptr || items->size() != kCount) {
    field.must_be("a list of 4 numbers, [w, x, y, z]");
    return {};
  }
  for (std::size_t i = 0; i < kCount; ++i) q[i] = read_float(field.element(i), ranges::kAny);
  const float squared_norm = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  if (!(std::fabs(squared_norm - 1) < 1e-3f)) field.must_be("a quaternion of length 1");
  return {q[0], q[1], q[2], q[3]};
}

Quaternion read_rotation_key(const Field& field) {
  if (find_member_field(field, "quaternion")) {
    const ObjectReader object(field, scene_keys::kQuaternion);
    return read_or(object, "quaternion", Quaternion(), read_quaternion);
  }
  const ObjectReader object(field, scene_keys::kRotation);
  const Vec3 axis = read_axis(field, object);
  return rotation_quaternion(axis, read_or(object, "degrees", 0.0f, read_float, ranges::kDegrees));
}

// Keyframes of whole rotations, or of the angle about a fixed axis, or neither.
MotionStep read_rotation(const Field& field) {
  if (has_keyframes(field)) {
    RotationMotion motion;
    read_animated(field, motion.rotations, read_rotation_key);
    return motion;
  }
  if (find_member_field(field, "quaternion")) return rotation(read_rotation_key(field));
  const ObjectReader object(field, scene_keys::kRotation);
  TurnMotion motion{read_axis(field, object), {}};
  const float degrees =
      read_animated_or(object, "degrees", 0.0f, motion.degrees, read_float, ranges::kDegrees);
  if (motion.degrees.empty()) return rotation(motion.axis, degrees);
  return motion;
}

MotionStep read_scaling(const Field& field) {
  ScaleMotion motion;
  const Vec3 factors = read_animated(field, motion.factors, read_scale);
  if (motion.factors.empty()) return scaling(factors);
  return motion;
}

MotionStep read_translation(const Field& field) {
  TranslationMotion motion;
  const Vec3 offset = read_animated(field, motion.offsets, read_vec3, ranges::kAny);
  if (motion.offsets.empty()) return translation(offset);
  return motion;
}

// Three rows of four numbers: p is multiplied by the first three columns, and the fourth is added.
Transform read_matrix(const Field& field) {
  const auto* rows = field.value().get_if<JsonValue::Array>();
  const auto is_row = [](const JsonValue& row) {
    const auto* numbers = row.get_if<JsonValue::Array>();
    return numbers != nullptr && numbers->size() == 4;
  };
  if (has_keyframes(field)) {
    field.mistake("a matrix cannot be animated; write it as the steps 'scale', 'rotate' and 'translate'");
    return {};
  }
  if (rows == nullptr || rows->size() != 3 || !std::all_of(rows->begin(), rows->end(), is_row)) {
    field.must_be("three rows of four numbers such as [[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 0]]");
    return {};
  }
  Transform matrix;
  for (int i = 0; i < 3; ++i) {
    const Field row = field.element(static_cast<std::size_t>(i));
    matrix.x_axis[i] = read_float(row.element(0), ranges::kAny);
    matrix.y_axis[i] = read_float(row.element(1), ranges::kAny);
    matrix.z_axis[i] = read_float(row.element(2), ranges::kAny);
    matrix.origin[i] = read_float(row.element(3), ranges::kAny);
  }
  return matrix;
}

MotionStep read_step(const Field& field) {
  const ObjectReader object(field, scene_keys::kTransformStep);
  const auto* members = field.value().get_if<JsonValue::Object>();
  if (members == nullptr) return {};
  if (members->size() != 1) {
    field.mistake(
        "a step is one of 'scale', 'rotate', 'translate' and 'matrix'; write several as a list of steps");
    return {};
  }
  if (const auto factors = object.find("scale")) return read_scaling(*factors);
  if (const auto turn = object.find("rotate")) return read_rotation(*turn);
  if (const auto offset = object.find("translate")) return read_translation(*offset);
  if (const auto matrix = object.find("matrix")) return read_matrix(*matrix);
  return {};
}

bool is_usable(const Transform& t) {
  const float determinant = t.determinant();
  return is_finite(t.origin) && std::isfinite(determinant) && determinant != 0;
}

// Frames between two keyframes are checked when they are rendered.
bool is_usable_at_keyframes(const std::vector<MotionStep>& motion, const Field& field) {
  for (const float frame : keyframes_of(motion)) {
    if (is_usable(transform_at(motion, frame))) continue;
    field.mistake(fmt::format(
        "at frame {}, the steps together flatten, scale or move the shape too far to be computed", frame));
    return false;
  }
  return true;
}

}  // namespace

TransformEntry read_transform(const Field& field) {
  const auto* steps = field.value().get_if<JsonValue::Array>();
  if (steps == nullptr) {
    field.must_be("a list of steps such as [{\"scale\": 2}, {\"translate\": [0, 1, 0]}]");
    return {};
  }
  const std::size_t mistakes_before = field.mistakes().count();
  std::vector<MotionStep> motion;
  for (std::size_t i = 0; i < steps->size(); ++i) motion.push_back(read_step(field.element(i)));
  if (field.mistakes().count() > mistakes_before) return {};
  const Transform all = transform_at(motion, 0);
  if (!is_usable(all)) {
    field.mistake("the steps together scale or move too far to be computed");
    return {};
  }
  if (keyframes_of(motion).empty()) return {all, {}};
  if (!is_usable_at_keyframes(motion, field)) return {};
  return {all, std::move(motion)};
}

}  // namespace tessera::core
