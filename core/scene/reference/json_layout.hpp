// SPDX-License-Identifier: Apache-2.0
// JSON for people: what fits on a line is on a line. Stateless; thread-safe.
#pragma once

#include <string>

#include "core/scene/reference/key_json.hpp"

namespace tessera::core {

std::string json_layout(const OrderedJson& value, std::size_t indent = 0);

}  // namespace tessera::core
