// SPDX-License-Identifier: Apache-2.0
#include "bench/soups.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/elementary.hpp"
#include "core/math/frame.hpp"
#include "core/sampling/sampler.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core {
namespace {

// Appends a sphere divided by `rows` parallels and twice as many meridians; `place` maps a unit vector to a
// corner.
template <typename Place>
void add_globe(Soup& soup, int rows, Place place) {
  const int columns = 2 * rows;
  const auto first = static_cast<std::uint32_t>(soup.positions.size());
  for (int i = 0; i <= rows; ++i)
    for (int j = 0; j <= columns; ++j) {
      const float theta = kPi * static_cast<float>(i) / static_cast<float>(rows);
      const float phi = 2 * kPi * static_cast<float>(j % columns) / static_cast<float>(columns);
      soup.positions.push_back(place(Vec3{sin(theta) * cos(phi), cos(theta), sin(theta) * sin(phi)}));
    }
  const auto vertex = [&](int i, int j) { return first + static_cast<std::uint32_t>(i * (columns + 1) + j); };
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      if (i > 0) soup.triangles.push_back({vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1)});
      if (i + 1 < rows) soup.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i + 1, j)});
    }
}

void add_quad(Soup& soup, Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const auto first = static_cast<std::uint32_t>(soup.positions.size());
  soup.positions.insert(soup.positions.end(), {a, b, c, d});
  soup.triangles.push_back({first, first + 1, first + 2});
  soup.triangles.push_back({first, first + 2, first + 3});
}

void add_ground(Soup& soup, float half_width) {
  const float w = half_width;
  add_quad(soup, {-w, 0, -w}, {-w, 0, w}, {w, 0, w}, {w, 0, -w});
}

// A board: a box on the ground whose top is at `height`.
void add_board(Soup& soup, float half_width, float height) {
  const float w = half_width, h = height;
  add_quad(soup, {-w, h, -w}, {-w, h, w}, {w, h, w}, {w, h, -w});
  add_quad(soup, {-w, 0, w}, {w, 0, w}, {w, h, w}, {-w, h, w});
  add_quad(soup, {w, 0, -w}, {-w, 0, -w}, {-w, h, -w}, {w, h, -w});
  add_quad(soup, {w, 0, w}, {w, 0, -w}, {w, h, -w}, {w, h, w});
  add_quad(soup, {-w, 0, -w}, {-w, 0, w}, {-w, h, w}, {-w, h, -w});
}

void add_blob(Soup& soup, int rows, Vec3 center, float size, float turn) {
  add_globe(soup, rows, [&](Vec3 w) {
    const float bumps = sin(9 * w.y) * sin(7 * w.x + turn) + sin(11 * w.z + turn) * sin(5 * w.x);
    const float folds = sin(31 * w.x) * sin(29 * w.y) * sin(37 * w.z);
    return center + w * (size * (1 + 0.06f * bumps + 0.02f * folds));
  });
}

constexpr int kStrands = 15'000, kStrandSegments = 10;
constexpr float kStrandHalfWidth = 0.003f;
constexpr Vec3 kStrandsCenter{0, 1.5f, 0};

// The joints of a strand that starts on a ball of radius 1 and bends randomly and downwards, but not below y
// = 0, and a vector across it of its half width.
struct Strand {
  std::vector<Vec3> joints;
  Vec3 side;
};

Strand strand(int number) {
  constexpr float kStep = 0.12f, kCurl = 0.22f, kWeight = 0.12f;
  const auto u = sampling::Sampler(2, number, 0, 0).pad(0);
  Vec3 direction = sampling::sample_sphere({u[0], u[1]});
  const float turn = 2 * kPi * u[2];
  Strand made{{}, Frame::around(direction).to_world({cos(turn), sin(turn), 0}) * kStrandHalfWidth};
  Vec3 joint = kStrandsCenter + direction;
  for (int i = 0; i <= kStrandSegments; ++i) {
    made.joints.push_back(joint);
    const auto v = sampling::Sampler(2, number, 1 + i, 0).pad(0);
    direction = normalize(direction + sampling::sample_sphere({v[0], v[1]}) * kCurl - Vec3{0, kWeight, 0});
    joint = joint + direction * kStep;
    joint.y = std::max(joint.y, 0.01f);
  }
  return made;
}

// A ribbon of triangles.
void add_strand(Soup& soup, int number) {
  const auto first = static_cast<std::uint32_t>(soup.positions.size());
  const auto [joints, side] = strand(number);
  for (const Vec3 joint : joints) soup.positions.insert(soup.positions.end(), {joint - side, joint + side});
  for (std::uint32_t i = first; i < first + 2 * kStrandSegments; i += 2) {
    soup.triangles.push_back({i, i + 1, i + 3});
    soup.triangles.push_back({i, i + 3, i + 2});
  }
}

struct Camera {
  explicit Camera(const Soup& soup)
      : forward(normalize(soup.look_at - soup.eye)),
        right(normalize(cross(forward, {0, 1, 0}))),
        up(cross(right, forward)) {}

  // x and y in (-1, 1), over a field of view of 50 degrees.
  Vec3 direction(float x, float y) const {
    constexpr float kTangent = 0.466f;
    return normalize(forward + right * (x * kTangent) + up * (y * kTangent));
  }

  Vec3 forward, right, up;
};

void add_rays_from_hit(const Soup& soup, const SurfacePoint& point, Vec3 wo, const sampling::Sampler& sampler,
                       RaySets& rays) {
  const auto u = sampler.pad(0);
  const Vec3 normal = face_toward(point.geometric_normal, wo);
  const Vec3 wi = Frame::around(normal).to_world(sampling::sample_cosine_hemisphere({u[0], u[1]}));
  rays.bounce.push_back({offset_origin(point, wi), wi});
  const Vec3 on_lamp = soup.lamp.center + sampling::sample_sphere({u[2], u[3]}) * soup.lamp.radius;
  const Vec3 origin = offset_origin(point, on_lamp - point.position);
  rays.shadow.push_back({origin, on_lamp - origin, 1});
}

}  // namespace

Primitives Soup::primitives() const {
  Primitives primitives;
  primitives.add_mesh(positions, {}, {}, triangles, {0});
  return primitives;
}

Soup blob_on_plane(int rows) {
  Soup soup;
  add_blob(soup, rows, {0, 1, 0}, 1, 0);
  add_ground(soup, 5);
  soup.eye = {0.8f, 1.9f, 3.4f};
  soup.look_at = {0, 0.9f, 0};
  soup.lamp = {{2, 5, 2}, 0.5f};
  return soup;
}

Soup blobs(int side, int rows) {
  Soup soup;
  const float half = 1.2f * static_cast<float>(side);
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      const auto u = sampling::Sampler(1, i, j, 0).pad(0);
      const float size = 0.8f + 0.4f * u[0];
      const float x = 2.4f * (static_cast<float>(i) + 0.5f) - half + 0.3f * u[1];
      const float z = 2.4f * (static_cast<float>(j) + 0.5f) - half + 0.3f * u[2];
      add_blob(soup, rows, {x, size, z}, size, 6 * u[3]);
    }
  return soup;
}

Soup blob_field(int side, int rows) {
  Soup soup = blobs(side, rows);
  const float half = 1.2f * static_cast<float>(side);
  add_ground(soup, 2 * half);
  soup.eye = {0.3f * half, 0.9f * half, 1.7f * half};
  soup.look_at = {0, 0.1f * half, 0};
  soup.lamp = {{half, 2 * half, half}, 0.15f * half};
  return soup;
}

Soup go_board() {
  Soup soup;
  constexpr float kTop = 3, kStoneHeight = 0.2f, kStoneRadius = 0.48f;
  for (int point = 0; point < 361; ++point) {
    if (point % 2 == 1 && point % 360 != 1) continue;
    const float x = static_cast<float>(point % 19) - 9, z = static_cast<float>(point / 19) - 9;
    add_globe(soup, 14, [&](Vec3 w) {
      return Vec3{x + kStoneRadius * w.x, kTop + kStoneHeight * (1 + w.y), z + kStoneRadius * w.z};
    });
  }
  add_board(soup, 10, kTop);
  add_ground(soup, 60);
  soup.eye = {3, 14, 20};
  soup.look_at = {0, 2, 1};
  soup.lamp = {{-12, 25, 5}, 3};
  return soup;
}

Soup strands() {
  Soup soup;
  for (int number = 0; number < kStrands; ++number) add_strand(soup, number);
  return soup;
}

// Splines that begin and end in the first and the last joint.
CurveStrands strand_curves() {
  CurveStrands curves{CurveBasis::kBSpline, CurveShape::kRound, {}, {kStrandHalfWidth}, {}, {}};
  for (int number = 0; number < kStrands; ++number) {
    const std::vector<Vec3> joints = strand(number).joints;
    const std::size_t last = joints.size() - 1;
    curves.points.push_back(2 * joints[0] - joints[1]);
    curves.points.insert(curves.points.end(), joints.begin(), joints.end());
    curves.points.push_back(2 * joints[last] - joints[last - 1]);
    curves.counts.push_back(static_cast<std::uint32_t>(joints.size()) + 2);
  }
  return curves;
}

Soup strands_on_plane() {
  Soup soup = strands();
  add_ground(soup, 20);
  soup.eye = {0, 3, 7};
  soup.look_at = {0, 1.4f, 0};
  soup.lamp = {{-2, 6.5f, 2}, 0.6f};
  return soup;
}

RaySets make_rays(const Soup& soup, const Primitives& primitives, const accel::Bvh& bvh, int side) {
  constexpr int kBlock = 8;
  const Camera camera(soup);
  const int blocks = side / kBlock;
  RaySets rays;
  for (int i = 0; i < side * side; ++i) {
    const int block = i / (kBlock * kBlock), within = i % (kBlock * kBlock);
    const int x = block % blocks * kBlock + within % kBlock, y = block / blocks * kBlock + within / kBlock;
    const float scale = 2 / static_cast<float>(side);
    const Ray ray{soup.eye, camera.direction(scale * (static_cast<float>(x) + 0.5f) - 1,
                                             1 - scale * (static_cast<float>(y) + 0.5f))};
    rays.primary.push_back(ray);
    const Hit hit = bvh.closest_hit(primitives, ray);
    if (!hit.found()) continue;
    add_rays_from_hit(soup, primitives.surface(ray, hit), -ray.direction, sampling::Sampler(0, x, y, 0),
                      rays);
  }
  return rays;
}

}  // namespace tessera::core
