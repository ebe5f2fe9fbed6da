// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/core_geometry/shapes.hpp"

#include <bit>
#include <cmath>
#include <functional>
#include <map>
#include <sstream>
#include <utility>

namespace tessera::core::test {
namespace {

TriangleCorners triangle_around(Random& random, Vec3 center, float half_size) {
  return {center + random.in_box(half_size), center + random.in_box(half_size),
          center + random.in_box(half_size)};
}

Primitives triangles(std::uint32_t count, const std::function<TriangleCorners(std::uint32_t)>& make) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) mesh.add(make(i));
  return mesh.primitives();
}

Primitives uniform(Random& random, std::uint32_t count, float half_size, float triangle_size) {
  return triangles(count,
                   [&](auto) { return triangle_around(random, random.in_box(half_size), triangle_size); });
}

Primitives needles(Random& random, std::uint32_t count) {
  return triangles(count, [&](auto) {
    const Vec3 a = random.in_box(1), b = random.in_box(1);
    return TriangleCorners{a, b, a + random.in_box(1e-5f)};
  });
}

// Coordinates are small integers: shared corners, coplanar overlaps, boxes without thickness, many equal
// distances.
Primitives lattice(Random& random, std::uint32_t count) {
  const auto corner = [&] {
    const auto coordinate = [&] { return static_cast<float>(random.below(5)) - 2; };
    return Vec3{coordinate(), coordinate(), coordinate()};
  };
  return triangles(count, [&](auto) { return TriangleCorners{corner(), corner(), corner()}; });
}

Primitives identical_triangles(std::uint32_t count) {
  return triangles(count, [](auto) {
    return TriangleCorners{Vec3{-1, -1, 0}, Vec3{1, -1, 0}, Vec3{0, 1, 0.5f}};
  });
}

Primitives exponentially_spaced(Random& random, std::uint32_t count) {
  return triangles(count, [&](std::uint32_t i) {
    const float scale = std::ldexp(1.0f, -static_cast<int>(i % 120));
    return triangle_around(random, Vec3{scale, scale, scale}, 0.2f * scale);
  });
}

Primitives with_degenerates(Random& random, std::uint32_t count) {
  return triangles(count, [&](std::uint32_t i) {
    const Vec3 a = random.in_box(1), b = random.in_box(1);
    switch (i % 4) {
      case 0:
        return TriangleCorners{a, a, a};
      case 1:
        return TriangleCorners{a, b, a};
      case 2:
        return TriangleCorners{a, b, 0.5f * (a + b)};
      default:
        return triangle_around(random, a, 0.2f);
    }
  });
}

Primitives mixed(Random& random, std::uint32_t count) {
  Primitives primitives = uniform(random, count / 2, 1, 0.2f);
  for (std::uint32_t i = 0; i < count - count / 2; ++i) {
    primitives.add_sphere(random.in_box(1), random.uniform(0.01f, 0.2f), 0);
  }
  return primitives;
}

// Disks, rings, ellipses and cylinders, also oblique, of any size down to needles and leaves.
void add_quadrics(Primitives& primitives, Random& random, std::uint32_t count, float half_size) {
  const auto size = [&] { return half_size * std::ldexp(0.3f, -static_cast<int>(random.below(6))); };
  for (std::uint32_t i = 0; i < count; ++i) {
    const float inner = random.below(2) == 0 ? 0 : random.uniform(0, 1);
    primitives.add_disk(
        {random.in_box(half_size), random.in_box(size()), random.in_box(size()), inner, random.below(2) == 0},
        0);
  }
  for (std::uint32_t i = 0; i < count;) {
    const Vec3 axis = random.in_box(size()), u = random.in_box(size()), v = random.in_box(size());
    if (!Cylinder::can_be_hit(random.in_box(half_size), axis, u, v)) continue;
    primitives.add_cylinder({random.in_box(half_size), axis, u, v, random.below(2) == 0}, 0);
    ++i;
  }
}

// Also in instances.
Primitives quadrics(Random& random, std::uint32_t count) {
  Primitives primitives = mixed(random, count / 4 + 1);
  add_quadrics(primitives, random, count / 4 + 1, 1);
  Primitives object = uniform(random, 3, 0.5f, 0.5f);
  add_quadrics(object, random, count / 16 + 1, 0.5f);
  primitives.add_object(std::move(object));
  for (std::uint32_t i = 0; i < 5; ++i) primitives.add_instance({Placement(random_transform(random, 1)), 0});
  return primitives;
}

// Curves of all bases and shapes, thin and thick, straight and bent.
void add_random_curves(Primitives& primitives, Random& random, std::uint32_t count, float half_size) {
  constexpr CurveBasis kBases[] = {CurveBasis::kLinear, CurveBasis::kBezier, CurveBasis::kBSpline,
                                   CurveBasis::kCatmullRom};
  for (std::uint32_t i = 0; i < count; ++i) {
    CurveStrands strands{
        kBases[random.below(4)], i % 2 == 0 ? CurveShape::kRound : CurveShape::kFlat, {}, {}, {7}, {}};
    const float size = half_size * std::ldexp(0.3f, -static_cast<int>(random.below(4)));
    Vec3 at = random.in_box(half_size);
    for (int k = 0; k < 7; ++k) {
      strands.points.push_back(at);
      strands.radii.push_back(size * std::ldexp(0.5f, -static_cast<int>(random.below(8))));
      at = at + random.in_box(size);
    }
    primitives.add_curves(strands, 0);
  }
}

// Also in instances.
Primitives curves(Random& random, std::uint32_t count) {
  Primitives primitives = mixed(random, count / 8 + 1);
  add_random_curves(primitives, random, count / 32 + 1, 1);
  Primitives object = uniform(random, 3, 0.5f, 0.5f);
  add_random_curves(object, random, count / 64 + 1, 0.5f);
  primitives.add_object(std::move(object));
  for (std::uint32_t i = 0; i < 5; ++i) primitives.add_instance({Placement(random_transform(random, 1)), 0});
  return primitives;
}

// A few of the scene's own, among instances of two objects, each third of which stands where the one before
// it does.
Primitives instances(Random& random, std::uint32_t count) {
  Primitives primitives = mixed(random, count / 4 + 1);
  primitives.add_object(mixed(random, count / 8 + 1));
  primitives.add_object(uniform(random, 3, 0.5f, 0.5f));
  Transform transform;
  for (std::uint32_t i = 0; i < 9; ++i) {
    if (i % 3 != 2) transform = random_transform(random, 1);
    primitives.add_instance({Placement(transform), i / 3 % 2});
  }
  return primitives;
}

Vec3 axis_aligned(Random& random) {
  Vec3 direction{random.below(2) == 0 ? 0.0f : -0.0f, 0, -0.0f};
  direction[static_cast<int>(random.below(3))] = random.below(2) == 0 ? 1.0f : -1.0f;
  if (random.below(3) == 0) direction[static_cast<int>(random.below(3))] = random.uniform(-1, 1);
  return direction;
}

}  // namespace

float Random::uniform(float low, float high) {
  return low + (high - low) * (static_cast<float>(generator_() >> 8) * 0x1p-24f);
}

Vec3 Random::in_box(float half_size) {
  const float x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(-1, 1);
  return half_size * Vec3{x, y, z};
}

Vec3 Random::direction() {
  for (;;) {
    const Vec3 v = in_box(1);
    if (length_squared(v) <= 1 && length_squared(v) > 1e-4f) return normalize(v);
  }
}

Vec3 Random::weights() {
  const float a = uniform(0, 1), b = uniform(0, 1);
  switch (below(4)) {
    case 0:
      return {1, 0, 0};
    case 1:
      return {a, 1 - a, 0};
    default:
      return {1 - std::sqrt(a), std::sqrt(a) * (1 - b), std::sqrt(a) * b};
  }
}

void Mesh::add(const TriangleCorners& corners) {
  const auto first = static_cast<std::uint32_t>(positions.size());
  positions.insert(positions.end(), corners.begin(), corners.end());
  triangles.push_back({first, first + 1, first + 2});
}

Primitives Mesh::primitives() const {
  Primitives result;
  result.add_mesh(positions, {}, {}, triangles, {0});
  return result;
}

Mesh icosphere(int subdivisions, Vec3 center, float radius) {
  const float g = (1 + std::sqrt(5.0f)) / 2;
  Mesh mesh;
  mesh.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int i = 0; i < subdivisions; ++i) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, is_new] = middles.try_emplace(std::minmax(a, b), mesh.positions.size());
      if (is_new) mesh.positions.push_back(normalize(mesh.positions[a]) + normalize(mesh.positions[b]));
      return at->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = finer;
  }
  for (Vec3& p : mesh.positions) p = center + radius * normalize(p);
  return mesh;
}

std::vector<Soup> all_soups(std::uint32_t count) {
  Random random(count);
  std::vector<Soup> soups;
  soups.push_back({"uniform", uniform(random, count, 1, 0.1f), 1.5f});
  soups.push_back({"overlapping", uniform(random, count, 1, 1), 1.5f});
  soups.push_back({"scattered", uniform(random, count, 1000, 0.5f), 1000});
  soups.push_back({"needles", needles(random, count), 1.5f});
  soups.push_back({"lattice", lattice(random, count), 3});
  soups.push_back({"identical", identical_triangles(count), 2});
  soups.push_back({"exponential", exponentially_spaced(random, count), 1});
  soups.push_back({"degenerate", with_degenerates(random, count), 1.5f});
  soups.push_back({"mixed", mixed(random, count), 1.5f});
  soups.push_back({"instances", instances(random, count), 1.5f});
  soups.push_back({"tiny", uniform(random, count, 1e-18f, 2e-19f), 1.5e-18f});
  soups.push_back({"quadrics", quadrics(random, count), 1.5f});
  soups.push_back({"curves", curves(random, count), 1.5f});
  soups.push_back(
      {"largest", uniform(random, count, 0.8f * kMaxCoordinate, 0.2f * kMaxCoordinate), kMaxCoordinate});
  soups.push_back({"huge", uniform(random, count, 1e30f, 3e29f), 1.5e30f});
  return soups;
}

Transform random_transform(Random& random, float distance) {
  const auto factor = [&] { return random.uniform(0.3f, 1.5f) * (random.below(2) == 0 ? 1.0f : -1.0f); };
  const float x = factor(), y = factor(), z = factor();
  const Transform turned = compose(rotation(random.direction(), random.uniform(-180, 180)),
                                   compose(scaling({x, y, z}), rotation(random.direction(), 50)));
  return compose(translation(random.in_box(distance)), turned);
}

Vec3 point_of(const Primitives& primitives, Random& random) {
  const std::uint32_t id = random.below(primitives.count());
  if (primitives.is_instance(id)) {
    const Instance& instance = primitives.instance(primitives.instance_number(id));
    return instance.placement.point(Vec3d(point_of(primitives.object_of(instance), random))).rounded();
  }
  if (primitives.is_sphere(id)) {
    return primitives.sphere(id).center + primitives.sphere(id).radius * random.direction();
  }
  if (primitives.is_disk(id)) {
    const Disk& disk = primitives.disk(id);
    const RingPoint p = sample_ring(disk.inner, {random.uniform(0, 1), random.uniform(0, 1)});
    return disk.center + p.x * disk.radius_u + p.y * disk.radius_v;
  }
  if (primitives.is_cylinder(id))
    return primitives.cylinder(id).position({random.uniform(0, 1), random.uniform(0, 1)}).rounded();
  if (primitives.is_curve(id)) {
    const CurvePart part = primitives.curve(id);
    const Vec3 w = random.weights();
    const Vec3d on = static_cast<double>(w.x) * part.points[0] + static_cast<double>(w.y) * part.points[1] +
                     static_cast<double>(w.z) * part.points[3];
    return on.rounded() + static_cast<float>(part.max_radius()) * random.in_box(1);
  }
  const TriangleCorners corners = primitives.triangle_corners(id);
  const Vec3 w = random.weights();
  return w.x * corners[0] + w.y * corners[1] + w.z * corners[2];
}

Ray random_ray(const Soup& soup, Random& random) {
  const Vec3 origin =
      random.below(3) == 0 ? point_of(soup.primitives, random) : random.in_box(soup.half_size);
  Ray ray{origin, random.direction()};
  switch (random.below(4)) {
    case 0:
      ray.direction = axis_aligned(random);
      break;
    case 1: {  // at something, not of unit length
      const Vec3 toward = point_of(soup.primitives, random) - origin;
      if (length(toward) > 0 && std::isfinite(length(toward))) ray.direction = toward;
      break;
    }
    default:
      break;
  }
  if (random.below(4) == 0) ray.t_max = random.uniform(0, 2) * soup.half_size / length(ray.direction);
  return ray;
}

Hit brute_force_hit(const Primitives& primitives, const Ray& ray) {
  Hit hit;
  for (std::uint32_t i = 0; i < primitives.count(); ++i) primitives.intersect(i, ray, hit);
  return hit;
}

bool identical(const Hit& a, const Hit& b) {
  const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
  return a.instance == b.instance && a.primitive == b.primitive && bits(a.t) == bits(b.t) &&
         bits(a.b1) == bits(b.b1) && bits(a.b2) == bits(b.b2);
}

std::string describe(const Ray& ray, const Hit& hit) {
  std::ostringstream text;
  text << std::hexfloat << "ray from (" << ray.origin.x << ", " << ray.origin.y << ", " << ray.origin.z
       << ") along (" << ray.direction.x << ", " << ray.direction.y << ", " << ray.direction.z << ") to "
       << ray.t_max << ": primitive " << static_cast<std::int64_t>(hit.found() ? hit.primitive : -1)
       << " of instance " << static_cast<std::int64_t>(hit.in_instance() ? hit.instance : -1)
       << " at t = " << hit.t;
  return text.str();
}

}  // namespace tessera::core::test
