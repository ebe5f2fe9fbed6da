// SPDX-License-Identifier: Apache-2.0
// Values in the attributes of a Mitsuba scene. Independent of the locale. Stateless; thread-safe.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/math/vec3.hpp"
#include "core/scene/mitsuba/scene_graph.hpp"

namespace tessera::core::mitsuba {

// A finite number that fits a float, with blanks around it; nullopt for anything else.
std::optional<double> parse_number(std::string_view text);
std::optional<std::int64_t> parse_integer(std::string_view text);
// "true" or "false", ignoring case.
std::optional<bool> parse_boolean(std::string_view text);
// The words of a list, separated by blanks and commas.
std::vector<std::string_view> split_list(std::string_view text);
// All numbers of a list; nullopt if a word is none.
std::optional<std::vector<double>> parse_numbers(std::string_view text);
// Three numbers, or one for all three.
std::optional<Vec3> parse_triple(std::string_view text);
// "#rrggbb", as fractions of 255.
std::optional<Vec3> parse_hexadecimal(std::string_view text);
// "400:0.2, 500:0.3": wavelengths in nm, strictly growing after sorting. nullopt if it is malformed.
std::optional<Samples> parse_samples(std::string_view text);
// The lines of a file of samples: two numbers each; '#' begins a comment.
std::optional<Samples> parse_sample_file(std::string_view text);

// "toWorld" becomes "to_world", as Mitsuba upgrades files before version 2.
std::string in_snake_case(std::string_view name);

}  // namespace tessera::core::mitsuba
