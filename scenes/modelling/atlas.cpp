// SPDX-License-Identifier: Apache-2.0
#include "scenes/modelling/atlas.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <utility>
#include <vector>

namespace tessera::modelling {
namespace {

using core::MeshDescription;
using core::Vec2;
using core::Vec3;

constexpr float kGutterPx = 4;  // between pieces

// 2 * axis, one more if the direction is against the axis.
int main_direction(Vec3 n) {
  const Vec3 size = abs(n);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  return 2 * axis + (n[axis] < 0 ? 1 : 0);
}

// Seen from outside, so that no piece is mirrored.
Vec2 flatten(Vec3 p, int direction) {
  const int axis = direction / 2;
  const float right = p[(axis + 1) % 3], up = p[(axis + 2) % 3];
  return direction % 2 == 0 ? Vec2{right, up} : Vec2{-right, up};
}

struct Piece {
  int direction = 0;  // of main_direction
  std::vector<std::size_t> triangles;
  Vec2 low{std::numeric_limits<float>::max(), std::numeric_limits<float>::max()};
  Vec2 high{std::numeric_limits<float>::lowest(), std::numeric_limits<float>::lowest()};
  Vec2 place;  // of `low`, in pixels of the texture

  Vec2 extent() const { return high - low; }
};

void add_triangle(Piece& piece, const MeshDescription& mesh, std::size_t triangle) {
  piece.triangles.push_back(triangle);
  for (const std::uint32_t v : mesh.triangles[triangle]) {
    const Vec2 p = flatten(mesh.positions[v], piece.direction);
    piece.low = {std::min(piece.low.x, p.x), std::min(piece.low.y, p.y)};
    piece.high = {std::max(piece.high.x, p.x), std::max(piece.high.y, p.y)};
  }
}

// How deep a piece lies where, in squares: tells where it would cover itself, as a tail that hangs before the
// rump it grows from.
class Depths {
 public:
  Depths(const MeshDescription& mesh, int direction, float square)
      : mesh_(mesh), direction_(direction), square_(square) {}

  // Notes where the triangle is, unless another part of the piece lies before or behind it.
  bool add(const std::array<std::uint32_t, 3>& triangle) {
    // A plane that is turned away from the axis by at most 54.7 degrees rises by two squares between corners
    // of one.
    const float most = 2.5f * square_;
    const auto [a, b, c] = triangle;
    const Vec3 pa = mesh_.positions[a], pb = mesh_.positions[b], pc = mesh_.positions[c];
    for (const Vec3 p : {pa, pb, pc, (pa + pb) / 2, (pb + pc) / 2, (pc + pa) / 2, (pa + pb + pc) / 3}) {
      const float depth = p[direction_ / 2];
      if (std::fabs(depths_.try_emplace(square_of(p), depth).first->second - depth) > most) return false;
    }
    return true;
  }

 private:
  std::pair<int, int> square_of(Vec3 p) const {
    const Vec2 flat = flatten(p, direction_) * (1 / square_);
    return {static_cast<int>(std::floor(flat.x)), static_cast<int>(std::floor(flat.y))};
  }

  const MeshDescription& mesh_;
  int direction_;
  float square_;
  std::map<std::pair<int, int>, float> depths_;
};

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

// The three triangles beside each one, in the order of its edges; kNone where it has no neighbour.
std::vector<std::array<std::size_t, 3>> neighbors_of_triangles(const MeshDescription& mesh) {
  std::vector<std::array<std::size_t, 3>> neighbors(mesh.triangles.size(), {kNone, kNone, kNone});
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<std::size_t, std::size_t>> open;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = mesh.triangles[t][i], b = mesh.triangles[t][(i + 1) % 3];
      if (const auto other = open.find({b, a}); other != open.end()) {
        const auto [other_triangle, other_edge] = other->second;
        neighbors[t][i] = other_triangle;
        neighbors[other_triangle][other_edge] = t;
      } else {
        open[{a, b}] = {t, i};
      }
    }
  }
  return neighbors;
}

float mean_edge_length(const MeshDescription& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles) sum += length(mesh.positions[b] - mesh.positions[a]);
  return static_cast<float>(sum / static_cast<double>(mesh.triangles.size()));
}

class Cutter {
 public:
  explicit Cutter(const MeshDescription& mesh)
      : mesh_(mesh),
        square_(mean_edge_length(mesh)),
        neighbors_(neighbors_of_triangles(mesh)),
        taken_(mesh.triangles.size()) {
    for (const auto& [a, b, c] : mesh.triangles) {
      directions_.push_back(main_direction(mesh.normals[a] + mesh.normals[b] + mesh.normals[c]));
    }
  }

  // Triangles that hang together by edges, look along the same axis, and do not cover each other.
  std::vector<Piece> pieces() {
    std::vector<Piece> pieces;
    for (std::size_t t = 0; t < taken_.size(); ++t) {
      if (!taken_[t]) pieces.push_back(grow_from(t));
    }
    return pieces;
  }

 private:
  Piece grow_from(std::size_t seed) {
    Piece piece;
    piece.direction = directions_[seed];
    Depths depths(mesh_, piece.direction, square_);
    std::deque<std::size_t> reached{seed};
    while (!reached.empty()) {
      const std::size_t t = reached.front();
      reached.pop_front();
      if (taken_[t] || !depths.add(mesh_.triangles[t])) continue;
      taken_[t] = true;
      add_triangle(piece, mesh_, t);
      for (const std::size_t next : neighbors_[t]) {
        if (next != kNone && directions_[next] == piece.direction) reached.push_back(next);
      }
    }
    return piece;
  }

  const MeshDescription& mesh_;
  float square_;
  std::vector<std::array<std::size_t, 3>> neighbors_;
  std::vector<bool> taken_;
  std::vector<int> directions_;
};

// Places the pieces, highest first, from left to right in rows; false if they do not fit.
bool place_in_rows(std::vector<Piece>& pieces, float px_per_unit, float texture_px) {
  float x = kGutterPx, y = kGutterPx, row_height = 0;
  for (Piece& piece : pieces) {
    const Vec2 size = piece.extent() * px_per_unit;
    if (x + size.x + kGutterPx > texture_px) {
      x = kGutterPx;
      y += row_height + kGutterPx;
      row_height = 0;
    }
    if (x + size.x + kGutterPx > texture_px || y + size.y + kGutterPx > texture_px) return false;
    piece.place = {x, y};
    x += size.x + kGutterPx;
    row_height = std::max(row_height, size.y);
  }
  return true;
}

// The largest scale, in steps of a fiftieth, at which all pieces fit.
float pack(std::vector<Piece>& pieces, float texture_px) {
  std::stable_sort(pieces.begin(), pieces.end(),
                   [](const Piece& a, const Piece& b) { return a.extent().y > b.extent().y; });
  float largest = 0;
  for (const Piece& piece : pieces) largest = std::max({largest, piece.extent().x, piece.extent().y});
  float px_per_unit = texture_px / largest;
  while (!place_in_rows(pieces, px_per_unit, texture_px)) px_per_unit *= 0.98f;
  return px_per_unit;
}

}  // namespace

MeshDescription unwrap(const MeshDescription& mesh, int texture_px) {
  std::vector<Piece> pieces = Cutter(mesh).pieces();
  const auto px = static_cast<float>(texture_px);
  const float px_per_unit = pack(pieces, px);
  MeshDescription unwrapped;
  for (const Piece& piece : pieces) {
    std::map<std::uint32_t, std::uint32_t> vertices;
    const auto vertex = [&](std::uint32_t old) {
      const auto [found, is_new] =
          vertices.try_emplace(old, static_cast<std::uint32_t>(unwrapped.positions.size()));
      if (is_new) {
        const Vec2 flat = flatten(mesh.positions[old], piece.direction) - piece.low;
        unwrapped.positions.push_back(mesh.positions[old]);
        unwrapped.normals.push_back(mesh.normals[old]);
        unwrapped.uvs.push_back((piece.place + flat * px_per_unit) * (1 / px));
      }
      return found->second;
    };
    for (const std::size_t t : piece.triangles) {
      const auto& [a, b, c] = mesh.triangles[t];
      unwrapped.triangles.push_back({vertex(a), vertex(b), vertex(c)});
    }
  }
  return unwrapped;
}

namespace {

// The nearest point of the surface to a texel's centre that was found so far.
struct Texel {
  float distance_px = kGutterPx / 2;
  Vec3 position, normal;
  bool covered = false;
};

struct NearestPoint {
  float distance = std::numeric_limits<float>::max();
  std::array<float, 3> weights{};  // of the corners
};

NearestPoint nearest_point(const std::array<Vec2, 3>& corners, Vec2 p) {
  const auto dot2 = [](Vec2 a, Vec2 b) { return a.x * b.x + a.y * b.y; };
  const auto twice_area = [](Vec2 a, Vec2 b, Vec2 c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  };
  const float area = twice_area(corners[0], corners[1], corners[2]);
  const float a = twice_area(p, corners[1], corners[2]) / area,
              b = twice_area(p, corners[2], corners[0]) / area;
  if (a >= 0 && b >= 0 && a + b <= 1) return {0, {a, b, 1 - a - b}};
  NearestPoint nearest;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec2 from = corners[i], along = corners[(i + 1) % 3] - from;
    const float squared = dot2(along, along);
    const float t = squared > 0 ? std::clamp(dot2(p - from, along) / squared, 0.0f, 1.0f) : 0;
    const Vec2 apart = from + along * t - p;
    const float distance = std::sqrt(dot2(apart, apart));
    if (distance >= nearest.distance) continue;
    nearest = {distance, {}};
    nearest.weights[i] = 1 - t;
    nearest.weights[(i + 1) % 3] = t;
  }
  return nearest;
}

class Painter {
 public:
  Painter(const MeshDescription& mesh, int texture_px)
      : mesh_(mesh),
        size_(texture_px),
        texels_(static_cast<std::size_t>(texture_px) * static_cast<std::size_t>(texture_px)) {
    for (const auto& triangle : mesh.triangles) cover(triangle);
  }

  const Texel& at(int x, int y) const { return texels_[index(x, y)]; }

 private:
  // Texels in the triangle and those around it whose nearest point of the surface it may hold.
  void cover(const std::array<std::uint32_t, 3>& triangle) {
    std::array<Vec2, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = mesh_.uvs[triangle[i]] * static_cast<float>(size_);
    const auto [low_x, high_x] = std::minmax({p[0].x, p[1].x, p[2].x});
    const auto [low_y, high_y] = std::minmax({p[0].y, p[1].y, p[2].y});
    for (int y = first(low_y); y <= last(high_y); ++y) {
      for (int x = first(low_x); x <= last(high_x); ++x) consider(x, y, p, triangle);
    }
  }

  void consider(int x, int y, const std::array<Vec2, 3>& p, const std::array<std::uint32_t, 3>& triangle) {
    const NearestPoint nearest =
        nearest_point(p, {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
    Texel& texel = texels_[index(x, y)];
    if (nearest.distance >= texel.distance_px) return;
    texel = {nearest.distance, {}, {}, true};
    for (std::size_t i = 0; i < 3; ++i) {
      texel.position += mesh_.positions[triangle[i]] * nearest.weights[i];
      texel.normal += mesh_.normals[triangle[i]] * nearest.weights[i];
    }
  }

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size_) + static_cast<std::size_t>(x);
  }
  int first(float low) const { return std::max(static_cast<int>(low - kGutterPx / 2), 0); }
  int last(float high) const { return std::min(static_cast<int>(high + kGutterPx / 2), size_ - 1); }

  const MeshDescription& mesh_;
  int size_;
  std::vector<Texel> texels_;  // rows from below
};

}  // namespace

core::Image paint_surface(const MeshDescription& unwrapped, int texture_px,
                          const std::function<core::Rgb(Vec3 position, Vec3 normal)>& color) {
  const Painter painter(unwrapped, texture_px);
  core::Image image(texture_px, texture_px);
  for (int y = 0; y < texture_px; ++y) {
    for (int x = 0; x < texture_px; ++x) {
      const Texel& texel = painter.at(x, texture_px - 1 - y);
      if (texel.covered) image.at(x, y) = color(texel.position, normalize(texel.normal));
    }
  }
  return image;
}

}  // namespace tessera::modelling
