// SPDX-License-Identifier: Apache-2.0
// The JSON Schema of scene files. Stateless; thread-safe.
#pragma once

#include <set>
#include <string>
#include <string_view>

namespace tessera::core {

struct UpdatedSchema {
  std::string text;
  // The places of the objects whose keys are those of tables, as JSON pointers.
  std::set<std::string> objects;
};

// `schema` with all that follows from the tables of keys: the properties of their objects, and the
// definitions of their values. All else stays.
UpdatedSchema update_schema(std::string_view schema);

}  // namespace tessera::core
