// SPDX-License-Identifier: Apache-2.0
// Words for messages: what a misspelt name was meant to be, and names out of files made fit to be shown.
// Stateless; thread-safe.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/printable.hpp"

namespace tessera::core {

// How many letters must be inserted, removed, replaced or swapped with their neighbour to turn `a` into `b`
// (Damerau 1964; each letter takes part in one change at most).
std::size_t edit_distance(std::string_view a, std::string_view b);

// "; did you mean 'albedo'?" where one of `known` is close to `name`, else "; known are 'a', 'b'", else
// nothing.
std::string suggestion(std::string_view name, const std::vector<std::string_view>& known);

// A name out of a file as messages show it: printable and in single quotes. Long names are shortened in the
// middle, because a path ends with what tells it apart.
std::string in_quotes(std::string_view name);

// What a file says that it must not: INVALID_ARGUMENT.
tl::unexpected<Error> mistake(std::string message);

}  // namespace tessera::core
