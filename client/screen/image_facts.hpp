// SPDX-License-Identifier: Apache-2.0
// An image in numbers, for `tessera view --json`. A pure function.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/image/image.hpp"

namespace tessera::client {

// {"image", "width", "height", "minimum", "mean", "maximum"}, the last three of each channel of the linear
// pixels; numbers that are not finite are null.
nlohmann::ordered_json image_facts(const std::string& name, const core::Image& image);

}  // namespace tessera::client
