// SPDX-License-Identifier: Apache-2.0
// Suggestions for misspelt names: keys of scene files, commands and options. Stateless; thread-safe.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tessera::core {

// The edit distance with insertions, deletions, substitutions and transpositions of adjacent letters
// (Damerau 1964; each letter takes part in at most one edit).
std::size_t edit_distance(std::string_view a, std::string_view b);

// The one of `known` that is close to `name`, or is the only one that begins so.
std::optional<std::string_view> similar_name(std::string_view name,
                                             const std::vector<std::string_view>& known);

// "; did you mean 'albedo'?" if there is a similar name, else "; known are 'a', 'b'", or nothing without any,
// or for more than fourteen.
std::string suggestion(std::string_view name, const std::vector<std::string_view>& known);

// A name from outside for messages: escaped and in single quotes. Long names are shortened in the middle,
// because the ends of paths distinguish them.
std::string in_quotes(std::string_view name);

}  // namespace tessera::core
