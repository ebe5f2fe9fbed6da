// SPDX-License-Identifier: Apache-2.0
#include "scenes/go/stones.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/math/elementary.hpp"
#include "core/math/frame.hpp"
#include "scenes/modelling/noise.hpp"
#include "scenes/modelling/surface.hpp"

namespace tessera::go {
namespace {

using core::Vec2;
using core::Vec3;
using modelling::random_at;

// Half the outline of a stone, from the lower pole (t = 0) to the upper one (t = 1).
struct Outline {
  Vec2 position, normal;  // x is the distance from the axis
};

// The lens inside the rounding has caps of radius rho that meet in a sharp edge; the stone is all that is
// within `rim` of it. Its outline is an arc of each cap, moved out by `rim`, and an arc about the edge.
Outline outline(const StoneShape& shape, float t) {
  const float edge = shape.radius - shape.rim, height = shape.half_thickness - shape.rim;
  const float rho = (edge * edge + height * height) / (2 * height);
  const float cap = core::atan2(edge, rho - height), bend = core::kPi / 2 - cap;
  const float cap_length = cap * (rho + shape.rim), bend_length = bend * shape.rim;
  const float side = t < 0.5f ? -1.0f : 1.0f;
  const float s = std::fabs(1 - 2 * t);  // 0 at the equator, 1 at a pole
  const float from_pole = (1 - s) * (cap_length + bend_length);
  if (from_pole <= cap_length) {
    const float angle = from_pole / (rho + shape.rim);
    const Vec2 normal{core::sin(angle), side * core::cos(angle)};
    return {{(rho + shape.rim) * normal.x, (rho + shape.rim) * normal.y - side * (rho - height)}, normal};
  }
  const float angle = cap + (from_pole - cap_length) / shape.rim;
  const Vec2 normal{core::sin(angle), side * core::cos(angle)};
  return {{edge + shape.rim * normal.x, shape.rim * normal.y}, normal};
}

// Rings stand closest where the outline bends most.
std::vector<float> ring_lines(int rings) {
  std::vector<float> lines = modelling::uniform_lines(rings);
  for (float& t : lines) {
    const float s = 2 * t - 1;
    t = 0.5f + 0.5f * s * (0.45f + 0.55f * std::fabs(s));
  }
  return lines;
}

struct Disc {
  Vec2 center, home;
  float radius;
  bool fixed;
};

void push_apart(Disc& a, Disc& b) {
  const Vec2 between = b.center - a.center;
  const float distance = std::sqrt(between.x * between.x + between.y * between.y);
  const float overlap = a.radius + b.radius - distance;
  if (overlap <= 0 || (a.fixed && b.fixed)) return;
  const Vec2 step = between * (overlap / distance);
  const float share = a.fixed ? 0 : b.fixed ? 1 : 0.5f;
  a.center = a.center - step * share;
  b.center = b.center + step * (1 - share);
}

void settle(std::vector<Disc>& discs) {
  constexpr int kSteps = 300;
  for (int step = 0; step < kSteps; ++step) {
    const float pull = step < kSteps / 2 ? 0.05f : 0;  // in the end, making room is all that counts
    for (Disc& disc : discs) {
      if (!disc.fixed) disc.center = disc.center + (disc.home - disc.center) * pull;
    }
    for (std::size_t i = 0; i < discs.size(); ++i) {
      for (std::size_t j = i + 1; j < discs.size(); ++j) push_apart(discs[i], discs[j]);
    }
  }
}

// The lower and upper height of a stone's hull above the point (x, z) from its centre: that of the ellipsoid
// around it. False where there is none.
struct Span {
  float low, high;
};
bool hull_span(const StoneShape& shape, Vec3 up, float x, float z, Span& span) {
  // |p|^2 / r^2 + (p . up)^2 (1 / h^2 - 1 / r^2) = 1 for p = (x, y, z): a quadratic equation in y.
  const float in_r = 1 / (shape.radius * shape.radius);
  const float in_up = 1 / (shape.half_thickness * shape.half_thickness) - in_r;
  const float flat = x * up.x + z * up.z;
  const float a = in_r + in_up * up.y * up.y, b = in_up * flat * up.y;
  const float c = in_r * (x * x + z * z) + in_up * flat * flat - 1;
  const float discriminant = b * b - a * c;
  if (discriminant < 0) return false;
  const float root = std::sqrt(discriminant);
  span = {(-b - root) / a, (-b + root) / a};
  return true;
}

// The surface of a heap as it grows, over a square grid.
class Surface {
 public:
  explicit Surface(const Heap& heap)
      : shape_(heap.shape),
        cells_(static_cast<int>(2 * heap.inner_radius / kCell) + 1),
        half_width_(0.5f * kCell * static_cast<float>(cells_)),
        heights_(static_cast<std::size_t>(cells_ * cells_)) {
    for (int j = 0; j < cells_; ++j) {
      for (int i = 0; i < cells_; ++i) {
        const float x = coordinate(i), z = coordinate(j);
        height(i, j) = heap.floor(std::sqrt(x * x + z * z));
      }
    }
  }

  // The height at which a stone's centre comes to rest.
  float rest(const Pose& pose) {
    float y = std::numeric_limits<float>::lowest();
    visit(pose, [&](float& surface, const Span& span) { y = std::max(y, surface - span.low); });
    return y;
  }
  void add(const Pose& pose) {
    visit(pose,
          [&](float& surface, const Span& span) { surface = std::max(surface, pose.center.y + span.high); });
  }

 private:
  static constexpr float kCell = 0.06f;

  float coordinate(int i) const { return (static_cast<float>(i) + 0.5f) * kCell - half_width_; }
  int cell(float x) const { return std::clamp(static_cast<int>((x + half_width_) / kCell), 0, cells_ - 1); }
  float& height(int i, int j) { return heights_[static_cast<std::size_t>(j * cells_ + i)]; }

  template <typename Visit>
  void visit(const Pose& pose, const Visit& visit_cell) {
    const float x = pose.center.x, z = pose.center.z, r = shape_.radius;
    Span span{};
    for (int j = cell(z - r); j <= cell(z + r); ++j) {
      for (int i = cell(x - r); i <= cell(x + r); ++i) {
        if (hull_span(shape_, pose.up, coordinate(i) - x, coordinate(j) - z, span))
          visit_cell(height(i, j), span);
      }
    }
  }

  StoneShape shape_;
  int cells_;
  float half_width_;
  std::vector<float> heights_;
};

// Lies flat or leans by up to a quarter of a right angle, anywhere in the vessel.
Pose random_pose(const Heap& heap, int stone, int attempt) {
  const auto random = [&](int what) { return random_at(stone * 64 + attempt, what, heap.seed); };
  const float reach = heap.inner_radius - heap.shape.radius;
  const float distance = reach * std::sqrt(random(0)), around = 2 * core::kPi * random(1);
  const float lean = 0.4f * random(2) * random(2), toward = 2 * core::kPi * random(3);
  const Vec3 up{core::sin(lean) * core::cos(toward), core::cos(lean), core::sin(lean) * core::sin(toward)};
  return {{distance * core::cos(around), 0, distance * core::sin(around)}, up, random(4)};
}

}  // namespace

core::MeshDescription stone_mesh(const StoneShape& shape, const Pose& pose, int segments, int rings) {
  const core::Frame frame = core::Frame::around(pose.up);
  const float turn = 2 * core::kPi * pose.turn;
  const modelling::GridLines lines{modelling::uniform_lines(segments), ring_lines(rings), true};
  const auto to_world = [&](Vec3 local) {
    return frame.to_world({local.x * core::cos(turn) + local.y * core::sin(turn),
                           local.y * core::cos(turn) - local.x * core::sin(turn), local.z});
  };
  const auto around = [&](Vec2 p, float u) {
    const float angle = 2 * core::kPi * u;
    return Vec3{p.x * core::cos(angle), p.x * core::sin(angle), p.y};
  };
  core::MeshDescription mesh = modelling::grid_mesh(
      lines, [&](float u, float v) { return pose.center + to_world(around(outline(shape, v).position, u)); });
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec2 uv = mesh.uvs[i];
    const Outline at = outline(shape, uv.y);
    const Vec3 local = around(at.position, uv.x);
    mesh.normals[i] = to_world(around(at.normal, uv.x));
    mesh.uvs[i] = Vec2{local.x, local.y} * (1.0f / 8) + Vec2{7.3f * pose.turn, 3.1f * pose.turn};
  }
  return mesh;
}

Vec3 intersection(Point p, int board_size) {
  const float middle = 0.5f * static_cast<float>(board_size - 1);
  return {(static_cast<float>(p.column) - middle) * kColumnSpacing, 0,
          (static_cast<float>(p.row) - middle) * kRowSpacing};
}

std::vector<PlacedStone> lay_out(const Board& board, Point precise) {
  constexpr float kCarelessness = 0.16f;
  std::vector<PlacedStone> stones;
  std::vector<Disc> discs;
  for (int row = 0; row < board.size(); ++row) {
    for (int column = 0; column < board.size(); ++column) {
      const Stone color = board.at({column, row});
      if (color == Stone::kNone) continue;
      const auto random = [&](int what) { return random_at(column, row, what); };
      const Vec3 at = intersection({column, row}, board.size());
      const bool exact = Point{column, row} == precise;
      const Vec2 off{random(1) + random(2) - 1, random(3) + random(4) - 1};
      const Vec2 home = Vec2{at.x, at.z} + off * (exact ? 0 : kCarelessness);
      discs.push_back({home, home, shape_of(color).radius, exact});
      stones.push_back({color, {{0, shape_of(color).half_thickness, 0}, {0, 1, 0}, random(5)}});
    }
  }
  settle(discs);
  for (std::size_t i = 0; i < stones.size(); ++i) {
    stones[i].pose.center.x = discs[i].center.x;
    stones[i].pose.center.z = discs[i].center.y;
  }
  return stones;
}

std::vector<Pose> heap_up(const Heap& heap) {
  constexpr int kAttempts = 40;
  Surface surface(heap);
  std::vector<Pose> poses;
  for (int stone = 0; stone < heap.count; ++stone) {
    Pose lowest;
    lowest.center.y = std::numeric_limits<float>::max();
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      Pose pose = random_pose(heap, stone, attempt);
      pose.center.y = surface.rest(pose);
      if (pose.center.y < lowest.center.y) lowest = pose;
    }
    surface.add(lowest);
    poses.push_back(lowest);
  }
  return poses;
}

}  // namespace tessera::go
