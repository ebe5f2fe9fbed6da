// SPDX-License-Identifier: Apache-2.0
#include "core/scene/mitsuba/read_transform.hpp"

#include <algorithm>
#include <cmath>

#include "core/scene/mitsuba/parse_values.hpp"

namespace tessera::core::mitsuba {
namespace {

// By "value", of one number or three, or else by "x", "y" and "z".
std::optional<Vec3> read_vector(const Attributes& attributes, float missing) {
  if (const std::string* value = attributes.find("value")) return parse_triple(*value);
  Vec3 vector{missing, missing, missing};
  constexpr std::string_view kAxes = "xyz";
  for (int axis = 0; axis < 3; ++axis) {
    const std::string* value = attributes.find(kAxes.substr(static_cast<std::size_t>(axis), 1));
    if (value == nullptr) continue;
    const auto number = parse_number(*value);
    if (!number) return std::nullopt;
    vector[axis] = static_cast<float>(*number);
  }
  return vector;
}

std::optional<Transform> read_rotation(const Attributes& attributes) {
  const auto axis = read_vector(attributes, 0);
  const auto degrees = parse_number(attributes.text("angle"));
  if (!axis || !degrees || *axis == Vec3{}) return std::nullopt;
  return rotation(*axis, static_cast<float>(std::fmod(*degrees, 360.0)));
}

// The axis that is farthest from the direction.
Vec3 any_up(Vec3 direction) {
  const Vec3 size = abs(direction);
  if (size.x <= size.y && size.x <= size.z) return {1, 0, 0};
  return size.y <= size.z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
}

std::optional<Transform> read_look_at(const Attributes& attributes) {
  const auto origin = parse_triple(attributes.text("origin")),
             target = parse_triple(attributes.text("target"));
  if (!origin || !target) return std::nullopt;
  const std::string_view written_up = attributes.text("up");
  const auto up = written_up.empty() ? std::optional(Vec3{}) : parse_triple(written_up);
  if (!up) return std::nullopt;
  return look_at(*origin, *target, *up == Vec3{} ? any_up(*target - *origin) : *up);
}

std::optional<Transform> read_matrix(const Attributes& attributes) {
  const auto numbers = parse_numbers(attributes.text("value"));
  if (!numbers || (numbers->size() != 9 && numbers->size() != 16)) return std::nullopt;
  const std::size_t columns = numbers->size() == 9 ? 3 : 4;
  const auto column = [&](std::size_t j) {
    if (j >= columns) return Vec3{};
    const auto entry = [&](std::size_t i) { return static_cast<float>((*numbers)[i * columns + j]); };
    return Vec3{entry(0), entry(1), entry(2)};
  };
  return Transform{column(0), column(1), column(2), column(3)};
}

bool is_finite_map(const Transform& t) {
  return core::is_finite(t.x_axis) && core::is_finite(t.y_axis) && core::is_finite(t.z_axis) &&
         core::is_finite(t.origin);
}

std::optional<Transform> read_any_step(std::string_view tag, const Attributes& attributes) {
  if (tag == "rotate") return read_rotation(attributes);
  if (tag == "lookat" || tag == "lookAt") return read_look_at(attributes);
  if (tag == "matrix") return read_matrix(attributes);
  const auto vector = read_vector(attributes, tag == "scale" ? 1 : 0);
  if (!vector || (tag != "scale" && tag != "translate")) return std::nullopt;
  return tag == "scale" ? scaling(*vector) : translation(*vector);
}

}  // namespace

const std::string* Attributes::find(std::string_view name) const {
  const auto found = std::find_if(list_.begin(), list_.end(),
                                  [&](const auto& attribute) { return attribute.first == name; });
  return found == list_.end() ? nullptr : &found->second;
}

std::string_view Attributes::text(std::string_view name) const {
  const std::string* value = find(name);
  return value == nullptr ? std::string_view() : *value;
}

std::optional<Transform> look_at(Vec3 origin, Vec3 target, Vec3 up) {
  const Vec3 forward = normalize(target - origin);
  const Vec3 left = normalize(cross(up, forward));
  const Transform view{left, cross(forward, left), forward, origin};
  return is_finite_map(view) ? std::optional(view) : std::nullopt;
}

std::optional<Transform> read_step(std::string_view tag, const Attributes& attributes) {
  const auto step = read_any_step(tag, attributes);
  return step && is_finite_map(*step) ? step : std::nullopt;
}

}  // namespace tessera::core::mitsuba
