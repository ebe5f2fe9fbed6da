// SPDX-License-Identifier: Apache-2.0
// Reference counts of scene files: a file that is needed is not removed.
//
// A hold lasts as long as the object exists: jobs and scenes that are being validated have one. A claim
// belongs to a submission in progress and covers all its files, including those that are not uploaded yet. It
// lasts while a call of the submission is in progress (an upload, or the submission itself), and kClaimTime
// after the last one. The number of files in claims is bounded and shared between callers (fair_share.hpp).
// No I/O. Thread-safe.
#pragma once

#include <chrono>
#include <functional>
#include <list>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/mutex.hpp"
#include "proto/blob.hpp"
#include "server/base/fair_share.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::blobs {

class BlobClaims {
 public:
  using Time = std::chrono::steady_clock::time_point;
  static constexpr std::chrono::minutes kClaimTime{15};
  // The limit on the files in all claims together. A claim of fewer than kMinFiles files counts as kMinFiles.
  static constexpr std::uint64_t kMaxFiles = 1'000'000, kMinFiles = 16;

  explicit BlobClaims(std::function<Time()> now, std::uint64_t max_files = kMaxFiles)
      : now_(std::move(now)), places_(max_files) {}
  BlobClaims(const BlobClaims&) = delete;
  BlobClaims& operator=(const BlobClaims&) = delete;

  class Hold;
  class Use;
  // The Hold and Use objects must be destroyed before this object.
  Hold hold(std::vector<proto::Digest> files);
  // Registers a call of a submission that needs these files. Empty if the caller's share of claims is used
  // up.
  std::optional<Use> claim(const std::string& caller, std::vector<proto::Digest> files);
  // Registers a call, e.g. an upload, with all claims of the caller that need this file. If there is none,
  // adds a claim of this file alone.
  std::optional<Use> use(const std::string& caller, const proto::Digest& file);

  bool is_needed(const proto::Digest& file);
  // Calls `act` if nobody needs the file, and lets nobody claim it meanwhile. Returns whether it was called.
  // `act` must be short.
  bool unless_needed(const proto::Digest& file, const std::function<void()>& act);
  // The number of files that the caller has claimed.
  std::uint64_t claimed_by(const std::string& caller) const { return places_.held_by(caller); }

 private:
  struct Claim {
    std::string caller;
    std::vector<proto::Digest> files;  // sorted, without duplicates
    base::FairShare::Held place;
    int calls = 0;  // in progress
    Time quiet_since{};
  };
  using Claims = std::list<Claim>;
  struct Need {
    std::uint64_t holds = 0;
    std::vector<Claims::iterator> claims;
  };

  void let_go(const std::vector<proto::Digest>& files);
  void end_use(const std::vector<Claims::iterator>& claims, bool settled);
  std::optional<Claims::iterator> find_or_add(const std::string& caller, std::vector<proto::Digest> files)
      TESSERA_REQUIRES(mutex_);
  void begin_call(Claims::iterator claim) TESSERA_REQUIRES(mutex_);
  void forget(Claims& among, Claims::iterator claim) TESSERA_REQUIRES(mutex_);
  void drop_lapsed() TESSERA_REQUIRES(mutex_);

  const std::function<Time()> now_;
  base::FairShare places_;
  core::Mutex mutex_;
  std::map<proto::Digest, Need> needs_ TESSERA_GUARDED_BY(mutex_);  // without empty entries
  Claims in_use_ TESSERA_GUARDED_BY(mutex_);
  Claims quiet_ TESSERA_GUARDED_BY(mutex_);  // ordered by expiry
};

class BlobClaims::Hold {
 public:
  Hold() = default;
  Hold(Hold&& other) noexcept { *this = std::move(other); }
  Hold& operator=(Hold&& other) noexcept {
    std::swap(claims_, other.claims_);
    std::swap(files_, other.files_);
    return *this;
  }
  ~Hold() {
    if (claims_ != nullptr) claims_->let_go(files_);
  }

 private:
  friend class BlobClaims;
  BlobClaims* claims_ = nullptr;
  std::vector<proto::Digest> files_;
};

class BlobClaims::Use {
 public:
  Use(Use&& other) noexcept
      : owner_(std::exchange(other.owner_, nullptr)), claims_(std::move(other.claims_)) {}
  Use& operator=(Use&&) = delete;
  ~Use() { end(false); }

  // Ends the use, and with it the claims that no other call uses: the job now holds the files.
  void settle() { end(true); }

 private:
  friend class BlobClaims;
  Use(BlobClaims& owner, std::vector<Claims::iterator> claims) : owner_(&owner), claims_(std::move(claims)) {}
  void end(bool settled) {
    if (owner_ != nullptr) std::exchange(owner_, nullptr)->end_use(claims_, settled);
  }

  BlobClaims* owner_;  // null after the end
  std::vector<Claims::iterator> claims_;
};

// The files of a bundle that have digests.
std::vector<proto::Digest> files_of(const v1::Bundle& bundle);

}  // namespace tessera::blobs
