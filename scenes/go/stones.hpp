// SPDX-License-Identifier: Apache-2.0
// Stones of slate and shell: their shape, where they come to lie on the board, and how they heap up in bowls
// and lids. Lengths are in centimetres, y is up.
#pragma once

#include <functional>
#include <vector>

#include "core/scene/description.hpp"
#include "scenes/go/board.hpp"

namespace tessera::go {

// A lens of two spherical caps whose edge is rounded off.
struct StoneShape {
  float radius, half_thickness;
  float rim;  // radius of the rounding
};

// Slate is made a little smaller than shell, because white looks larger than it is.
inline constexpr StoneShape kSlate{1.11f, 0.45f, 0.17f};
inline constexpr StoneShape kShell{1.125f, 0.45f, 0.17f};

inline const StoneShape& shape_of(Stone color) {
  return color == Stone::kBlack ? kSlate : kShell;
}

// Where a stone lies. Its own axis of symmetry points along `up`, a unit vector.
struct Pose {
  core::Vec3 center;
  core::Vec3 up{0, 1, 0};
  float turn = 0;  // about its axis, in turns
};

// A stone in a pose, closed, with the normals of the exact surface. uv are lengths of 8 cm along its two
// equatorial axes, moved by `turn`, so that no two stones show the same piece of a texture.
core::MeshDescription stone_mesh(const StoneShape& shape, const Pose& pose, int segments, int rings);

// Where lines meet, on the plane of the board's top: column 0 is on the left, row 0 in the back.
inline constexpr float kColumnSpacing = 2.2f, kRowSpacing = 2.37f;
core::Vec3 intersection(Point p, int board_size);

struct PlacedStone {
  Stone color;
  Pose pose;
};

// The stones of a board as hands leave them, each near its intersection: stones are wider than columns are
// apart, so neighbours push each other aside. The board's top is y = 0. `precise` is put down exactly.
std::vector<PlacedStone> lay_out(const Board& board, Point precise);

// Drops stones one after the other into a round vessel, each where it comes to lie lowest among some random
// places and tilts. `floor` is the height of the vessel's bottom at a distance from its axis, and no stone
// reaches farther out than `inner_radius`. No two stones meet.
struct Heap {
  StoneShape shape;
  int count = 0;
  float inner_radius = 5;
  std::function<float(float radius)> floor;
  int seed = 0;
};
std::vector<Pose> heap_up(const Heap& heap);

}  // namespace tessera::go
