// SPDX-License-Identifier: Apache-2.0
// Which files of scenes somebody needs, and which must therefore stay.
//
// A hold lasts as long as it exists: jobs and scenes that are being validated have one. A claim is that of a
// submission on its way, on all its files, those that are still to come included: it lasts while a call of it
// is under way (an upload of one of the files, the submission itself), and kClaimTime after the last one. How
// many files callers claim is bounded, and shared (fair_share.hpp). No I/O. Thread-safe.
#pragma once

#include <chrono>
#include <functional>
#include <list>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "proto/blob.hpp"
#include "server/coordinator/fair_share.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::coordinator {

class BlobClaims {
 public:
  using Time = std::chrono::steady_clock::time_point;
  static constexpr std::chrono::minutes kClaimTime{15};
  // Files in all claims together. One of few files counts as if it had kMinFiles.
  static constexpr std::uint64_t kMaxFiles = 1'000'000, kMinFiles = 16;

  explicit BlobClaims(std::function<Time()> now) : now_(std::move(now)) {}
  BlobClaims(const BlobClaims&) = delete;
  BlobClaims& operator=(const BlobClaims&) = delete;

  class Hold;
  class Use;
  // Both answers must be gone before this is.
  Hold hold(std::vector<proto::Digest> files);
  // A call of a submission that needs these files. Nothing if the caller has claimed its share.
  std::optional<Use> claim(const std::string& caller, std::vector<proto::Digest> files);
  // A call, e.g. an upload, of all the caller's submissions that need this file; of one of its own if there
  // is none.
  std::optional<Use> use(const std::string& caller, const proto::Digest& file);

  bool is_needed(const proto::Digest& file);
  // Acts if nobody needs the file, and lets nobody need it meanwhile. Whether it did. `act` must be short.
  bool unless_needed(const proto::Digest& file, const std::function<void()>& act);
  // How many files the caller has claimed.
  std::uint64_t claimed_by(const std::string& caller) const { return places_.held_by(caller); }

 private:
  struct Claim {
    std::string caller;
    std::vector<proto::Digest> files;  // in order, each once
    FairShare::Held place;
    int calls = 0;  // under way
    Time quiet_since{};
  };
  using Claims = std::list<Claim>;
  struct Need {
    std::uint64_t holds = 0;
    std::vector<Claims::iterator> claims;
  };

  void let_go(const std::vector<proto::Digest>& files);
  void end_use(const std::vector<Claims::iterator>& claims, bool settled);
  // ---- Under the lock ----
  std::optional<Claims::iterator> find_or_add(const std::string& caller, std::vector<proto::Digest> files);
  void begin_call(Claims::iterator claim);
  void forget(Claims& among, Claims::iterator claim);
  void drop_lapsed();

  const std::function<Time()> now_;
  FairShare places_{kMaxFiles};
  std::mutex mutex_;
  std::map<proto::Digest, Need> needs_;  // guarded by mutex_; none that is empty
  Claims in_use_, quiet_;                // guarded by mutex_; quiet_ in the order in which they lapse
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

  // Ends it, and with it the claims that nobody else uses: a job needs the files now.
  void settle() { end(true); }

 private:
  friend class BlobClaims;
  Use(BlobClaims& owner, std::vector<Claims::iterator> claims) : owner_(&owner), claims_(std::move(claims)) {}
  void end(bool settled) {
    if (owner_ != nullptr) std::exchange(owner_, nullptr)->end_use(claims_, settled);
  }

  BlobClaims* owner_;  // null once it has ended
  std::vector<Claims::iterator> claims_;
};

// The files of a bundle that have digests.
std::vector<proto::Digest> files_of(const v1::Bundle& bundle);

}  // namespace tessera::coordinator
