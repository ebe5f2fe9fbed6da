// SPDX-License-Identifier: Apache-2.0
#include "server/base/memory_reserve.hpp"

#include <sys/mman.h>

#include <new>
#include <utility>

namespace tessera::base {

namespace {

// The reserve that this thread may use; null if there is none.
thread_local MemoryReserve* in_use = nullptr;

}  // namespace

MemoryReserve::MemoryReserve() {
  std::set_new_handler(on_failed_allocation);
  refill();
}

MemoryReserve::~MemoryReserve() {
  while (give_part()) {
  }
}

bool MemoryReserve::refill() {
  if (is_full()) return true;
  for (std::atomic<void*>& part : parts_) {
    if (part.load() != nullptr) continue;
    void* const mapped =
        mmap(nullptr, kPartBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (mapped == MAP_FAILED) return false;
    void* expected = nullptr;
    if (part.compare_exchange_strong(expected, mapped)) {
      given_.fetch_sub(1);
    } else {
      munmap(mapped, kPartBytes);  // another thread was faster
    }
  }
  return is_full();
}

bool MemoryReserve::give_part() {
  for (std::atomic<void*>& part : parts_) {
    void* const mapped = part.exchange(nullptr);
    if (mapped == nullptr) continue;
    given_.fetch_add(1);
    munmap(mapped, kPartBytes);
    return true;
  }
  return false;
}

void MemoryReserve::on_failed_allocation() {
  if (in_use == nullptr || !in_use->give_part()) throw std::bad_alloc();
}

MemoryReserve::Scope::Scope(MemoryReserve& reserve) : outer_(std::exchange(in_use, &reserve)) {}

MemoryReserve::Scope::~Scope() {
  in_use = outer_;
}

}  // namespace tessera::base
