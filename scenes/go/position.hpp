// SPDX-License-Identifier: Apache-2.0
// A game at one of its moves.
#pragma once

#include <optional>
#include <string>

#include "core/base/error.hpp"
#include "scenes/go/board.hpp"
#include "scenes/go/sgf.hpp"

namespace tessera::go {

// The board after some moves, and what was played last.
struct Position {
  Board board{19};
  int moves = 0;
  std::optional<Point> last_white;  // the white stone played last, if it is still on the board
};

// Plays the first `moves` moves of a record (all of them if absent), each pass being one, and what was set up
// on the way. Errors: illegal moves, with their lines, and fewer moves than asked for.
core::Result<Position> replay(const GameRecord& record, std::optional<int> moves,
                              const std::string& file_name);

}  // namespace tessera::go
