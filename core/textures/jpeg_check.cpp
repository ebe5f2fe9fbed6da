#include "core/textures/jpeg_check.hpp"

#include <cstddef>

namespace tessera::core {
namespace {

constexpr unsigned kHuffmanTables = 0xc4, kEndOfImage = 0xd9;
constexpr std::size_t kMaxSymbols = 256;

unsigned byte_at(std::string_view bytes, std::size_t i) {
  return static_cast<unsigned char>(bytes[i]);
}

// Markers without a segment behind them: stuffed zeros and restarts within the compressed data, among others.
bool stands_alone(unsigned marker) {
  return marker <= 0x01 || (marker >= 0xd0 && marker <= 0xd8);
}

// The next marker, with everything up to it taken off; nullopt at the end.
std::optional<unsigned> take_marker(std::string_view& bytes) {
  std::size_t i = bytes.find('\xff');
  while (i < bytes.size() && byte_at(bytes, i) == 0xff) ++i;
  if (i >= bytes.size()) return std::nullopt;
  const unsigned marker = byte_at(bytes, i);
  bytes.remove_prefix(i + 1);
  return marker;
}

// A segment begins with its length, which counts its own two bytes.
std::optional<std::string_view> take_segment(std::string_view& bytes) {
  if (bytes.size() < 2) return std::nullopt;
  const std::size_t length = byte_at(bytes, 0) * 256 + byte_at(bytes, 1);
  if (length < 2 || length > bytes.size()) return std::nullopt;
  const std::string_view segment = bytes.substr(2, length - 2);
  bytes.remove_prefix(length);
  return segment;
}

// Tables follow each other: a byte of class and number, 16 counts of symbols, the symbols.
bool tables_fit(std::string_view segment) {
  while (segment.size() >= 17) {
    std::size_t symbols = 0;
    for (std::size_t i = 1; i <= 16; ++i) symbols += byte_at(segment, i);
    if (symbols > kMaxSymbols || 17 + symbols > segment.size()) return false;
    segment.remove_prefix(17 + symbols);
  }
  return segment.empty();
}

}  // namespace

std::optional<std::string_view> jpeg_fault(std::string_view bytes) {
  while (const auto marker = take_marker(bytes)) {
    if (*marker == kEndOfImage) return std::nullopt;
    if (stands_alone(*marker)) continue;
    const auto segment = take_segment(bytes);
    if (!segment) break;
    if (*marker == kHuffmanTables && !tables_fit(*segment)) return "a Huffman table is too long";
  }
  return "the file ends too early";
}

}  // namespace tessera::core
