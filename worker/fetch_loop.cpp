#include "worker/fetch_loop.hpp"

#include <spdlog/spdlog.h>

#include <map>
#include <string>
#include <utility>

#include "proto/convert.hpp"
#include "worker/waiting.hpp"

namespace tessera::worker {

void FetchLoop::run(const std::stop_token& stop) {
  while (const auto spec = holdings_.next_to_fetch(stop)) {
    auto job = fetch(*spec, stop);
    if (job) {
      holdings_.fetched(std::move(*job));
    } else if (!stop.stop_requested()) {
      spdlog::error("job {}: {}", spec->job_id(), job.error().message);
      holdings_.cannot_fetch(spec->job_id());
    }
  }
}

core::Result<std::shared_ptr<const Job>> FetchLoop::fetch(const v1::JobSpec& spec,
                                                          const std::stop_token& stop) {
  const auto settings = proto::from_proto(spec.settings());
  if (!settings) return core::fail(settings.error());
  Job job{spec.job_id(), *settings, {bundle_key(spec.bundle()), spec.bundle().scene_path(), {}}};
  std::map<std::string, std::string> fetched;  // paths of files, by digest: many names may have one blob
  for (const v1::Bundle::Asset& asset : spec.bundle().assets()) {
    std::string& here = fetched[asset.digest().SerializeAsString()];
    if (here.empty()) {
      auto path = fetch_blob(asset.digest(), stop);
      if (!path) return core::fail(path.error().within(asset.path()));
      here = std::move(*path);
    }
    job.files.blob_paths.emplace(asset.path(), here);
  }
  return std::make_shared<const Job>(std::move(job));
}

core::Result<std::string> FetchLoop::fetch_blob(const v1::Digest& message, const std::stop_token& stop) {
  const auto digest = proto::from_proto(message);
  if (!digest) return core::fail(digest.error());
  core::Result<std::string> path;
  const auto policy = proto::transient_only(proto::exponential_backoff());
  const core::Status done = proto::retry(policy, waiter_until(stop), [&]() -> core::Status {
    path = cache_.get(*digest, coordinator_, stop);
    return path ? core::Status{} : core::fail(path.error());
  });
  return done ? path : core::fail(done.error());
}

}  // namespace tessera::worker
