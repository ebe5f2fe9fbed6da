// SPDX-License-Identifier: Apache-2.0
// Interrupted uploads, kept for a while so that their callers can continue them. Each keeps its room in the
// store, under the quota of its caller. Callers share the number of places (fair_share.hpp). Thread-safe.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <list>
#include <optional>
#include <string>

#include "core/base/mutex.hpp"
#include "server/base/fair_share.hpp"
#include "server/blobs/blob_store.hpp"

namespace tessera::blobs {

class PartialUploads {
 public:
  using Time = std::chrono::steady_clock::time_point;
  static constexpr std::chrono::minutes kKeepTime{15};
  // Each has an open file.
  static constexpr std::uint64_t kMaxUploads = 256;
  // Less is sent again as fast.
  static constexpr std::uint64_t kMinBytes = 64 << 10;

  explicit PartialUploads(std::function<Time()> now) : now_(std::move(now)) {}

  // Keeps what was received of an upload, if it can be continued and there is a place; else it is removed. It
  // replaces an earlier one of the same blob.
  void keep(const std::string& caller, BlobWriter writer);
  // The bytes that are kept of a blob; 0 if there are none.
  std::uint64_t size_bytes(const std::string& caller, const proto::Digest& digest);
  // Takes the upload of a blob to continue it. Empty if there is none.
  std::optional<BlobWriter> take(const std::string& caller, const proto::Digest& digest);
  // The room in the store that they take together.
  std::uint64_t room_bytes();
  // Removes those that were not continued in time.
  void collect();
  // Removes the oldest one to make room. Returns false if there is none.
  bool remove_oldest();

 private:
  struct Upload {
    std::string caller;
    BlobWriter writer;
    base::FairShare::Held place;
    Time interrupted_at;
  };
  using Uploads = std::list<Upload>;
  Uploads::iterator find(const std::string& caller, const proto::Digest& digest) TESSERA_REQUIRES(mutex_);

  const std::function<Time()> now_;
  base::FairShare places_{kMaxUploads};
  core::Mutex mutex_;
  Uploads uploads_ TESSERA_GUARDED_BY(mutex_);  // oldest first
};

}  // namespace tessera::blobs
