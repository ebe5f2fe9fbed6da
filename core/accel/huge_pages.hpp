// SPDX-License-Identifier: Apache-2.0
// Large arrays with random access, on huge pages where the system has them, which saves TLB misses. Memory
// is not touched before elements are written: unused elements take none, and many threads can write the
// rest.
#pragma once

#include <sys/mman.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <utility>

namespace tessera::core::accel {

template <typename T>
class HugePageArray {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  HugePageArray() = default;
  // The elements are uninitialised.
  explicit HugePageArray(std::size_t size) : memory_(allocate(size)), size_(size) {}
  // A moved-from array is empty.
  HugePageArray(HugePageArray&& other) noexcept
      : memory_(std::move(other.memory_)), size_(std::exchange(other.size_, 0)) {}
  HugePageArray& operator=(HugePageArray&& other) noexcept {
    memory_ = std::move(other.memory_);
    size_ = std::exchange(other.size_, 0);
    return *this;
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T* data() { return memory_.get(); }
  const T* data() const { return memory_.get(); }
  T& operator[](std::size_t i) { return memory_.get()[i]; }
  const T& operator[](std::size_t i) const { return memory_.get()[i]; }
  const T* begin() const { return data(); }
  const T* end() const { return data() + size_; }
  std::span<T> range(std::size_t first, std::size_t last) { return {data() + first, last - first}; }

  // Drops the elements from `size` on and keeps the memory.
  void truncate(std::size_t size) { size_ = std::min(size, size_); }

  bool operator==(const HugePageArray& other) const {
    return std::equal(begin(), end(), other.begin(), other.end());
  }

 private:
  static constexpr std::size_t kHugePage = 2u << 20;

  struct Deleter {
    std::align_val_t alignment{alignof(T)};
    void operator()(T* memory) const { ::operator delete(memory, alignment); }
  };
  using Memory = std::unique_ptr<T, Deleter>;

  static Memory allocate(std::size_t count) {
    const std::size_t bytes = count * sizeof(T);
    const std::align_val_t alignment{bytes >= kHugePage ? kHugePage : alignof(T)};
    void* memory = ::operator new(bytes, alignment);
    if (bytes >= kHugePage) madvise(memory, bytes, MADV_HUGEPAGE);  // a hint: refusing it costs only time
    return Memory(static_cast<T*>(memory), Deleter{alignment});
  }

  Memory memory_;
  std::size_t size_ = 0;
};

}  // namespace tessera::core::accel
