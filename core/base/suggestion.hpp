// SPDX-License-Identifier: Apache-2.0
// Suggestions for misspelt names: keys of scene files, commands and options. Stateless; thread-safe.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tessera::core {

// The edit distance with insertions, deletions, substitutions and transpositions of adjacent letters
// (Damerau 1964; each letter takes part in at most one edit).
std::size_t edit_distance(std::string_view a, std::string_view b);

// "; did you mean 'albedo'?" if one of `known` is close to `name`, or is the only one that begins so, else
// "; known are 'a', 'b'", or nothing without any, or for more than a dozen.
std::string suggestion(std::string_view name, const std::vector<std::string_view>& known);

// A name from outside for messages: escaped and in single quotes. Long names are shortened in the middle,
// because the ends of paths distinguish them.
std::string in_quotes(std::string_view name);

}  // namespace tessera::core
