// SPDX-License-Identifier: Apache-2.0
// What a kernel, a container or a build lacks of the sandbox.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.hpp"

namespace tessera::sandbox {

// Why a part of the sandbox is missing, as a sentence without capital and full stop; empty if it is there.
using Missing = std::optional<std::string>;

// The error for a failed call, from errno: INTERNAL.
core::Error system_error(std::string_view call);

// For a part whose call has just failed: what is missing if that is for want of support or permission, and an
// error otherwise. `part` is what there is none of.
core::Result<Missing> missing_or_error(std::string_view part, std::string_view call);

}  // namespace tessera::sandbox
