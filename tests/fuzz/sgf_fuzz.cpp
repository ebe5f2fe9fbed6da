// SPDX-License-Identifier: Apache-2.0
// The record of a game of go, and the game replayed.
#include "scenes/go/position.hpp"
#include "scenes/go/sgf.hpp"
#include "tests/fuzz/expect.hpp"
#include "tests/fuzz/parts.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tessera;
  const auto record = go::parse_sgf(fuzz::as_text(data, size), "x.sgf");
  if (!fuzz::expect_answer(record)) return 0;
  const auto position = go::replay(*record, std::nullopt, "x.sgf");
  if (fuzz::expect_answer(position)) {
    fuzz::expect(position->moves == record->move_count(), "every move is played");
  }
  return 0;
}
