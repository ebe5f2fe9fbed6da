#include "core/image/hdr_check.hpp"

#include <cstddef>

namespace tessera::core {
namespace {

unsigned byte_at(std::string_view bytes, std::size_t i) {
  return static_cast<unsigned char>(bytes[i]);
}

// What follows the header: a blank line ends the variables, one line more tells the size.
std::string_view pixel_data(std::string_view bytes) {
  const std::size_t blank = bytes.find("\n\n");
  if (blank == std::string_view::npos) return {};
  const std::size_t size_end = bytes.find('\n', blank + 2);
  return size_end == std::string_view::npos ? std::string_view{} : bytes.substr(size_end + 1);
}

// Skips the runs of one channel of one row; false where they do not add up to `width`.
bool skip_channel(std::string_view& data, int width) {
  for (int x = 0; x < width;) {
    if (data.size() < 2) return false;
    const unsigned count = byte_at(data, 0);
    const bool repeats = count > 128;
    const unsigned pixels = repeats ? count - 128 : count;
    const std::size_t bytes = repeats ? 2 : 1 + pixels;
    x += static_cast<int>(pixels);
    if (pixels == 0 || x > width || bytes > data.size()) return false;
    data.remove_prefix(bytes);
  }
  return true;
}

}  // namespace

bool is_hdr_picture(std::string_view bytes) {
  return bytes.starts_with("#?RADIANCE\n") || bytes.starts_with("#?RGBE\n");
}

bool is_complete_hdr(std::string_view bytes, int width, int height) {
  std::string_view data = pixel_data(bytes);
  const bool may_be_packed = width >= 8 && width < 32768;
  const auto starts_packed_row = [&] {
    return data.size() >= 4 && byte_at(data, 0) == 2 && byte_at(data, 1) == 2 && byte_at(data, 2) < 128;
  };
  if (!may_be_packed || !starts_packed_row())
    return data.size() / 4 / static_cast<std::size_t>(width) >= static_cast<std::size_t>(height);
  for (int y = 0; y < height; ++y) {
    if (!starts_packed_row()) return false;
    data.remove_prefix(4);
    for (int channel = 0; channel < 4; ++channel)
      if (!skip_channel(data, width)) return false;
  }
  return true;
}

}  // namespace tessera::core
