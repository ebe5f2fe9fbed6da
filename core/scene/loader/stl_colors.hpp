// SPDX-License-Identifier: Apache-2.0
// Colours of the facets of binary STL files, in their attribute bytes. There are two ways: Magics names a
// colour of the whole in the header, VisCAM and SolidView do not. Stateless; thread-safe.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/math/rgb.hpp"

namespace tessera::core {

struct StlColors {
  std::optional<Rgb> whole;  // as Magics writes it

  // The linear colour of a facet with these attribute bytes.
  Rgb of(std::uint16_t attributes) const;
};

// nullopt if the attribute bytes of the facets are no colours.
std::optional<StlColors> stl_colors(std::string_view header, std::span<const std::uint16_t> attributes);

}  // namespace tessera::core
