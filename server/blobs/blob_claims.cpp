// SPDX-License-Identifier: Apache-2.0
#include "server/blobs/blob_claims.hpp"

#include <algorithm>

namespace tessera::blobs {

namespace {

std::vector<proto::Digest> each_once(std::vector<proto::Digest> files) {
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  return files;
}

}  // namespace

BlobClaims::Hold BlobClaims::hold(std::vector<proto::Digest> files) {
  Hold hold;
  hold.files_ = each_once(std::move(files));
  const core::MutexLock lock(mutex_);
  for (const proto::Digest& file : hold.files_) ++needs_[file].holds;
  hold.claims_ = this;
  return hold;
}

void BlobClaims::let_go(const std::vector<proto::Digest>& files) {
  const core::MutexLock lock(mutex_);
  for (const proto::Digest& file : files) {
    const auto need = needs_.find(file);
    if (--need->second.holds == 0 && need->second.claims.empty()) needs_.erase(need);
  }
}

std::optional<BlobClaims::Use> BlobClaims::claim(const std::string& caller,
                                                 std::vector<proto::Digest> files) {
  files = each_once(std::move(files));
  const core::MutexLock lock(mutex_);
  drop_lapsed();
  if (files.empty()) return Use(*this, {});
  const auto claim = find_or_add(caller, std::move(files));
  if (!claim) return std::nullopt;
  begin_call(*claim);
  return Use(*this, {*claim});
}

std::optional<BlobClaims::Use> BlobClaims::use(const std::string& caller, const proto::Digest& file) {
  {
    const core::MutexLock lock(mutex_);
    drop_lapsed();
    std::vector<Claims::iterator> claims;
    if (const auto need = needs_.find(file); need != needs_.end()) claims = need->second.claims;
    std::erase_if(claims, [&](const Claims::iterator& claim) { return claim->caller != caller; });
    for (const Claims::iterator& claim : claims) begin_call(claim);
    if (!claims.empty()) return Use(*this, std::move(claims));
  }
  return claim(caller, {file});
}

bool BlobClaims::is_needed(const proto::Digest& file) {
  return !unless_needed(file, [] {});
}

bool BlobClaims::unless_needed(const proto::Digest& file, const std::function<void()>& act) {
  const core::MutexLock lock(mutex_);
  drop_lapsed();
  if (needs_.contains(file)) return false;
  act();
  return true;
}

void BlobClaims::end_use(const std::vector<Claims::iterator>& claims, bool settled) {
  const core::MutexLock lock(mutex_);
  for (const Claims::iterator& claim : claims) {
    if (--claim->calls > 0) continue;
    if (settled) {
      forget(in_use_, claim);
    } else {
      claim->quiet_since = now_();
      quiet_.splice(quiet_.end(), in_use_, claim);
    }
  }
}

std::optional<BlobClaims::Claims::iterator> BlobClaims::find_or_add(const std::string& caller,
                                                                    std::vector<proto::Digest> files) {
  if (const auto need = needs_.find(files.front()); need != needs_.end()) {
    for (const Claims::iterator& claim : need->second.claims) {
      if (claim->caller == caller && claim->files == files) return claim;
    }
  }
  auto place = places_.take(caller, std::max<std::uint64_t>(files.size(), kMinFiles));
  if (!place) return std::nullopt;
  const auto claim =
      quiet_.insert(quiet_.end(), Claim{caller, std::move(files), *std::move(place), 0, now_()});
  for (const proto::Digest& file : claim->files) needs_[file].claims.push_back(claim);
  return claim;
}

void BlobClaims::begin_call(Claims::iterator claim) {
  if (claim->calls++ == 0) in_use_.splice(in_use_.end(), quiet_, claim);
}

void BlobClaims::forget(Claims& among, Claims::iterator claim) {
  for (const proto::Digest& file : claim->files) {
    const auto need = needs_.find(file);
    std::erase(need->second.claims, claim);
    if (need->second.holds == 0 && need->second.claims.empty()) needs_.erase(need);
  }
  among.erase(claim);
}

void BlobClaims::drop_lapsed() {
  const Time now = now_();
  while (!quiet_.empty() && quiet_.front().quiet_since + kClaimTime <= now) forget(quiet_, quiet_.begin());
}

std::vector<proto::Digest> files_of(const v1::Bundle& bundle) {
  std::vector<proto::Digest> files;
  files.reserve(static_cast<std::size_t>(bundle.assets_size()));
  for (const v1::Bundle::Asset& asset : bundle.assets()) {
    if (const auto digest = proto::from_proto(asset.digest())) files.push_back(*digest);
  }
  return files;
}

}  // namespace tessera::blobs
