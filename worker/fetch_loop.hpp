// SPDX-License-Identifier: Apache-2.0
// Fetches the files of leased jobs into the cache before they are rendered. Runs on one thread.
#pragma once

#include <cstddef>
#include <memory>
#include <stop_token>

#include "core/base/error.hpp"
#include "tessera/v1/worker_service.grpc.pb.h"
#include "worker/blob_cache.hpp"
#include "worker/lease_tracker.hpp"

namespace tessera::worker {

class FetchLoop {
 public:
  // All three must outlive it. Each job's files are fetched in the order of its bundle, beginning with file
  // `start` modulo their number: workers that begin at different ones soon have what the others lack.
  FetchLoop(const BlobCache& cache, BlobSource& source, LeaseTracker& lease_tracker, std::size_t start = 0)
      : cache_(cache), source_(source), lease_tracker_(lease_tracker), start_(start) {}

  // Returns after a stop. Temporary errors are retried. A job whose files cannot be fetched is logged, and
  // its leases are given back. A job whose files are larger than the cache is declined.
  void run(const std::stop_token& stop);

 private:
  void fetch_or_decline(const v1::JobSpec& spec, const std::stop_token& stop);
  core::Result<std::shared_ptr<const Job>> fetch(const v1::JobSpec& spec, const std::stop_token& stop);
  // The same, with lack of memory as an error.
  core::Result<std::shared_ptr<const Job>> fetch_or_run_out(const v1::JobSpec& spec,
                                                            const std::stop_token& stop);
  BlobCache::InUse files_in_use(const v1::Bundle& fetching);
  core::Result<std::string> fetch_blob(const proto::Digest& digest, const BlobCache::InUse& in_use,
                                       const std::stop_token& stop);

  const BlobCache& cache_;
  BlobSource& source_;
  LeaseTracker& lease_tracker_;
  const std::size_t start_;
};

}  // namespace tessera::worker
