// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pbrt/lens_system.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "core/scene/pbrt/parameters.hpp"
#include "core/scene/pbrt/tokenizer.hpp"

namespace tessera::core::pbrt {
namespace {

constexpr std::size_t kMaxSurfaces = 1000;

// The height and slope of a paraxial ray, as a linear map of those at the first surface.
struct RayMap {
  double y_of_y = 1, y_of_u = 0;
  double u_of_y = 0, u_of_u = 1;

  void travel(double distance) {
    y_of_y += distance * u_of_y;
    y_of_u += distance * u_of_u;
  }
  void refract(double radius, double before, double behind) {
    const double power = radius == 0 ? 0 : (behind - before) / radius, ratio = before / behind;
    u_of_y = ratio * u_of_y - power / behind * y_of_y;
    u_of_u = ratio * u_of_u - power / behind * y_of_u;
  }
};

struct ThickLens {
  RayMap map;          // up to behind the last surface
  double length = 0;   // from the first to the last surface
  double pupil_z = 0;  // the entrance pupil, behind the first surface
  double pupil_radius = std::numeric_limits<double>::infinity();

  double focal_length() const { return -1 / map.u_of_y; }
  // The principal planes: behind the first surface, and behind the last one.
  double front_plane() const { return (map.u_of_u - 1) / map.u_of_y; }
  double rear_plane() const { return (1 - map.y_of_y) / map.u_of_y; }
};

// The stop is the opening that limits a beam from infinity; its image in the scene is the entrance pupil.
ThickLens traced(const LensSystem& lens) {
  ThickLens made;
  double index = 1;
  for (std::size_t i = 0; i < lens.size(); ++i) {
    const LensSurface& surface = lens[i];
    const double radius = surface.diameter / 2 / std::fabs(made.map.y_of_y);
    if (radius < made.pupil_radius) {
      made.pupil_radius = radius;
      made.pupil_z = made.map.y_of_u / made.map.y_of_y;
    }
    const bool is_last = i + 1 == lens.size();
    const double behind = is_last || surface.index == 0 ? 1 : surface.index;
    made.map.refract(surface.radius, index, behind);
    index = behind;
    if (is_last) break;
    made.map.travel(surface.thickness);
    made.length += surface.thickness;
  }
  return made;
}

bool is_sound(const LensSurface& surface) {
  return std::isfinite(surface.radius) && std::isfinite(surface.thickness) && surface.index >= 0 &&
         std::isfinite(surface.index) && surface.diameter > 0 && std::isfinite(surface.diameter);
}

}  // namespace

LensSystem parse_lens(std::string_view text) {
  std::vector<double> numbers;
  Tokenizer tokens(text);
  while (numbers.size() <= 4 * kMaxSurfaces) {
    const auto token = tokens.next();
    if (!token) return {};
    if (token->is(Token::Kind::kEnd)) break;
    const auto number = token->is(Token::Kind::kWord) ? parse_number(token->text) : std::nullopt;
    if (!number) return {};
    numbers.push_back(static_cast<double>(*number));
  }
  if (numbers.size() % 4 != 0 || numbers.size() > 4 * kMaxSurfaces) return {};
  LensSystem lens;
  for (std::size_t i = 0; i < numbers.size(); i += 4) {
    lens.push_back({numbers[i], numbers[i + 1], numbers[i + 2], numbers[i + 3]});
    if (!is_sound(lens.back())) return {};
  }
  return lens;
}

std::optional<FocusedLens> focused(const LensSystem& lens, double distance) {
  const ThickLens thick = traced(lens);
  const double f = thick.focal_length();
  if (!(f > 0 && std::isfinite(f))) return std::nullopt;
  // The image is at `image` behind its principal plane, the object at the rest of `sum` before the other:
  // 1 / image + 1 / (sum - image) = 1 / f.
  const double from_plane = thick.length - thick.front_plane() + thick.rear_plane();
  const double sum = distance - from_plane, root = sum * (sum - 4 * f);
  if (!(sum > 0 && root >= 0)) return std::nullopt;
  const double image = 2 * f * sum / (sum + std::sqrt(root));  // without the difference of large numbers
  FocusedLens made;
  made.focal_length = f;
  made.pupil_radius = thick.pupil_radius;
  made.pupil_distance = image + thick.rear_plane() + thick.length - thick.pupil_z;
  made.focus_distance = distance - made.pupil_distance;
  made.field = (sum - image) / image / made.focus_distance;
  const double slope = made.pupil_radius * made.field;
  made.irradiance = std::numbers::pi * slope * slope;
  const bool is_usable = made.focus_distance > 0 && made.irradiance > 0 && std::isfinite(made.irradiance) &&
                         std::isfinite(made.pupil_distance);
  return is_usable ? std::optional(made) : std::nullopt;
}

}  // namespace tessera::core::pbrt
