// SPDX-License-Identifier: Apache-2.0
// Reads game records in SGF (Smart Game Format, FF[1] to FF[4]) as far as an image needs them: the board's
// size, who played, and the stones of the main line. Other properties, comments and variations are passed
// over. Nothing in a file crashes it. Stateless; thread-safe.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "scenes/go/board.hpp"

namespace tessera::go {

struct Action {
  enum class Kind { kMove, kPass, kSetUp };
  Kind kind = Kind::kMove;
  Stone color = Stone::kBlack;  // kNone where a set-up clears a point
  Point point;                  // of no meaning for a pass
  int line = 0;                 // in the file
};

struct GameRecord {
  int size = 19;
  std::string black, white, event, date, result;  // as in PB, PW, EV, DT and RE; empty where unknown
  std::vector<Action> actions;                    // in their order

  int move_count() const;  // moves and passes
};

// The first game of an SGF file. Errors name the line and what to mend: "game.sgf:3: B[zz]: ...".
core::Result<GameRecord> parse_sgf(std::string_view text, const std::string& file_name);

}  // namespace tessera::go
