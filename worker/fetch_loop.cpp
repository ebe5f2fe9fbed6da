// SPDX-License-Identifier: Apache-2.0
#include "worker/fetch_loop.hpp"

#include <fmt/format.h>

#include <map>
#include <new>
#include <string>
#include <utility>

#include "core/common/log.hpp"
#include "proto/convert.hpp"
#include "worker/waiting.hpp"

namespace tessera::worker {

void FetchLoop::run(const std::stop_token& stop) {
  while (const auto spec = lease_tracker_.next_to_fetch(stop)) {
    auto job = fetch_or_run_out(*spec, stop);
    if (job) {
      lease_tracker_.fetched(std::move(*job));
    } else if (!stop.stop_requested()) {
      common::log(spdlog::level::err, fmt::format("job {}: {}", spec->job_id(), job.error().message),
                  {.job = spec->job_id()});
      lease_tracker_.cannot_fetch(spec->job_id(), "cannot fetch " + job.error().message);
    }
  }
}

core::Result<std::shared_ptr<const Job>> FetchLoop::fetch_or_run_out(const v1::JobSpec& spec,
                                                                     const std::stop_token& stop) {
  try {
    return fetch(spec, stop);
  } catch (const std::bad_alloc&) {
    return core::fail(core::ErrorCode::kResourceExhausted, "the scene's files: not enough memory");
  }
}

core::Result<std::shared_ptr<const Job>> FetchLoop::fetch(const v1::JobSpec& spec,
                                                          const std::stop_token& stop) {
  const auto settings = proto::from_proto(spec.settings());
  if (!settings) return core::fail(settings.error());
  Job job{spec.job_id(), *settings, {bundle_key(spec.bundle()), spec.bundle().scene_path(), {}}};
  // A file may have several names; it is fetched and checked once.
  std::map<std::string, std::string> fetched;
  for (const v1::Bundle::Asset& asset : spec.bundle().assets()) {
    const auto digest = proto::from_proto(asset.digest());
    if (!digest) return core::fail(digest.error().within(asset.path()));
    const auto [known, is_new] = fetched.try_emplace(asset.digest().SerializeAsString());
    if (is_new) {
      auto path = fetch_blob(*digest, stop);
      if (!path) return core::fail(path.error().within(asset.path()));
      known->second = std::move(*path);
    }
    job.files.blob_paths.emplace(asset.path(), known->second);
    job.files.digests.emplace(asset.path(), *digest);
  }
  return std::make_shared<const Job>(std::move(job));
}

core::Result<std::string> FetchLoop::fetch_blob(const proto::Digest& digest, const std::stop_token& stop) {
  core::Result<std::string> path;
  const auto policy = proto::transient_only(proto::exponential_backoff());
  const core::Status done = proto::retry(policy, waiter_until(stop), [&]() -> core::Status {
    path = cache_.get(digest, coordinator_, stop);
    return path ? core::Status{} : core::fail(path.error());
  });
  return done ? path : core::fail(done.error());
}

}  // namespace tessera::worker
