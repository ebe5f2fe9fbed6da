// SPDX-License-Identifier: Apache-2.0
// Helpers for messages: suggestions for misspelt names, and escaping of names from files. Stateless;
// thread-safe.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/printable.hpp"

namespace tessera::core {

// The edit distance with insertions, deletions, substitutions and transpositions of adjacent letters
// (Damerau 1964; each letter takes part in at most one edit).
std::size_t edit_distance(std::string_view a, std::string_view b);

// "; did you mean 'albedo'?" if one of `known` is close to `name`, else "; known are 'a', 'b'", or nothing
// without any.
std::string suggestion(std::string_view name, const std::vector<std::string_view>& known);

// A name from a file for messages: escaped and in single quotes. Long names are shortened in the middle,
// because the ends of paths distinguish them.
std::string in_quotes(std::string_view name);

// An INVALID_ARGUMENT error for invalid content of a file.
tl::unexpected<Error> mistake(std::string message);

}  // namespace tessera::core
