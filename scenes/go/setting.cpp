// SPDX-License-Identifier: Apache-2.0
#include "scenes/go/setting.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "scenes/go/furniture.hpp"
#include "scenes/go/stones.hpp"
#include "scenes/modelling/surface.hpp"

namespace tessera::go {
namespace {

using core::Vec3;

void add_stone(core::MeshDescription& mesh, Stone color, const Pose& pose) {
  constexpr int kSegments = 48, kRings = 20;
  modelling::append(mesh, stone_mesh(shape_of(color), pose, kSegments, kRings));
}

void add_heap(core::MeshDescription& mesh, Stone color, const Heap& heap, Vec3 at) {
  for (Pose pose : heap_up(heap)) {
    pose.center += at;
    add_stone(mesh, color, pose);
  }
}

// A bowl starts with 181 stones, heaped to its mouth. Only those on top are modelled.
Heap in_bowl(Stone color, int left) {
  constexpr int kFull = 181, kModelled = 70;
  const float used = std::clamp(1 - static_cast<float>(left) / kFull, 0.0f, 1.0f);
  const float bottom = 5.6f - 4.2f * used;
  return {shape_of(color), std::min(left, kModelled), kBowlMouthRadius - 0.1f,
          [bottom](float) { return bottom; }, color == Stone::kBlack ? 1 : 2};
}

Heap in_lid(Stone color, int captured) {
  return {shape_of(color), captured, 5, lid_floor(), color == Stone::kBlack ? 3 : 4};
}

// All stones of a colour: on the board, in its player's bowl, and captured in the opponent's lid.
core::MeshDescription stones(const Position& position, Stone color) {
  core::MeshDescription mesh;
  int on_board = 0;
  for (const PlacedStone& stone : lay_out(position.board, position.last_white.value_or(Point{-1, -1}))) {
    if (stone.color != color) continue;
    add_stone(mesh, color, stone.pose);
    ++on_board;
  }
  const Place& own = color == Stone::kBlack ? kBlackPlace : kWhitePlace;
  const Place& other = color == Stone::kBlack ? kWhitePlace : kBlackPlace;
  const int captured = position.board.captured(color);
  add_heap(mesh, color, in_bowl(color, std::max(181 - on_board - captured, 0)), own.bowl);
  add_heap(mesh, color, in_lid(color, captured), other.lid);
  return mesh;
}

}  // namespace

std::vector<std::pair<std::string, std::function<Model()>>> setting(const Position& position) {
  const int size = position.board.size();
  const auto of_stones = [&position](Stone color) {
    return [&position, color] { return Model{stones(position, color), {}, {}}; };
  };
  return {{"board_top", [size] { return board_top(size); }},
          {"board_sides", [size] { return board_sides(size); }},
          {"black_stones", of_stones(Stone::kBlack)},
          {"white_stones", of_stones(Stone::kWhite)},
          {"bowls", bowls},
          {"lids", lids},
          {"table", table},
          {"shell", shell},
          {"slate", slate}};
}

std::string summary(const GameRecord& record, const Position& position) {
  const auto name = [](const std::string& given) { return given.empty() ? std::string("unknown") : given; };
  std::string text = fmt::format(
      "{} (black), {} (white): {} moves; captured {} black, {} white", name(record.black), name(record.white),
      position.moves, position.board.captured(Stone::kBlack), position.board.captured(Stone::kWhite));
  if (position.last_white) {
    const Vec3 p = intersection(*position.last_white, position.board.size());
    text += fmt::format("; the last white stone is at [{:.2f}, {:.2f}, {:.2f}]", p.x, p.y, p.z);
  }
  return text;
}

}  // namespace tessera::go
