// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>
#include <string>

#include "core/image/file_io.hpp"
#include "core/sampling/hash.hpp"
#include "scenes/go/position.hpp"
#include "scenes/go/sgf.hpp"

namespace tessera::go {
namespace {

using Kind = Action::Kind;

GameRecord parsed(const std::string& text) {
  core::Result<GameRecord> record = parse_sgf(text, "game.sgf");
  EXPECT_TRUE(record) << record.error().message;
  return record ? std::move(*record) : GameRecord{};
}

Position played(const std::string& text, std::optional<int> moves = {}) {
  core::Result<Position> position = replay(parsed(text), moves, "game.sgf");
  EXPECT_TRUE(position) << position.error().message;
  return position ? std::move(*position) : Position{};
}

TEST(Sgf, ReadsPlayersAndMoves) {
  const GameRecord record = parsed(
      "(;GM[1]FF[4]SZ[13]PB[Ann]PW[Bo]EV[Club]DT[2020-02-02]RE[B+R]KM[6.5]\n;B[dd];W[jj]C[a "
      "comment]\n;B[kc])");
  EXPECT_EQ(record.size, 13);
  EXPECT_EQ(record.black, "Ann");
  EXPECT_EQ(record.white, "Bo");
  EXPECT_EQ(record.event, "Club");
  EXPECT_EQ(record.date, "2020-02-02");
  EXPECT_EQ(record.result, "B+R");
  ASSERT_EQ(record.actions.size(), 3u);
  EXPECT_EQ(record.actions[1].color, Stone::kWhite);
  EXPECT_EQ(record.actions[1].point, (Point{9, 9}));
  EXPECT_EQ(record.actions[1].line, 2);
  EXPECT_EQ(record.actions[2].point, (Point{10, 2}));
  EXPECT_EQ(record.actions[2].line, 3);
  EXPECT_EQ(record.move_count(), 3);
}

TEST(Sgf, BoardsHaveNineteenLinesUnlessTheFileSaysOtherwise) {
  EXPECT_EQ(parsed("(;B[ss])").size, 19);
  EXPECT_EQ(parsed("(;SZ[9];B[ii])").size, 9);
  EXPECT_EQ(parsed("(;SZ[13:13])").size, 13);
  EXPECT_EQ(parsed("(;AB[ii]SZ[ 9 ])").size, 9);
}

TEST(Sgf, EmptyAndTtArePasses) {
  const GameRecord record = parsed("(;B[];W[tt];B[dd])");
  ASSERT_EQ(record.actions.size(), 3u);
  EXPECT_EQ(record.actions[0].kind, Kind::kPass);
  EXPECT_EQ(record.actions[1].kind, Kind::kPass);
  EXPECT_EQ(record.actions[2].kind, Kind::kMove);
  EXPECT_EQ(record.move_count(), 3);
}

TEST(Sgf, SetsUpPointsAndRectangles) {
  const Position position = played("(;SZ[9]AB[aa][ab:bc]\n[ii]AW[ee]AE[bc])");
  const Board& board = position.board;
  for (const Point p : {Point{0, 0}, Point{0, 1}, Point{1, 1}, Point{0, 2}, Point{8, 8}})
    EXPECT_EQ(board.at(p), Stone::kBlack) << p.column << ", " << p.row;
  EXPECT_EQ(board.at({4, 4}), Stone::kWhite);
  EXPECT_EQ(board.at({1, 2}), Stone::kNone);
}

TEST(Sgf, FollowsTheFirstVariation) {
  const GameRecord record = parsed("(;B[aa](;W[bb];B[cc](;W[dd])(;W[ee]))(;W[ff]C[)](;B[gg]))\n);B[hh]");
  ASSERT_EQ(record.actions.size(), 4u);
  EXPECT_EQ(record.actions[3].point, (Point{3, 3}));
}

TEST(Sgf, OnlyTheFirstGameCounts) {
  EXPECT_EQ(parsed("(;B[aa])(;B[bb];W[cc])").actions.size(), 1u);
}

TEST(Sgf, EscapesAndBracketsInText) {
  const GameRecord record = parsed(R"((;PB[A [9p\] \\ B\:]PW[x;(y)];B[dd]C[see [1\], (2) and ;W[ee\]]))");
  EXPECT_EQ(record.black, R"(A [9p] \ B:)");
  EXPECT_EQ(record.white, "x;(y)");
  EXPECT_EQ(record.actions.size(), 1u);
}

TEST(Sgf, LongNamesAndTextInFrontAreAsInOldFiles) {
  const GameRecord record =
      parsed("From: the club (of go)\r\n\r\n( ;\r\nSiZe[9]AddBlack[cc]\r\nBlack\r\n[dd]\r\n)");
  EXPECT_EQ(record.size, 9);
  ASSERT_EQ(record.actions.size(), 2u);
  EXPECT_EQ(record.actions[0].kind, Kind::kSetUp);
  EXPECT_EQ(record.actions[1].line, 5);
}

struct Mistake {
  const char* name;
  std::string text;
  const char* message;
};
void PrintTo(const Mistake& mistake, std::ostream* out) {
  *out << mistake.name;
}

class SgfMistake : public testing::TestWithParam<Mistake> {};

TEST_P(SgfMistake, IsToldWithItsLineAndWhatToMend) {
  core::Result<GameRecord> record = parse_sgf(GetParam().text, "game.sgf");
  core::Error error;
  if (record) {
    const core::Result<Position> position = replay(*record, {}, "game.sgf");
    ASSERT_FALSE(position);
    error = position.error();
  } else {
    error = record.error();
  }
  EXPECT_EQ(error.message, GetParam().message);
  EXPECT_EQ(error.code, core::ErrorCode::kInvalidArgument);
}

INSTANTIATE_TEST_SUITE_P(
    All, SgfMistake,
    testing::Values(
        Mistake{"Empty", "", "game.sgf:1: there is no game; a record begins with '(;'"},
        Mistake{"Prose", "Dear (friend)\nhello", "game.sgf:1: there is no game; a record begins with '(;'"},
        Mistake{"NotClosed", "(;B[aa]\n;W[bb]\n",
                "game.sgf:3: the record ends within a game: 1 ')' missing; is the file cut off?"},
        Mistake{"VariationNotClosed", "(;B[aa](;W[bb](;B[cc])",
                "game.sgf:1: the record ends within a game: 2 ')' missing; is the file cut off?"},
        Mistake{"ValueNotClosed", "(;B[aa]\n;W[bb)\n\n", "game.sgf:2: the '[' is never closed; add a ']'"},
        Mistake{"EndsInAnEscape", "(;C[a\\", "game.sgf:1: the '[' is never closed; add a ']'"},
        Mistake{"NoValue", "(;B[aa];W;B[cc])", "game.sgf:1: 'W' has no value; write W[...]"},
        Mistake{"EndsAfterAName", "(;B", "game.sgf:1: 'B' has no value; write B[...]"},
        Mistake{"SmallLetters", "(;b[aa])",
                "game.sgf:1: names of properties are capital letters, as in B[dd]"},
        Mistake{"StrayCharacter", "(;B[aa]\n;W[bb] 3)", "game.sgf:2: '3' does not belong here"},
        Mistake{"StrayByte", "(;B[aa]\x01)", "game.sgf:1: the byte 0x01 does not belong here"},
        Mistake{"OutsideTheBoard", "(;SZ[9]\n;B[jj])",
                "game.sgf:2: B[jj]: not a point of this board; they run from aa to ii, and a pass is empty"},
        Mistake{"Capitals", "(;B[AA])",
                "game.sgf:1: B[AA]: not a point of this board; they run from aa to ss, and a pass is empty"},
        Mistake{"LettersMissing", "(;W[d])",
                "game.sgf:1: W[d]: not a point of this board; they run from aa to ss, and a pass is empty"},
        Mistake{"BytesThatCannotBePrinted", "(;W[\xdd\x7f])",
                "game.sgf:1: W[??]: not a point of this board; they run from aa to ss, and a pass is empty"},
        Mistake{"LongValue", "(;W[a point in the\nlower left])",
                "game.sgf:1: W[a point in the?lower...]: not a point of this board; they run from aa to ss, "
                "and a pass is empty"},
        Mistake{"SetUpOutside", "(;AB[aa:tt])",
                "game.sgf:1: AB[aa:tt]: not a point of this board; they run from aa to ss"},
        Mistake{"SeveralMoves", "(;B[aa][bb])", "game.sgf:1: B[aa]: a move is one point, not several"},
        Mistake{"OtherGame", "(;GM[2];B[aa])", "game.sgf:1: GM[2]: not a game of go, GM[1]"},
        Mistake{"NoSize", "(;SZ[big])", "game.sgf:1: SZ[big]: boards are square, with 5 to 19 lines"},
        Mistake{"HugeSize", "(;SZ[99999999999])",
                "game.sgf:1: SZ[99999999999]: boards are square, with 5 to 19 lines"},
        Mistake{"Oblong", "(;SZ[19:13])", "game.sgf:1: SZ[19:13]: boards are square, with 5 to 19 lines"},
        Mistake{"Occupied", "(;B[aa]\n;W[bb]\n;B[bb])",
                "game.sgf:3: move 3, B[bb]: there is a stone already"},
        Mistake{"Suicide", "(;AW[ab][ba]\n;B[aa])",
                "game.sgf:2: move 1, B[aa]: the stone would have no liberty and capture nothing"}),
    [](const auto& tested) { return std::string(tested.param.name); });

// Replaces, drops, doubles and cuts pieces of a record, each time differently.
std::string mutated(std::string text, std::uint64_t seed) {
  const auto random = [&seed](std::size_t limit) {
    seed = core::sampling::hash(seed, 1);
    return static_cast<std::size_t>(seed % limit);
  };
  for (std::size_t i = 0; i <= random(4) && !text.empty(); ++i) {
    const std::size_t at = random(text.size()), length = 1 + random(12);
    switch (random(4)) {
      case 0:
        text[at] = static_cast<char>(random(256));
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, text.substr(random(text.size()), length));
        break;
      default:
        text.resize(at);
    }
  }
  return text;
}

TEST(Sgf, GarbageIsRefusedOrReadButNeverCrashes) {
  const std::string good = "x(;SZ[9]AB[aa:cc]PB[a\\]b](;B[dd];W[ee];B[])(;B[ff]))";
  int refused = 0;
  for (std::uint64_t seed = 0; seed < 20000; ++seed) {
    const std::string text = mutated(good, seed);
    const core::Result<GameRecord> record = parse_sgf(text, "game.sgf");
    const bool ok = record && replay(*record, {}, "game.sgf");
    if (!ok) ++refused;
  }
  EXPECT_GT(refused, 2000);
  EXPECT_LT(refused, 19000);
}

TEST(Sgf, ManyBracketsAreNoTrouble) {
  EXPECT_FALSE(parse_sgf(std::string(1 << 20, '('), "game.sgf"));
  std::string nested;
  for (int i = 0; i < 1 << 18; ++i) nested += "(;";
  EXPECT_FALSE(parse_sgf(nested, "game.sgf"));
  EXPECT_TRUE(parse_sgf(nested + std::string(1 << 18, ')'), "game.sgf"));
}

TEST(Replay, StopsAfterTheMovesAskedFor) {
  const std::string text = "(;SZ[9]AB[ii];B[aa];W[];B[bb];W[cc])";
  EXPECT_EQ(played(text, 0).moves, 0);
  EXPECT_EQ(played(text, 0).board.at({8, 8}), Stone::kBlack);
  const Position third = played(text, 3);
  EXPECT_EQ(third.board.at({1, 1}), Stone::kBlack);
  EXPECT_EQ(third.board.at({2, 2}), Stone::kNone);
  EXPECT_EQ(third.last_white, std::nullopt);
  EXPECT_EQ(played(text).last_white, (Point{2, 2}));
}

TEST(Replay, MoreMovesThanThereAreIsAMistake) {
  const core::Result<Position> position = replay(parsed("(;B[aa];W[bb])"), 3, "game.sgf");
  ASSERT_FALSE(position);
  EXPECT_EQ(position.error().message, "game.sgf: the record has 2 moves, fewer than 3");
}

TEST(Replay, ACapturedLastWhiteStoneIsNoLongerThere) {
  const Position position = played("(;SZ[9];B[ab];W[aa];B[ba])");
  EXPECT_EQ(position.last_white, std::nullopt);
  EXPECT_EQ(position.board.captured(Stone::kWhite), 1);
}

TEST(ShippedGame, HasLostOneStoneOfEachColourWhenTheImageIsTaken) {
  const std::string path = TESSERA_SOURCE_DIR "/scenes/go/lee_sedol_alphago_4.sgf";
  const core::Result<std::string> text = core::read_file(path);
  ASSERT_TRUE(text);
  const GameRecord record = parsed(*text);
  EXPECT_EQ(record.white, "Lee Sedol");
  EXPECT_EQ(record.move_count(), 180);
  const core::Result<Position> position = replay(record, 94, path);
  ASSERT_TRUE(position);
  EXPECT_EQ(position->board.captured(Stone::kBlack), 1);
  EXPECT_EQ(position->board.captured(Stone::kWhite), 1);
  EXPECT_EQ(position->last_white, (Point{14, 12}));
  EXPECT_TRUE(replay(record, {}, path));
}

}  // namespace
}  // namespace tessera::go
