// SPDX-License-Identifier: Apache-2.0
#include "scenes/go/board.hpp"

namespace tessera::go {

std::vector<Point> Board::neighbours(Point p) const {
  std::vector<Point> found;
  if (p.column > 0) found.push_back({p.column - 1, p.row});
  if (p.column < size_ - 1) found.push_back({p.column + 1, p.row});
  if (p.row > 0) found.push_back({p.column, p.row - 1});
  if (p.row < size_ - 1) found.push_back({p.column, p.row + 1});
  return found;
}

Board::Group Board::group_at(Point p) const {
  Group group{{p}};
  std::vector<bool> seen(stones_.size());
  seen[index(p)] = true;
  for (std::size_t i = 0; i < group.stones.size(); ++i) {
    for (const Point next : neighbours(group.stones[i])) {
      if (at(next) == Stone::kNone) group.has_liberty = true;
      if (at(next) != at(p) || seen[index(next)]) continue;
      seen[index(next)] = true;
      group.stones.push_back(next);
    }
  }
  return group;
}

int Board::capture(Point p) {
  const Group group = group_at(p);
  if (group.has_liberty) return 0;
  const auto count = static_cast<int>(group.stones.size());
  captured_[static_cast<std::size_t>(at(p))] += count;
  for (const Point taken : group.stones) set_up(taken, Stone::kNone);
  return count;
}

core::Status Board::play(Point p, Stone color) {
  if (at(p) != Stone::kNone) return core::fail(core::ErrorCode::kInvalidArgument, "there is a stone already");
  set_up(p, color);
  int taken = 0;
  for (const Point next : neighbours(p)) {
    if (at(next) == opponent(color)) taken += capture(next);
  }
  if (taken > 0 || group_at(p).has_liberty) return {};
  set_up(p, Stone::kNone);
  return core::fail(core::ErrorCode::kInvalidArgument, "the stone would have no liberty and capture nothing");
}

}  // namespace tessera::go
