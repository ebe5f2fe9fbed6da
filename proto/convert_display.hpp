// SPDX-License-Identifier: Apache-2.0
// Conversions between the messages that say how PNG files show an image and core's types.
#pragma once

#include "core/base/error.hpp"
#include "core/image/display.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::proto {

v1::ToneCurve to_proto(core::ToneCurve curve);
// INVALID_ARGUMENT for UNSPECIFIED.
core::Result<core::ToneCurve> from_proto(v1::ToneCurve curve);

v1::DisplaySettings to_proto(const core::DisplaySettings& settings);
// INVALID_ARGUMENT outside the limits of core/image/display.hpp. An empty message gives the defaults.
core::Result<core::DisplaySettings> from_proto(const v1::DisplaySettings& message);

v1::DisplayOverrides to_proto(const core::DisplayOverrides& overrides);
// Checks only that the values are representable. core::resolve_display checks the limits.
core::Result<core::DisplayOverrides> from_proto(const v1::DisplayOverrides& message);

// Applies the overrides to the settings, and checks the result.
core::Result<core::DisplaySettings> resolve_display(const v1::DisplaySettings& settings,
                                                    const v1::DisplayOverrides& overrides);

}  // namespace tessera::proto
