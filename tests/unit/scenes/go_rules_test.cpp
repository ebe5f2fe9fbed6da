// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "scenes/go/board.hpp"

namespace tessera::go {
namespace {

// 'X' is black, 'O' white, '.' empty; rows from the top.
Board board_of(const std::vector<std::string>& rows) {
  Board board(static_cast<int>(rows.size()));
  for (int row = 0; row < board.size(); ++row) {
    for (int column = 0; column < board.size(); ++column) {
      const char c = rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
      board.set_up({column, row}, c == 'X' ? Stone::kBlack : c == 'O' ? Stone::kWhite : Stone::kNone);
    }
  }
  return board;
}

std::vector<std::string> rows_of(const Board& board) {
  std::vector<std::string> rows(static_cast<std::size_t>(board.size()));
  for (int row = 0; row < board.size(); ++row) {
    for (int column = 0; column < board.size(); ++column)
      rows[static_cast<std::size_t>(row)] += ".XO"[static_cast<int>(board.at({column, row}))];
  }
  return rows;
}

using Rows = std::vector<std::string>;

TEST(GoBoard, PlacesStonesAndKeepsWhatHasLiberties) {
  Board board(5);
  EXPECT_TRUE(board.play({2, 2}, Stone::kBlack));
  EXPECT_TRUE(board.play({2, 1}, Stone::kWhite));
  EXPECT_EQ(rows_of(board), (Rows{".....", "..O..", "..X..", ".....", "....."}));
  EXPECT_EQ(board.captured(Stone::kBlack) + board.captured(Stone::kWhite), 0);
}

TEST(GoBoard, CapturesASingleStone) {
  Board board = board_of({".....", "..O..", ".OX..", "..O..", "....."});
  ASSERT_TRUE(board.play({3, 2}, Stone::kWhite));
  EXPECT_EQ(rows_of(board), (Rows{".....", "..O..", ".O.O.", "..O..", "....."}));
  EXPECT_EQ(board.captured(Stone::kBlack), 1);
  EXPECT_EQ(board.captured(Stone::kWhite), 0);
}

TEST(GoBoard, CapturesAGroup) {
  Board board = board_of({".OO..", "OXXO.", "OXOO.", ".....", "....."});
  ASSERT_TRUE(board.play({1, 3}, Stone::kWhite));
  EXPECT_EQ(rows_of(board), (Rows{".OO..", "O..O.", "O.OO.", ".O...", "....."}));
  EXPECT_EQ(board.captured(Stone::kBlack), 3);
}

TEST(GoBoard, CapturesInTheCorner) {
  Board board = board_of({"XO...", ".....", ".....", ".....", "....."});
  ASSERT_TRUE(board.play({0, 1}, Stone::kWhite));
  EXPECT_EQ(board.at({0, 0}), Stone::kNone);
  EXPECT_EQ(board.captured(Stone::kBlack), 1);
}

TEST(GoBoard, CapturesSeveralGroupsAtOnce) {
  Board board = board_of({"..X..", ".XOX.", "XO.OX", ".XOX.", "..X.."});
  ASSERT_TRUE(board.play({2, 2}, Stone::kBlack));
  EXPECT_EQ(board.captured(Stone::kWhite), 4);
  EXPECT_EQ(rows_of(board), (Rows{"..X..", ".X.X.", "X.X.X", ".X.X.", "..X.."}));
}

TEST(GoBoard, DoesNotCaptureWhatHasALibertyLeft) {
  Board board = board_of({".O...", "OX...", ".O...", ".....", "....."});
  ASSERT_TRUE(board.play({3, 1}, Stone::kWhite));
  EXPECT_EQ(board.at({1, 1}), Stone::kBlack);
}

TEST(GoBoard, SnapbackTakesBackMoreThanItGave) {
  Board board = board_of({".OX..", ".OX..", "OOX..", "XX...", "....."});
  ASSERT_TRUE(board.play({0, 1}, Stone::kBlack));
  ASSERT_TRUE(board.play({0, 0}, Stone::kWhite));
  EXPECT_EQ(board.captured(Stone::kBlack), 1);
  ASSERT_TRUE(board.play({0, 1}, Stone::kBlack));
  EXPECT_EQ(board.captured(Stone::kWhite), 5);
  EXPECT_EQ(rows_of(board), (Rows{"..X..", "X.X..", "..X..", "XX...", "....."}));
}

TEST(GoBoard, KoMayBeTakenBack) {
  Board board = board_of({".XO..", "X.XO.", ".XO..", ".....", "....."});
  ASSERT_TRUE(board.play({1, 1}, Stone::kWhite));
  EXPECT_EQ(board.captured(Stone::kBlack), 1);
  ASSERT_TRUE(board.play({2, 1}, Stone::kBlack));
  EXPECT_EQ(board.captured(Stone::kWhite), 1);
  EXPECT_EQ(rows_of(board), (Rows{".XO..", "X.XO.", ".XO..", ".....", "....."}));
}

TEST(GoBoard, RefusesOccupiedPoints) {
  Board board = board_of({"X....", ".....", ".....", ".....", "....."});
  const core::Status played = board.play({0, 0}, Stone::kWhite);
  ASSERT_FALSE(played);
  EXPECT_EQ(played.error().message, "there is a stone already");
  EXPECT_EQ(board.at({0, 0}), Stone::kBlack);
}

TEST(GoBoard, RefusesSuicideAndChangesNothing) {
  for (const Rows& rows : {Rows{".O...", "O....", ".....", ".....", "....."},
                           Rows{".XO..", "XXO..", "OO...", ".....", "....."}}) {
    Board board = board_of(rows);
    const core::Status played = board.play({0, 0}, Stone::kBlack);
    ASSERT_FALSE(played);
    EXPECT_EQ(played.error().message, "the stone would have no liberty and capture nothing");
    EXPECT_EQ(rows_of(board), rows);
  }
}

TEST(GoBoard, FillingTheLastLibertyIsNoSuicideIfItCaptures) {
  Board board = board_of({".XO..", "XXO..", "OOX..", "XXX..", "....."});
  ASSERT_TRUE(board.play({0, 0}, Stone::kWhite));
  EXPECT_EQ(board.captured(Stone::kBlack), 3);
}

TEST(GoBoard, SetUpTakesNothingOff) {
  Board board = board_of({"XO...", "O....", ".....", ".....", "....."});
  EXPECT_EQ(board.at({0, 0}), Stone::kBlack);
  board.set_up({0, 0}, Stone::kNone);
  EXPECT_EQ(board.at({0, 0}), Stone::kNone);
  EXPECT_EQ(board.captured(Stone::kBlack), 0);
}

}  // namespace
}  // namespace tessera::go
