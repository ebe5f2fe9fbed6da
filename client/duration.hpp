// SPDX-License-Identifier: Apache-2.0
// Durations on the command line.
#pragma once

#include <optional>
#include <string_view>

namespace tessera::client {

// The seconds of "90s", "10m", "1h30m" or "2d": whole numbers with units, the larger units first. Nothing for
// other texts, and for more than 1000 days.
std::optional<double> parse_duration(std::string_view text);

}  // namespace tessera::client
