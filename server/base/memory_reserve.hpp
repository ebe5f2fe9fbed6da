// SPDX-License-Identifier: Apache-2.0
// Address space that is set aside for work that must not stop half-way when memory runs out.
//
// operator new of a thread with a Scope is given a part of the reserve when it fails, and tries again. It
// throws std::bad_alloc once the reserve is used up. Other threads get nothing of it. The reserve takes no
// memory until it is used. Thread-safe.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>

namespace tessera::base {

class MemoryReserve {
 public:
  // For 16,000 allocations: where the C library cannot extend its heap, it maps pages of 4 KiB for each.
  static constexpr std::size_t kParts = 32;
  // glibc's heap grows by at least 1 MiB where it cannot grow in place.
  static constexpr std::size_t kPartBytes = std::size_t{2} << 20;

  // Installs the process's handler of failed allocations (std::set_new_handler).
  MemoryReserve();
  ~MemoryReserve();
  MemoryReserve(const MemoryReserve&) = delete;
  MemoryReserve& operator=(const MemoryReserve&) = delete;

  // Sets aside again what was used. Returns whether all of it is there.
  bool refill();
  bool is_full() const { return given_.load(std::memory_order_relaxed) == 0; }

  // While it lives, allocations of this thread may use the reserve. Scopes may be nested.
  class Scope {
   public:
    explicit Scope(MemoryReserve& reserve);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    MemoryReserve* const outer_;
  };

 private:
  // Gives a part back to the system. Returns whether there was one.
  bool give_part();
  static void on_failed_allocation();

  std::array<std::atomic<void*>, kParts> parts_{};
  std::atomic<std::size_t> given_ = kParts;  // parts that are not there
};

}  // namespace tessera::base
