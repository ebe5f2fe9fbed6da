// SPDX-License-Identifier: Apache-2.0
// The board, the bowls with their lids, and the table that all stands on.
#pragma once

#include <functional>

#include "core/math/vec3.hpp"
#include "scenes/go/model.hpp"

namespace tessera::go {

// The top of a board of kaya for `size` lines, its lines and star points lacquered on.
Model board_top(int size);
// Its four sides and the bevel that leads to them.
Model board_sides(int size);

// Black sits in front of the board and White behind it, each with a bowl of stones and its lid, turned over
// to hold what was captured.
struct Place {
  core::Vec3 bowl, lid;  // where their feet stand
};
inline constexpr Place kBlackPlace{{32.5f, -kBoardHeight, -20}, {28.5f, -kBoardHeight, -5.5f}};
inline constexpr Place kWhitePlace{{14, -kBoardHeight, -35}, {-1, -kBoardHeight, -36}};

inline constexpr float kBowlMouthRadius = 5.1f;
Model bowls();

Model lids();
// The height of a lid's inside above its foot at a distance from its axis.
std::function<float(float radius)> lid_floor();

// A texture for the table, 220 cm wide and 160 cm deep.
Model table();

// What every stone is cut from: shell with its lines of growth, slate with its flecks. 8 cm wide.
Model shell();
Model slate();

}  // namespace tessera::go
