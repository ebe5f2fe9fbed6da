#include "core/geometry/surface.hpp"

#include "core/geometry/rounding.hpp"

namespace tessera::core {
namespace {

float rounded_away(float coordinate, float offset) {
  if (offset > 0) return next_float_up(coordinate);
  if (offset < 0) return next_float_down(coordinate);
  return coordinate;
}

}  // namespace

Vec3 offset_origin(const SurfacePoint& surface, Vec3 direction) {
  const Vec3 normal = face_toward(surface.geometric_normal, direction);
  // The extent along the normal of the box that the true point lies in.
  const Vec3 offset = normal * dot(abs(normal), surface.position_error);
  const Vec3 moved = surface.position + offset;
  return {rounded_away(moved.x, offset.x), rounded_away(moved.y, offset.y), rounded_away(moved.z, offset.z)};
}

}  // namespace tessera::core
