// SPDX-License-Identifier: Apache-2.0
#include "core/scene/writer/motion_text.hpp"

#include "core/base/overloaded.hpp"
#include "core/math/quaternion.hpp"

namespace tessera::core {
namespace {

using json_text::Object;

std::string vector_text(Vec3 v) {
  return json_text::vector(v);
}

std::string quaternion_text(Quaternion q) {
  const auto number = [](float value) { return json_text::number(value); };
  return Object()
      .add("quaternion", json_text::list({number(q.w), number(q.x), number(q.y), number(q.z)}))
      .on_one_line();
}

std::string matrix_step(const Transform& t) {
  std::vector<std::string> rows;
  for (int i = 0; i < 3; ++i)
    rows.push_back(json_text::list({json_text::number(t.x_axis[i]), json_text::number(t.y_axis[i]),
                                    json_text::number(t.z_axis[i]), json_text::number(t.origin[i])}));
  return Object().add("matrix", json_text::list(rows)).on_one_line();
}

std::string turn_step(const TurnMotion& turn) {
  Object rotation;
  rotation.add("axis", json_text::vector(turn.axis));
  rotation.add("degrees",
               keyframes_text(turn.degrees, [](float degrees) { return json_text::number(degrees); }));
  return Object().add("rotate", rotation.on_one_line()).on_one_line();
}

std::string step_text(const MotionStep& step) {
  return std::visit(
      Overloaded{
          [](const Transform& constant) { return matrix_step(constant); },
          [](const ScaleMotion& scale) {
            return Object().add("scale", keyframes_text(scale.factors, vector_text)).on_one_line();
          },
          [](const TurnMotion& turn) { return turn_step(turn); },
          [](const RotationMotion& turn) {
            return Object().add("rotate", keyframes_text(turn.rotations, quaternion_text)).on_one_line();
          },
          [](const TranslationMotion& move) {
            return Object().add("translate", keyframes_text(move.offsets, vector_text)).on_one_line();
          }},
      step);
}

}  // namespace

const Track<float>& number_track(const ParameterTracks& tracks, std::string_view key) {
  static const Track<float> kNone;
  const Track<float>* track = tracks.number(key);
  return track == nullptr ? kNone : *track;
}

const Track<Rgb>& color_track(const ParameterTracks& tracks, std::string_view key) {
  static const Track<Rgb> kNone;
  const Track<Rgb>* track = tracks.color(key);
  return track == nullptr ? kNone : *track;
}

std::string transform_text(const Transform& transform) {
  return json_text::list({matrix_step(transform)});
}

std::string motion_text(const std::vector<MotionStep>& steps) {
  std::vector<std::string> texts;
  for (const MotionStep& step : steps) texts.push_back(step_text(step));
  return json_text::list(texts);
}

}  // namespace tessera::core
