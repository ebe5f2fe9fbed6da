// SPDX-License-Identifier: Apache-2.0
// Spectra that are plugins: <spectrum type="regular">, "irregular" and "blackbody", as samples. Stateless.
#pragma once

#include <optional>

#include "core/scene/mitsuba/plugin.hpp"

namespace tessera::core::mitsuba {

bool is_spectrum_type(std::string_view type);

// The samples of a plugin of such a type; nullopt after a warning if it has none.
std::optional<Samples> samples_of(const Plugin& plugin);

}  // namespace tessera::core::mitsuba
