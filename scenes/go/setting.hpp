// Everything in the picture for one position of a game, as files' names and what makes their models.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "scenes/go/model.hpp"
#include "scenes/go/position.hpp"

namespace tessera::go {

std::vector<std::pair<std::string, std::function<Model()>>> setting(const Position& position);

// What was made, for people: "AlphaGo (black), Lee Sedol (white): 94 moves; captured 1 black, 1 white".
std::string summary(const GameRecord& record, const Position& position);

}  // namespace tessera::go
