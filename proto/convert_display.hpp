// SPDX-License-Identifier: Apache-2.0
// Between the messages that say how PNG files show a picture and core's types.
#pragma once

#include "core/base/error.hpp"
#include "core/image/display.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::proto {

v1::ToneCurve to_proto(core::ToneCurve curve);
// Not for UNSPECIFIED: that is an error here. INVALID_ARGUMENT.
core::Result<core::ToneCurve> from_proto(v1::ToneCurve curve);

v1::DisplaySettings to_proto(const core::DisplaySettings& settings);
// Within the limits of core/image/display.hpp, else INVALID_ARGUMENT. An empty message shows light as it is.
core::Result<core::DisplaySettings> from_proto(const v1::DisplaySettings& message);

v1::DisplayOverrides to_proto(const core::DisplayOverrides& overrides);
// Only representable, not within limits: core::resolve_display checks those.
core::Result<core::DisplayOverrides> from_proto(const v1::DisplayOverrides& message);

// What the messages come to together, checked.
core::Result<core::DisplaySettings> resolve_display(const v1::DisplaySettings& settings,
                                                    const v1::DisplayOverrides& overrides);

}  // namespace tessera::proto
