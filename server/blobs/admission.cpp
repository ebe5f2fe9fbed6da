// SPDX-License-Identifier: Apache-2.0
#include "server/blobs/admission.hpp"

#include <fmt/format.h>

#include <limits>
#include <set>
#include <string>
#include <utility>

namespace tessera::blobs {

namespace {

constexpr const char* kWhatMakesRoom =
    ": delete jobs that nobody needs any more (tessera delete); files that were uploaded and not submitted "
    "make room after a quarter of an hour";

// The sizes come from a message and may have any value.
std::uint64_t add_capped(std::uint64_t a, std::uint64_t b) {
  return b > std::numeric_limits<std::uint64_t>::max() - a ? std::numeric_limits<std::uint64_t>::max()
                                                           : a + b;
}

std::string in_mib(std::uint64_t mib) {
  return fmt::format("{} MiB", mib);
}

}  // namespace

core::Status check_blob_size(std::uint64_t size_bytes, const server::Limits& limits) {
  if (size_bytes <= limits.blob_bytes()) return {};
  return core::fail(server::over_limit(fmt::format("the file has {} bytes", size_bytes),
                                       in_mib(limits.blob_mib), "--max-blob-mib"));
}

core::Status check_bundle_size(const v1::Bundle& bundle, const server::Limits& limits) {
  if (static_cast<std::uint64_t>(bundle.assets_size()) > limits.bundle_files)
    return core::fail(server::over_limit(fmt::format("the bundle has {} files", bundle.assets_size()),
                                         std::to_string(limits.bundle_files), "--max-bundle-files"));
  std::uint64_t total = 0;
  std::set<std::pair<std::string, std::uint64_t>> counted;
  for (const v1::Bundle::Asset& asset : bundle.assets()) {
    const std::uint64_t size = asset.digest().size_bytes();
    if (auto fits = check_blob_size(size, limits); !fits)
      return core::fail(fits.error().within("bundle: " + asset.path()));
    if (counted.emplace(asset.digest().sha256(), size).second) total = add_capped(total, size);
  }
  if (total <= limits.bundle_bytes()) return {};
  return core::fail(
      server::over_limit(fmt::format("the {} files of the bundle have {} bytes", bundle.assets_size(), total),
                         in_mib(limits.bundle_mib), "--max-bundle-mib"));
}

core::Status check_store_size(std::uint64_t used_bytes, std::uint64_t more_bytes,
                              const server::Limits& limits) {
  if (add_capped(used_bytes, more_bytes) <= limits.store_bytes()) return {};
  core::Error error =
      server::over_quota(fmt::format("the files of scenes here have {} bytes, {} more would be too many",
                                     used_bytes, more_bytes),
                         in_mib(limits.store_mib), "--max-store-mib");
  error.message += kWhatMakesRoom;
  return core::fail(std::move(error));
}

core::Error over_store_share(std::uint64_t own_bytes, std::uint64_t more_bytes,
                             const server::Limits& limits) {
  core::Error error = server::over_quota(
      fmt::format("the files of scenes from here have {} bytes, {} more would be more than their share",
                  own_bytes, more_bytes),
      in_mib(limits.store_mib) + " from all callers", "--max-store-mib");
  error.message += fmt::format(", some of which it keeps for others{}", kWhatMakesRoom);
  return error;
}

}  // namespace tessera::blobs
