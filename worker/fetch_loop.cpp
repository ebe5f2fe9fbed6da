// SPDX-License-Identifier: Apache-2.0
#include "worker/fetch_loop.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <map>
#include <new>
#include <set>
#include <string>
#include <system_error>
#include <utility>

#include "core/common/log.hpp"
#include "proto/convert.hpp"
#include "worker/waiting.hpp"

namespace tessera::worker {

namespace {

void log_failure(const std::string& job_id, const std::string& why) {
  common::log(spdlog::level::err, fmt::format("job {}: {}", job_id, why), {.job = job_id});
}

// Each file counts once. The greatest number if the sum is even greater.
std::uint64_t total_bytes(const v1::Bundle& bundle) {
  std::set<std::string> counted;
  std::uint64_t total = 0;
  for (const v1::Bundle::Asset& asset : bundle.assets()) {
    if (!counted.insert(asset.digest().sha256()).second) continue;
    const std::uint64_t bytes = asset.digest().size_bytes();
    total = bytes > UINT64_MAX - total ? UINT64_MAX : total + bytes;
  }
  return total;
}

core::Status check_fits(const v1::Bundle& bundle, const BlobCache& cache) {
  const std::uint64_t bytes = total_bytes(bundle);
  if (bytes <= cache.max_bytes()) return {};
  constexpr double kGib = std::uint64_t{1} << 30;
  return core::fail(
      core::ErrorCode::kResourceExhausted,
      fmt::format("the scene's files have {:.4g} GiB, and the worker's cache may have {:.4g}: "
                  "--cache-gib sets its limit",
                  static_cast<double>(bytes) / kGib, static_cast<double>(cache.max_bytes()) / kGib));
}

}  // namespace

void FetchLoop::run(const std::stop_token& stop) {
  while (const auto spec = lease_tracker_.next_to_fetch(stop)) fetch_or_decline(*spec, stop);
}

void FetchLoop::fetch_or_decline(const v1::JobSpec& spec, const std::stop_token& stop) {
  if (const core::Status fits = check_fits(spec.bundle(), cache_); !fits) {
    log_failure(spec.job_id(), fits.error().message);
    return lease_tracker_.decline(spec.job_id(), fits.error().message);
  }
  auto job = fetch_or_run_out(spec, stop);
  if (job) return lease_tracker_.fetched(std::move(*job));
  if (stop.stop_requested()) return;
  log_failure(spec.job_id(), job.error().message);
  lease_tracker_.cannot_fetch(spec.job_id(), "cannot fetch " + job.error().message);
}

core::Result<std::shared_ptr<const Job>> FetchLoop::fetch_or_run_out(const v1::JobSpec& spec,
                                                                     const std::stop_token& stop) {
  try {
    return fetch(spec, stop);
  } catch (const std::bad_alloc&) {
    return core::fail(core::ErrorCode::kResourceExhausted, "the scene's files: not enough memory");
  } catch (const std::system_error& error) {  // a thread cannot be started, or a file used
    return core::fail(core::ErrorCode::kResourceExhausted,
                      fmt::format("the scene's files: {}", error.what()));
  }
}

core::Result<std::shared_ptr<const Job>> FetchLoop::fetch(const v1::JobSpec& spec,
                                                          const std::stop_token& stop) {
  const auto settings = proto::from_proto(spec.settings());
  if (!settings) return core::fail(settings.error());
  Job job{spec.job_id(), *settings, {bundle_key(spec.bundle()), spec.bundle().scene_path(), {}}};
  for (const v1::Image& image : spec.images()) job.frames.push_back(image.frame());
  const BlobCache::InUse in_use = files_in_use(spec.bundle());
  // A file may have several names; it is fetched and checked once.
  std::map<std::string, std::string> fetched;
  const int count = spec.bundle().assets_size();
  for (int i = 0; i < count; ++i) {
    const auto index = (start_ + static_cast<std::size_t>(i)) % static_cast<std::size_t>(count);
    const v1::Bundle::Asset& asset = spec.bundle().assets(static_cast<int>(index));
    const auto digest = proto::from_proto(asset.digest());
    if (!digest) return core::fail(digest.error().within(asset.path()));
    const auto [known, is_new] = fetched.try_emplace(asset.digest().SerializeAsString());
    if (is_new) {
      auto path = fetch_blob(*digest, in_use, stop);
      if (!path) return core::fail(path.error().within(asset.path()));
      known->second = std::move(*path);
    }
    job.files.blob_paths.emplace(asset.path(), known->second);
    job.files.digests.emplace(asset.path(), *digest);
  }
  return std::make_shared<const Job>(std::move(job));
}

BlobCache::InUse FetchLoop::files_in_use(const v1::Bundle& fetching) {
  BlobCache::InUse in_use;
  for (const auto& job : lease_tracker_.jobs_in_hand())
    for (const auto& [name, digest] : job->files.digests) in_use.insert(digest.hex());
  for (const v1::Bundle::Asset& asset : fetching.assets())
    if (const auto digest = proto::from_proto(asset.digest())) in_use.insert(digest->hex());
  return in_use;
}

core::Result<std::string> FetchLoop::fetch_blob(const proto::Digest& digest, const BlobCache::InUse& in_use,
                                                const std::stop_token& stop) {
  core::Result<std::string> path;
  const auto policy = proto::transient_only(proto::exponential_backoff());
  const core::Status done = proto::retry(policy, waiter_until(stop), [&]() -> core::Status {
    path = cache_.get(digest, in_use, source_, stop);
    return path ? core::Status{} : core::fail(path.error());
  });
  return done ? path : core::fail(done.error());
}

}  // namespace tessera::worker
