// SPDX-License-Identifier: Apache-2.0
#include "client/tev_packets.hpp"

#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <utility>

namespace tessera::client {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::uint8_t kCreateImage = 4, kUpdateImageV3 = 6;
constexpr std::uint8_t kNoFocus = 0;  // the image does not become the selected one

class Packet {
 public:
  Packet(std::uint8_t operation, const std::string& image) : bytes_(sizeof(std::uint32_t), '\0') {
    number(operation);
    number(kNoFocus);
    text(image);
  }

  template <typename Number>
  void number(Number value) {
    append(&value, sizeof value);
  }
  void text(std::string_view value) {
    append(value.data(), value.size());
    bytes_ += '\0';
  }
  void append(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }
  void channels(const std::vector<std::string>& names) {
    number(static_cast<std::int32_t>(names.size()));
    for (const std::string& name : names) text(name);
  }

  std::string finish() && {
    const auto size = static_cast<std::uint32_t>(bytes_.size());
    std::memcpy(bytes_.data(), &size, sizeof size);
    return std::move(bytes_);
  }

 private:
  std::string bytes_;
};

}  // namespace

std::string tev_create_image(const TevImage& image) {
  Packet packet(kCreateImage, image.name);
  packet.number(std::int32_t{image.width});
  packet.number(std::int32_t{image.height});
  packet.channels(image.channels);
  return std::move(packet).finish();
}

std::string tev_update_image(const TevImage& image, const core::PixelRect& rect,
                             std::span<const float> values) {
  Packet packet(kUpdateImageV3, image.name);
  packet.channels(image.channels);
  for (const int value : {rect.x0, rect.y0, rect.width(), rect.height()}) packet.number(std::int32_t{value});
  const auto channels = static_cast<std::int64_t>(image.channels.size());
  for (std::int64_t offset = 0; offset < channels; ++offset) packet.number(offset);
  for (std::int64_t channel = 0; channel < channels; ++channel) packet.number(channels);  // strides
  packet.append(values.data(), values.size_bytes());
  return std::move(packet).finish();
}

}  // namespace tessera::client
