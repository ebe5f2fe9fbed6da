// SPDX-License-Identifier: Apache-2.0
#include "client/tev_packets.hpp"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <utility>

namespace tessera::client {
namespace {

static_assert(std::endian::native == std::endian::little);
static_assert(sizeof(core::Rgb) == 3 * sizeof(float));

constexpr std::uint8_t kCreateImage = 4, kUpdateImageV3 = 6;
constexpr std::uint8_t kNoFocus = 0;  // the image does not become the selected one
constexpr std::array<const char*, 3> kChannels{"R", "G", "B"};

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
  void channels() {
    number(static_cast<std::int32_t>(kChannels.size()));
    for (const char* name : kChannels) text(name);
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

std::string tev_create_image(const std::string& name, int width, int height) {
  Packet packet(kCreateImage, name);
  packet.number(std::int32_t{width});
  packet.number(std::int32_t{height});
  packet.channels();
  return std::move(packet).finish();
}

std::string tev_update_image(const std::string& name, int x, int y, const core::Image& pixels) {
  Packet packet(kUpdateImageV3, name);
  packet.channels();
  for (const int value : {x, y, pixels.width, pixels.height}) packet.number(std::int32_t{value});
  for (std::int64_t offset = 0; offset < 3; ++offset) packet.number(offset);
  for (int channel = 0; channel < 3; ++channel) packet.number(std::int64_t{3});  // strides
  packet.append(pixels.pixels.data(), pixels.pixels.size() * sizeof(core::Rgb));
  return std::move(packet).finish();
}

}  // namespace tessera::client
