// SPDX-License-Identifier: Apache-2.0
// The directives that change the current transformation, and what becomes of it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/scene/loader/wording.hpp"
#include "core/scene/pbrt/interpreter.hpp"

namespace tessera::core::pbrt {

void Interpreter::set_transform(const AnimatedMatrix& matrix) {
  if (state_.is_start_active) state_.transform.start = matrix.start;
  if (state_.is_end_active) state_.transform.end = matrix.end;
}

void Interpreter::apply(const Matrix& matrix) {
  set_transform(state_.transform * AnimatedMatrix{matrix, matrix});
}

const Matrix& Interpreter::still_transform(const Place& place, std::string_view what) const {
  if (state_.transform.moves()) {
    const std::string text = fmt::format("{} does not move; it is where it is at the start", what);
    report_.warn(place, text, text);
  }
  return state_.transform.start;
}

std::optional<std::vector<MotionStep>> Interpreter::motion_here(const Place& place) {
  if (!state_.transform.moves()) return std::nullopt;
  const auto keys = keyed_transforms(state_.transform, view_.times, shutter_open_s(view_));
  auto motion = keys ? motion_through(*keys) : std::nullopt;
  if (!motion) {
    report_.warn(
        place, "no motion between",
        "no motion leads from the transformation at the start to that at the end; the former counts");
    return std::nullopt;
  }
  if (!motion->is_exact)
    report_.warn(place, "stretched while moving",
                 "a shape that is stretched while it moves keeps the stretch of the start");
  return std::move(motion->steps);
}

void Interpreter::add_moving(std::uint32_t object, std::vector<MotionStep> steps, std::string name,
                             const Place& place) {
  SceneDescription& scene = builder_.scene();
  if (!builder_.add_instance(object, transform_at(steps, 0), std::move(name), file_place(place))) return;
  scene.animation.instances.push_back(
      {static_cast<std::uint32_t>(scene.shapes.size()) - 1, std::move(steps)});
  open_shutter(view_, builder_);
}

Status Interpreter::active_transform(File& file) {
  const auto token = file.tokens.next();
  if (!token) return at(file, token.error());
  if (token->text != "All" && token->text != "StartTime" && token->text != "EndTime")
    return report_.error(place(file),
                         fmt::format("expected All, StartTime or EndTime, got {}", in_quotes(token->text)));
  state_.is_start_active = token->text != "EndTime";
  state_.is_end_active = token->text != "StartTime";
  return {};
}

Status Interpreter::transform_times(File& file) {
  const auto times = numbers(file, 2);
  if (!times) return fail(times.error());
  constexpr float kMaxTime_s = 1e6f;
  const auto limited = [&](float time) {
    const float kept = std::isnan(time) ? 0 : std::clamp(time, -kMaxTime_s, kMaxTime_s);
    if (kept != time)
      report_.warn(place(file), "time", fmt::format("a time is {}; {} seconds are used", time, kept));
    return kept;
  };
  view_.times = {limited((*times)[0]), limited((*times)[1])};
  return {};
}

// Sixteen numbers, column by column.
Result<Matrix> Interpreter::matrix_argument(File& file) {
  const auto given = numbers(file, 16);
  if (!given) return fail(given.error());
  const std::vector<float>& m = *given;
  Matrix matrix;
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 4; ++column)
      matrix.rows[row][column] = static_cast<double>(m[4 * column + row]);
  if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
    report_.warn(place(file), "the fourth row of a transformation is not 0 0 0 1; it is ignored");
  return matrix;
}

Status Interpreter::transform_directive(File& file) {
  const auto matrix = matrix_argument(file);
  if (!matrix) return fail(matrix.error());
  set_transform({*matrix, *matrix});
  return {};
}

Status Interpreter::concat_transform(File& file) {
  const auto matrix = matrix_argument(file);
  if (!matrix) return fail(matrix.error());
  apply(*matrix);
  return {};
}

Status Interpreter::identity(File&) {
  set_transform({});
  return {};
}

Status Interpreter::translate_directive(File& file) {
  const auto v = numbers(file, 3);
  if (!v) return fail(v.error());
  apply(translate(static_cast<double>((*v)[0]), static_cast<double>((*v)[1]), static_cast<double>((*v)[2])));
  return {};
}

Status Interpreter::scale_directive(File& file) {
  const auto v = numbers(file, 3);
  if (!v) return fail(v.error());
  apply(scale(static_cast<double>((*v)[0]), static_cast<double>((*v)[1]), static_cast<double>((*v)[2])));
  return {};
}

Status Interpreter::rotate_directive(File& file) {
  const auto v = numbers(file, 4);
  if (!v) return fail(v.error());
  const Vec3 axis{(*v)[1], (*v)[2], (*v)[3]};
  if (!(length(axis) > 0) || !std::isfinite((*v)[0])) {
    report_.warn(place(file), "a rotation without an axis or an angle is left out");
    return {};
  }
  apply(rotate(static_cast<double>((*v)[0]), axis));
  return {};
}

Status Interpreter::look_at_directive(File& file) {
  const auto v = numbers(file, 9);
  if (!v) return fail(v.error());
  const std::vector<float>& n = *v;
  const auto camera_from_world = look_at({n[0], n[1], n[2]}, {n[3], n[4], n[5]}, {n[6], n[7], n[8]});
  if (!camera_from_world)
    return report_.error(place(file),
                         "LookAt needs two different points and a vector that is not parallel to their line");
  apply(*camera_from_world);
  return {};
}

Status Interpreter::coordinate_system(File& file) {
  auto name = text(file);
  if (!name) return fail(name.error());
  coordinate_systems_[std::move(*name)] = state_.transform;
  return {};
}

Status Interpreter::coord_sys_transform(File& file) {
  const auto name = text(file);
  if (!name) return fail(name.error());
  const auto known = coordinate_systems_.find(*name);
  if (known == coordinate_systems_.end()) {
    report_.warn(place(file), fmt::format("the coordinate system {} is not known; the transformation stays",
                                          in_quotes(*name)));
    return {};
  }
  set_transform(known->second);
  return {};
}

}  // namespace tessera::core::pbrt
