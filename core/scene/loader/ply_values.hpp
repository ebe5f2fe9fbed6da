// SPDX-License-Identifier: Apache-2.0
// The values of a PLY file's body, one after the other. Not thread-safe.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string_view>

#include "core/scene/loader/ply_header.hpp"

namespace tessera::core {

// A binary value in memory; `swapped` if its bytes are in the other order than the machine's.
template <typename T>
T load_ply_value(const char* bytes, bool swapped) {
  std::array<char, sizeof(T)> value{};
  std::memcpy(value.data(), bytes, sizeof(T));
  if (swapped) std::reverse(value.begin(), value.end());
  return std::bit_cast<T>(value);
}

// Calls visit with a value of the C++ type of `type`, and returns its result.
template <typename Visit>
auto with_ply_type(PlyType type, const Visit& visit) {
  switch (type) {
    case PlyType::kInt8:
      return visit(std::int8_t());
    case PlyType::kUint8:
      return visit(std::uint8_t());
    case PlyType::kInt16:
      return visit(std::int16_t());
    case PlyType::kUint16:
      return visit(std::uint16_t());
    case PlyType::kInt32:
      return visit(std::int32_t());
    case PlyType::kUint32:
      return visit(std::uint32_t());
    case PlyType::kFloat:
      return visit(float());
    case PlyType::kDouble:
      break;
  }
  return visit(double());
}

// Too large values become infinite.
inline float ply_float(double value) {
  constexpr double kMax = std::numeric_limits<float>::max();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  if (std::fabs(value) > kMax) return value > 0 ? kInfinity : -kInfinity;
  return static_cast<float>(value);
}
template <typename T>
float ply_float(T value) {
  return static_cast<float>(value);
}

class PlyValues {
 public:
  PlyValues(std::string_view body, PlyEncoding encoding) : rest_(body), encoding_(encoding) {}

  // Set by the first value that is missing or, in a text, no number. All later ones are 0.
  bool failed() const { return failed_; }
  std::size_t bytes_left() const { return rest_.size(); }
  bool is_binary() const { return encoding_ != PlyEncoding::kAscii; }
  bool is_swapped() const {
    return (encoding_ == PlyEncoding::kBigEndian) == (std::endian::native == std::endian::little);
  }

  float next_float(PlyType type);
  // Saturates.
  std::int64_t next_integer(PlyType type);
  void skip(PlyType type, std::uint64_t count);
  // The next bytes of a binary file; null if there are not as many.
  const char* take(std::size_t bytes);
  // Whether so many rows may follow: in a binary file each of at least `row_size` bytes, in a text of as many
  // numbers, each with a blank behind it.
  bool may_follow(std::uint64_t rows, std::size_t row_size) const {
    const std::size_t row_bytes = std::max<std::size_t>(is_binary() ? row_size : 2 * row_size, 1);
    return rows <= (rest_.size() + 1) / row_bytes;
  }

 private:
  template <typename T>
  T next_number();
  std::string_view next_word();

  std::string_view rest_;
  PlyEncoding encoding_;
  bool failed_ = false;
};

}  // namespace tessera::core
