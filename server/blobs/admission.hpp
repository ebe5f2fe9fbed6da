// SPDX-License-Identifier: Apache-2.0
// Admission control: checks the sizes of files against the limits of bundles and of the store. Stateless;
// thread-safe. Errors are RESOURCE_EXHAUSTED and name the option that raises the limit.
#pragma once

#include <cstdint>

#include "core/base/error.hpp"
#include "server/limits.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::blobs {

// Checks the sizes that the bundle declares, before any of its files is read. A file counts as often as it is
// named.
core::Status check_bundle_size(const v1::Bundle& bundle, const server::Limits& limits);
core::Status check_blob_size(std::uint64_t size_bytes, const server::Limits& limits);
// Whether a store that holds `used_bytes` has room for `more_bytes`. The caller decides what counts as used.
core::Status check_store_size(std::uint64_t used_bytes, std::uint64_t more_bytes,
                              const server::Limits& limits);

// The error for a file that fits into the store, but not into the share of its caller, who uses `own_bytes`.
core::Error over_store_share(std::uint64_t own_bytes, std::uint64_t more_bytes, const server::Limits& limits);

}  // namespace tessera::blobs
