// SPDX-License-Identifier: Apache-2.0
// The steps of a <transform>. Stateless; thread-safe.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/math/transform.hpp"

namespace tessera::core::mitsuba {

// The attributes of an element, with parameters substituted.
class Attributes {
 public:
  void add(std::string_view name, std::string value) { list_.emplace_back(name, std::move(value)); }
  // Null if there is none of this name. Valid while this object is not changed.
  const std::string* find(std::string_view name) const;
  // Empty if there is none.
  std::string_view text(std::string_view name) const;

 private:
  std::vector<std::pair<std::string, std::string>> list_;
};

// The step of a <translate>, <rotate>, <scale>, <lookat> or <matrix>, to be applied after the steps before
// it. nullopt if the tag or a value is wrong, or the step is singular, as a lookat along its up vector. The
// last row of a matrix has no effect.
std::optional<Transform> read_step(std::string_view tag, const Attributes& attributes);

// Maps the +z axis to the direction from `origin` to `target`, +y to the one next to `up`, and +x to the left
// of that view. nullopt if there is no such direction.
std::optional<Transform> look_at(Vec3 origin, Vec3 target, Vec3 up);

}  // namespace tessera::core::mitsuba
