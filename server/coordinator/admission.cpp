// SPDX-License-Identifier: Apache-2.0
#include "server/coordinator/admission.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include "proto/convert.hpp"
#include "server/coordinator/quota_reservation.hpp"
#include "server/coordinator/state_lock.hpp"

namespace tessera::coordinator {

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
      server::over_limit(fmt::format("the files of scenes here have {} bytes, {} more would be too many",
                                     used_bytes, more_bytes),
                         in_mib(limits.store_mib), "--max-store-mib");
  error.message += kWhatMakesRoom;
  return core::fail(std::move(error));
}

core::Error over_store_share(std::uint64_t own_bytes, std::uint64_t more_bytes,
                             const server::Limits& limits) {
  core::Error error = server::over_limit(
      fmt::format("the files of scenes from here have {} bytes, {} more would be more than their share",
                  own_bytes, more_bytes),
      in_mib(limits.store_mib) + " from all callers", "--max-store-mib");
  error.message += fmt::format(", some of which it keeps for others{}", kWhatMakesRoom);
  return error;
}

core::Status check_picture_size(const v1::RenderSettings& settings, const server::Limits& limits) {
  const core::PixelRect window = proto::window_of(settings);
  if (window.pixel_count() <= limits.picture_pixels) return {};
  return core::fail(server::over_limit(
      fmt::format("the image has {} x {} = {} pixels", window.width(), window.height(), window.pixel_count()),
      std::to_string(limits.picture_pixels), "--max-picture-pixels"));
}

core::Status check_spp(std::uint32_t spp, const server::Limits& limits) {
  if (spp <= limits.spp) return {};
  return core::fail(server::over_limit(fmt::format("the job has {} samples per pixel", spp),
                                       std::to_string(limits.spp), "--max-spp"));
}

Coordinator::QuotaReservation::~QuotaReservation() {
  if (coordinator_ == nullptr) return;
  const StateLock lock(*coordinator_);
  const auto place = coordinator_->places_.find(submitter_);
  if (--place->second == 0) coordinator_->places_.erase(place);
}

core::Result<Coordinator::QuotaReservation> Coordinator::reserve_quota(const std::string& submitter) {
  const StateLock lock(*this);
  if (auto may = may_open_job(lock, submitter); !may) return core::fail(may.error());
  return QuotaReservation(*this, submitter);
}

core::Status Coordinator::may_open_job(const StateLock& lock, const std::string& submitter) const {
  const auto places = places_.find(submitter);
  std::uint64_t open = places == places_.end() ? 0 : places->second;
  for (const auto& [id, record] : jobs_) {
    if (record.finished_ms || record.spec->submitter() != submitter) continue;
    const auto view = scheduler_.job({id}, lock.now());
    if (view && !is_finished(view->state)) ++open;
  }
  if (open < options_.limits.open_jobs) return {};
  const std::string whose = submitter.empty() ? "there are" : fmt::format("'{}' has", submitter);
  return core::fail(
      server::over_limit(fmt::format("{} {} unfinished jobs already", whose, open),
                         fmt::format("{} {}", options_.limits.open_jobs,
                                     submitter.empty() ? "of all together" : "of each submitter"),
                         "--max-open-jobs"));
}

}  // namespace tessera::coordinator
