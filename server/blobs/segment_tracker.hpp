// SPDX-License-Identifier: Apache-2.0
// Chooses where workers get segments of blobs from, so that the coordinator sends each of them about once,
// however many workers need it.
//
// A worker asks for one segment at a time and says which it has. The coordinator sends a segment that nobody
// has or is being sent; everybody else gets it from a worker that has it, and is asked to wait while there is
// none. A worker is never kept waiting for longer than kPatience: then the coordinator sends. The SHA-256 of
// a segment is known once it was sent, and workers check with it what they get from each other.
//
// What is remembered is a hint, lost with a restart and bounded: whoever asks says what it has. Thread-safe.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <list>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/base/mutex.hpp"
#include "proto/blob.hpp"
#include "proto/segments.hpp"

namespace tessera::blobs {

class SegmentTracker {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Sha256 = std::array<std::uint8_t, 32>;

  // What is remembered at most; what was not used for longest is forgotten first.
  struct Bounds {
    std::size_t blobs = 1 << 16, segments = 1 << 18, workers = 1 << 14;
    std::size_t holders_of_a_blob = 32;
  };
  // Segments of one blob that are sent at a time to workers that serve others.
  static constexpr unsigned kMaxSends = 2;
  // Segments that one worker is asked to send at a time.
  static constexpr std::size_t kMaxUploads = 4;
  static constexpr std::chrono::seconds kPatience{10};
  static constexpr std::chrono::milliseconds kAskAgainAfter{200};
  // Workers that have not asked for so long are named to nobody.
  static constexpr std::chrono::minutes kForgetAfter{15};

  // Where a worker serves others.
  struct Endpoint {
    std::string address;  // HOST:PORT
    std::string certificate_pem, ticket_key;
    std::uint64_t clock_seconds = 0;  // of its clock, at `heard_at`
    Time heard_at{};
  };
  struct Ask {
    std::string worker_id;
    std::optional<Endpoint> endpoint;
    bool is_on_loopback = false;  // it calls from this machine; only such workers can reach others here
    proto::Digest blob;
    proto::SegmentSet held;
    std::set<std::string> excluded;  // workers that it does not want
  };

  // The coordinator sends this segment. Tell it when all of it is sent; otherwise it is available again when
  // this is destroyed. The tracker must outlive it.
  class Sending {
   public:
    Sending(SegmentTracker& tracker, proto::Digest blob, std::uint64_t index, std::string worker_id,
            bool serves)
        : tracker_(&tracker), blob_(blob), index_(index), worker_id_(std::move(worker_id)), serves_(serves) {}
    Sending(Sending&& other) noexcept
        : tracker_(std::exchange(other.tracker_, nullptr)),
          blob_(other.blob_),
          index_(other.index_),
          worker_id_(std::move(other.worker_id_)),
          serves_(other.serves_) {}
    Sending& operator=(Sending&&) = delete;
    ~Sending() { end(std::nullopt); }

    std::uint64_t index() const { return index_; }
    void complete(const Sha256& sha256) { end(sha256); }

   private:
    friend class SegmentTracker;
    void end(const std::optional<Sha256>& sha256);

    SegmentTracker* tracker_;  // null once it has ended
    proto::Digest blob_;
    std::uint64_t index_;
    std::string worker_id_;
    bool serves_;
  };
  struct Peer {
    std::uint64_t index;
    std::string worker_id;
    Endpoint endpoint;
    Sha256 sha256;
  };
  struct Later {
    std::chrono::milliseconds time;
  };
  using Source = std::variant<Sending, Peer, Later>;

  SegmentTracker() : SegmentTracker(Bounds{}) {}
  explicit SegmentTracker(Bounds bounds) : bounds_(bounds) {}

  // `ask.held` must lack a segment.
  Source choose(const Ask& ask, Time now);
  // The blob is damaged: what is known of it may be wrong.
  void forget(const proto::Digest& blob);

 private:
  struct Segment {
    std::optional<Sha256> sha256;
    unsigned sends = 0;  // in progress, to workers that serve others
    Time sending_since{};
  };
  struct Blob {
    std::vector<Segment> segments;
    std::map<std::string, proto::SegmentSet> holders;  // by worker id
    unsigned sends = 0;
    std::list<proto::Digest>::iterator recency;
  };
  // What a worker was told to fetch from another.
  struct Download {
    proto::Digest blob;
    std::uint64_t index;
    std::string from;
  };
  struct Worker {
    std::optional<Endpoint> endpoint;
    bool is_on_loopback = false;
    Time last_heard{};
    std::optional<Time> waiting_since;
    std::optional<Download> download;
    std::map<std::string, Time> uploads;  // by the worker that was told to fetch here
  };
  using Holders = std::vector<std::pair<const std::string*, const proto::SegmentSet*>>;

  Worker& note_worker(const Ask& ask, Time now) TESSERA_REQUIRES(mutex_);
  void end_download(const Ask& ask, Worker& worker) TESSERA_REQUIRES(mutex_);
  Blob& note_blob(const Ask& ask) TESSERA_REQUIRES(mutex_);
  void note_holder(Blob& blob, const std::string& worker_id, const proto::SegmentSet& held)
      TESSERA_REQUIRES(mutex_);
  void forget_blob(const proto::Digest& blob) TESSERA_REQUIRES(mutex_);
  void forget_workers(Time now) TESSERA_REQUIRES(mutex_);
  Holders reachable_holders(const Blob& blob, const Ask& ask) const TESSERA_REQUIRES(mutex_);
  std::optional<std::uint64_t> next_to_send(const Blob& blob, const Ask& ask, const Holders& holders,
                                            Time now) const TESSERA_REQUIRES(mutex_);
  std::optional<Peer> choose_peer(const Blob& blob, const Ask& ask, const Holders& holders, Time now)
      TESSERA_REQUIRES(mutex_);
  std::size_t uploads_of(const std::string& worker_id, Time now) TESSERA_REQUIRES(mutex_);
  Sending send(Blob& blob, const Ask& ask, std::uint64_t index, Time now) TESSERA_REQUIRES(mutex_);
  void end(const Sending& sending, const std::optional<Sha256>& sha256);

  const Bounds bounds_;
  core::Mutex mutex_;
  std::map<proto::Digest, Blob> blobs_ TESSERA_GUARDED_BY(mutex_);
  std::list<proto::Digest> recency_ TESSERA_GUARDED_BY(mutex_);  // of blobs_, latest first
  std::size_t segments_ TESSERA_GUARDED_BY(mutex_) = 0;          // of all blobs_
  std::map<std::string, Worker> workers_ TESSERA_GUARDED_BY(mutex_);
  Time last_forgotten_ TESSERA_GUARDED_BY(mutex_){};
};

}  // namespace tessera::blobs
