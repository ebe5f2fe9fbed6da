// SPDX-License-Identifier: Apache-2.0
// A go board and its rules: stones are placed, groups without liberties are taken off and counted. Ko is not
// judged: a record says what was played.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::go {

enum class Stone : std::uint8_t { kNone, kBlack, kWhite };

inline Stone opponent(Stone color) {
  return color == Stone::kBlack ? Stone::kWhite : Stone::kBlack;
}

// Counted from the upper left corner of a diagram, as in SGF: both in [0, size).
struct Point {
  int column = 0, row = 0;
  bool operator==(const Point&) const = default;
};

inline constexpr int kMinBoardSize = 5, kMaxBoardSize = 19;

class Board {
 public:
  explicit Board(int size) : size_(size), stones_(static_cast<std::size_t>(size * size), Stone::kNone) {}

  int size() const { return size_; }
  Stone at(Point p) const { return stones_[index(p)]; }
  // How many stones of this colour have been taken off.
  int captured(Stone color) const { return captured_[static_cast<std::size_t>(color)]; }

  // Puts a stone, or none, where it is told, whatever was there, and takes nothing off.
  void set_up(Point p, Stone color) { stones_[index(p)] = color; }

  // Places a stone and takes off what it captures. Refuses occupied points and suicide, and then changes
  // nothing.
  core::Status play(Point p, Stone color);

 private:
  struct Group {
    std::vector<Point> stones;
    bool has_liberty = false;
  };

  std::size_t index(Point p) const { return static_cast<std::size_t>(p.row * size_ + p.column); }
  std::vector<Point> neighbours(Point p) const;
  Group group_at(Point p) const;
  int capture(Point p);  // takes off the group at p if it has no liberty; how many stones that were

  int size_;
  std::vector<Stone> stones_;
  std::array<int, 3> captured_{};
};

}  // namespace tessera::go
