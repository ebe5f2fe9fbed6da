// SPDX-License-Identifier: Apache-2.0
// The record of a game of go, and the game replayed.
#include "scenes/go/position.hpp"
#include "scenes/go/sgf.hpp"
#include "tests/fuzz/expect.hpp"
#include "tests/fuzz/fuzzer.hpp"

namespace tessera::fuzz {

TESSERA_FUZZER(sgf, std::string_view input) {
  const auto record = go::parse_sgf(input, "x.sgf");
  if (!expect_answer(record)) return;
  const auto position = go::replay(*record, std::nullopt, "x.sgf");
  if (expect_answer(position)) {
    expect(position->moves == record->move_count(), "every move is played");
  }
}

}  // namespace tessera::fuzz
