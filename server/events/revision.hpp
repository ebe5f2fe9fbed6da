// SPDX-License-Identifier: Apache-2.0
// The numbers of changes. Every change of a job, a worker or a tile has a revision of its own, greater than
// all before it, also across restarts of the coordinator. Thread-safe.
#pragma once

#include <atomic>
#include <cstdint>

namespace tessera::events {

using Revision = std::uint64_t;

class RevisionCounter {
 public:
  // `epoch`: how often the state was opened; at most 24 bits.
  explicit RevisionCounter(std::uint32_t epoch) : last_(first_of(epoch)) {}

  Revision next() { return ++last_; }
  // That of the last change; nothing has changed while it stays the same.
  Revision last() const { return last_; }

  // Less than all revisions of this epoch, and greater than those of earlier ones.
  static Revision first_of(std::uint32_t epoch) { return static_cast<Revision>(epoch) << kCounterBits; }

 private:
  // Ten thousand changes a second for three years.
  static constexpr int kCounterBits = 40;

  std::atomic<Revision> last_;
};

}  // namespace tessera::events
