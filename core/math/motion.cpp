// SPDX-License-Identifier: Apache-2.0
#include "core/math/motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/base/overloaded.hpp"
#include "core/math/elementary.hpp"

namespace tessera::core {
namespace {

Transform step_at(const MotionStep& step, float frame) {
  return std::visit(Overloaded{[](const Transform& constant) { return constant; },
                               [frame](const ScaleMotion& scale) {
                                 return scaling(value_at(scale.factors, frame, Vec3{1, 1, 1}));
                               },
                               [frame](const TurnMotion& turn) {
                                 return rotation(turn.axis, value_at(turn.degrees, frame, 0.0f));
                               },
                               [frame](const RotationMotion& turn) {
                                 return rotation(value_at(turn.rotations, frame, Quaternion{}));
                               },
                               [frame](const TranslationMotion& move) {
                                 return translation(value_at(move.offsets, frame, Vec3{}));
                               }},
                    step);
}

double squared(Vec3 v) {
  const double x = double{v.x}, y = double{v.y}, z = double{v.z};
  return x * x + y * y + z * z;
}

double largest_component(Vec3 v) {
  return double{std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)})};
}

// The angle between two rotations.
double angle_between(Quaternion a, Quaternion b) {
  const auto distance = [&](float sign) {
    const Quaternion d{a.w - sign * b.w, a.x - sign * b.x, a.y - sign * b.y, a.z - sign * b.z};
    return std::sqrt(d.w * d.w + d.x * d.x + d.y * d.y + d.z * d.z);
  };
  const float same = distance(1), opposite = distance(-1);
  return 4 * double{atan2(std::min(same, opposite), std::max(same, opposite))};
}

// What a track is bounded by: the greatest size of its values and of their change per frame.
struct TrackBounds {
  double size = 0, rate = 0;
};
// `size_of` measures a value, `between` the change between two.
template <typename T, typename SizeOf, typename Between>
TrackBounds bounds_of_track(const Track<T>& track, FrameInterval interval, const SizeOf& size_of,
                            const Between& between) {
  TrackBounds bounds;
  bounds.size =
      std::max(size_of(value_at(track, interval.begin, T{})), size_of(value_at(track, interval.end, T{})));
  for (std::size_t i = 1; i < track.frames.size(); ++i) {
    const float begin = track.frames[i - 1], end = track.frames[i];
    if (end <= interval.begin || begin >= interval.end) continue;
    const T a = track.values[i - 1], b = track.values[i];
    bounds.size = std::max({bounds.size, size_of(a), size_of(b)});
    bounds.rate = std::max(bounds.rate, between(a, b) / (double{end} - double{begin}));
  }
  return bounds;
}

// Of a rotation by a constant angular speed: in radians per frame.
PointMotion turned(PointMotion p, double rate) {
  return {p.radius, p.speed + rate * p.radius, p.acceleration + 2 * rate * p.speed + rate * rate * p.radius};
}

PointMotion after_step(const Transform& map, const PointMotion& p, FrameInterval) {
  const double norm = std::sqrt(squared(map.x_axis) + squared(map.y_axis) + squared(map.z_axis));
  return {norm * p.radius + std::sqrt(squared(map.origin)), norm * p.speed, norm * p.acceleration};
}

PointMotion after_step(const ScaleMotion& scale, const PointMotion& p, FrameInterval interval) {
  const auto [size, rate] = bounds_of_track(scale.factors, interval, largest_component,
                                            [](Vec3 a, Vec3 b) { return largest_component(b - a); });
  return {size * p.radius, size * p.speed + rate * p.radius, size * p.acceleration + 2 * rate * p.speed};
}

PointMotion after_step(const TurnMotion& turn, const PointMotion& p, FrameInterval interval) {
  const auto in_radians = [](float a, float b) {
    return std::fabs(double{b} - double{a}) * (double{kPi} / 180);
  };
  return turned(p, bounds_of_track(
                       turn.degrees, interval, [](float) { return 0.0; }, in_radians)
                       .rate);
}

PointMotion after_step(const RotationMotion& turn, const PointMotion& p, FrameInterval interval) {
  return turned(p, bounds_of_track(
                       turn.rotations, interval, [](Quaternion) { return 0.0; }, angle_between)
                       .rate);
}

PointMotion after_step(const TranslationMotion& move, const PointMotion& p, FrameInterval interval) {
  const auto length_of = [](Vec3 v) { return std::sqrt(squared(v)); };
  const auto [size, rate] =
      bounds_of_track(move.offsets, interval, length_of, [&](Vec3 a, Vec3 b) { return length_of(b - a); });
  return {p.radius + size, p.speed + rate, p.acceleration};
}

}  // namespace

Transform transform_at(const std::vector<MotionStep>& steps, float frame) {
  if (steps.empty()) return {};
  Transform all = step_at(steps.front(), frame);
  for (std::size_t i = 1; i < steps.size(); ++i) all = compose(step_at(steps[i], frame), all);
  return all;
}

std::set<float> keyframes_of(const std::vector<MotionStep>& steps) {
  std::set<float> frames;
  const auto add = [&frames](const auto& track) { frames.insert(track.frames.begin(), track.frames.end()); };
  for (const MotionStep& step : steps)
    std::visit(Overloaded{[](const Transform&) {}, [&](const ScaleMotion& s) { add(s.factors); },
                          [&](const TurnMotion& s) { add(s.degrees); },
                          [&](const RotationMotion& s) { add(s.rotations); },
                          [&](const TranslationMotion& s) { add(s.offsets); }},
               step);
  return frames;
}

PointMotion bounds_of_motion(const std::vector<MotionStep>& steps, double radius, FrameInterval interval) {
  PointMotion point{radius, 0, 0};
  for (const MotionStep& step : steps)
    point = std::visit([&](const auto& s) { return after_step(s, point, interval); }, step);
  return point;
}

}  // namespace tessera::core
