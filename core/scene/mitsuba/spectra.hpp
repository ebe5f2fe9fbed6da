// SPDX-License-Identifier: Apache-2.0
// Spectra as the colours that the RGB variants of Mitsuba make of them, which differ for light and for
// factors of light; and those that are plugins: <spectrum type="regular">, "irregular" and "blackbody".
// Stateless.
#pragma once

#include <optional>

#include "core/scene/mitsuba/plugin.hpp"

namespace tessera::core::mitsuba {

// The colour of samples: of light, without an illuminant; of a factor, under D65. Channels are not negative.
Rgb sampled_color(const Samples& samples, bool of_light);
// The colour of light of equal power at all wavelengths, which is redder than the white of Rec. 709.
Rgb uniform_light(double power);

bool is_spectrum_type(std::string_view type);

// The samples of a plugin of such a type; nullopt after a warning if it has none.
std::optional<Samples> samples_of(const Plugin& plugin);

}  // namespace tessera::core::mitsuba
