// SPDX-License-Identifier: Apache-2.0
// Whether a farm takes what it is asked for: the limits of jobs, bundles and the store. Stateless;
// thread-safe. Errors are RESOURCE_EXHAUSTED and name the option that raises the limit.
#pragma once

#include <cstdint>

#include "core/base/error.hpp"
#include "server/limits.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::coordinator {

// By the sizes that the bundle itself says, before any of its files is looked at. A file counts as often as
// it is named.
core::Status check_bundle_size(const v1::Bundle& bundle, const server::Limits& limits);
core::Status check_blob_size(std::uint64_t size_bytes, const server::Limits& limits);
// Whether a store of `used_bytes` has room for so many more. What this counts is for the caller.
core::Status check_store_size(std::uint64_t used_bytes, std::uint64_t more_bytes,
                              const server::Limits& limits);

// What to refuse a file with that would fit, but not into the share of its caller, who has so much.
core::Error over_store_share(std::uint64_t own_bytes, std::uint64_t more_bytes, const server::Limits& limits);

// Of the window that is rendered, not of the picture that it is from.
core::Status check_picture_size(const v1::RenderSettings& settings, const server::Limits& limits);
core::Status check_spp(std::uint32_t spp, const server::Limits& limits);

}  // namespace tessera::coordinator
