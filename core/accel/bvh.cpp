#include "core/accel/bvh.hpp"

namespace tessera::core {

Bvh Bvh::build(const Primitives&, int) {
  return {};
}

Hit Bvh::closest_hit(const Primitives& primitives, const Ray& ray) const {
  Hit hit;
  for (std::uint32_t i = 0; i < primitives.count(); ++i) primitives.intersect(i, ray, hit);
  return hit;
}

bool Bvh::any_hit(const Primitives& primitives, const Ray& ray) const {
  return closest_hit(primitives, ray).found();
}

}  // namespace tessera::core
