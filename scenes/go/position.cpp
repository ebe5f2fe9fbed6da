// SPDX-License-Identifier: Apache-2.0
#include "scenes/go/position.hpp"

#include <fmt/format.h>

namespace tessera::go {
namespace {

std::string as_in_sgf(const Action& action) {
  return fmt::format("{}[{}{}]", action.color == Stone::kBlack ? 'B' : 'W',
                     static_cast<char>('a' + action.point.column), static_cast<char>('a' + action.point.row));
}

}  // namespace

core::Result<Position> replay(const GameRecord& record, std::optional<int> moves,
                              const std::string& file_name) {
  if (moves && *moves > record.move_count()) {
    return core::fail(
        core::ErrorCode::kInvalidArgument,
        fmt::format("{}: the record has {} moves, fewer than {}", file_name, record.move_count(), *moves));
  }
  Position position{Board(record.size), 0, std::nullopt};
  for (const Action& action : record.actions) {
    if (action.kind == Action::Kind::kSetUp) {
      position.board.set_up(action.point, action.color);
      continue;
    }
    if (moves && position.moves == *moves) break;
    ++position.moves;
    if (action.kind == Action::Kind::kPass) continue;
    const core::Status played = position.board.play(action.point, action.color);
    if (!played) {
      return core::fail(played.error().within(
          fmt::format("{}:{}: move {}, {}", file_name, action.line, position.moves, as_in_sgf(action))));
    }
    if (action.color == Stone::kWhite) position.last_white = action.point;
  }
  const auto last = position.last_white;
  if (last && position.board.at(*last) != Stone::kWhite) position.last_white.reset();
  return position;
}

}  // namespace tessera::go
