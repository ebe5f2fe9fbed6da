// SPDX-License-Identifier: Apache-2.0
// Everything in the image for one position of a game, as files' names and what makes their models.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "scenes/go/model.hpp"
#include "scenes/go/position.hpp"

namespace tessera::go {

std::vector<std::pair<std::string, std::function<Model()>>> setting(const Position& position);

// What was made, for people: "Ann (black), Bo (white): 94 moves; captured 1 black, 1 white; the last white
// stone is at [11.00, 0.00, 7.11]", where a camera may focus.
std::string summary(const GameRecord& record, const Position& position);

}  // namespace tessera::go
