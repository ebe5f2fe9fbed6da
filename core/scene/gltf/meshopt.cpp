// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/meshopt.hpp"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "core/scene/loader/wording.hpp"

namespace tessera::core::gltf {
namespace {

// The codecs make at most so many bytes of one, which bounds the memory for a stream.
constexpr std::uint64_t kMaxExpansion = 64, kMinBudget = 4096;

bool is_stride_of(const MeshoptStream& stream) {
  const std::size_t stride = stream.stride;
  if (stream.filter == "OCTAHEDRAL" && stride != 4 && stride != 8) return false;
  if (stream.filter == "QUATERNION" && stride != 8) return false;
  if (stream.mode == "ATTRIBUTES") return stride > 0 && stride <= 256 && stride % 4 == 0;
  return stride == 2 || stride == 4;
}

// The version of the codec of vertices, which its first byte tells; EXT_meshopt_compression has version 0.
int vertex_codec_version(std::string_view bytes) {
  constexpr unsigned kVertexHeader = 0xa0, kVersion = 0x0f;
  const unsigned first = bytes.empty() ? 0 : static_cast<unsigned char>(bytes[0]);
  return (first & ~kVersion) == kVertexHeader ? static_cast<int>(first & kVersion) : 0;
}

int decompress(const MeshoptStream& stream, void* to) {
  const auto* from = reinterpret_cast<const unsigned char*>(stream.bytes.data());
  const std::size_t size = stream.bytes.size();
  if (stream.mode == "ATTRIBUTES")
    return meshopt_decodeVertexBuffer(to, stream.count, stream.stride, from, size);
  if (stream.mode == "TRIANGLES")
    return meshopt_decodeIndexBuffer(to, stream.count, stream.stride, from, size);
  return meshopt_decodeIndexSequence(to, stream.count, stream.stride, from, size);
}

// Unit vectors in octahedral coordinates, whose unit is the third one (EXT_meshopt_compression, filter 1).
// The library's own function estimates square roots where T has 8 bits, differently on different processors.
template <typename T>
void decode_octahedral(void* data, std::size_t count) {
  constexpr float kMax = std::numeric_limits<T>::max();
  const auto rounded = [](float v) { return static_cast<T>(v + (v >= 0 ? 0.5f : -0.5f)); };
  char* at = static_cast<char*>(data);
  for (std::size_t i = 0; i < count; ++i, at += 4 * sizeof(T)) {
    std::array<T, 4> element{};
    std::memcpy(element.data(), at, sizeof element);
    float x = element[0], y = element[1];
    const float z = static_cast<float>(element[2]) - std::fabs(x) - std::fabs(y);
    const float below = std::min(z, 0.0f);
    x += x >= 0 ? below : -below;
    y += y >= 0 ? below : -below;
    const float length = std::sqrt(x * x + y * y + z * z), scale = length > 0 ? kMax / length : 0;
    element[0] = rounded(x * scale), element[1] = rounded(y * scale), element[2] = rounded(z * scale);
    std::memcpy(at, element.data(), sizeof element);
  }
}

void apply_filter(const MeshoptStream& stream, void* data) {
  if (stream.filter == "OCTAHEDRAL" && stream.stride == 4) decode_octahedral<std::int8_t>(data, stream.count);
  if (stream.filter == "OCTAHEDRAL" && stream.stride == 8)
    decode_octahedral<std::int16_t>(data, stream.count);
  if (stream.filter == "QUATERNION") meshopt_decodeFilterQuat(data, stream.count, stream.stride);
  if (stream.filter == "EXPONENTIAL") meshopt_decodeFilterExp(data, stream.count, stream.stride);
}

}  // namespace

MeshoptStream read_meshopt_stream(const Value& extension, std::string_view bytes) {
  MeshoptStream stream{bytes, static_cast<std::size_t>(extension.whole_or("byteStride", 0)),
                       static_cast<std::size_t>(extension.whole_or("count", 0)), extension.text("mode"),
                       extension.text("filter")};
  if (stream.mode != "ATTRIBUTES" && stream.mode != "TRIANGLES" && stream.mode != "INDICES")
    extension.refuse(fmt::format("there is no mode {}", in_quotes(stream.mode)));
  if (!stream.filter.empty() && stream.filter != "NONE" && stream.filter != "OCTAHEDRAL" &&
      stream.filter != "QUATERNION" && stream.filter != "EXPONENTIAL")
    extension.refuse(fmt::format("there is no filter {}", in_quotes(stream.filter)));
  if (!is_stride_of(stream))
    extension.refuse(fmt::format("byteStride cannot be {} for the mode {}", stream.stride, stream.mode));
  if (stream.mode == "TRIANGLES" && stream.count % 3 != 0)
    extension.refuse("count must be a multiple of 3 for the mode TRIANGLES");
  const std::uint64_t budget = kMaxExpansion * bytes.size() + kMinBudget;
  if (stream.count > budget / stream.stride)
    extension.refuse(fmt::format("{} elements cannot be in {} bytes", stream.count, bytes.size()));
  return stream;
}

std::string decode_meshopt(const Value& extension, const MeshoptStream& stream) {
  if (const int version = vertex_codec_version(stream.bytes); stream.mode == "ATTRIBUTES" && version > 0)
    extension.refuse(
        fmt::format("its vertices are compressed by version {} of the codec; only version 0 is "
                    "supported",
                    version));
  // Filters work on words.
  std::vector<std::uint64_t> words((stream.count * stream.stride + 7) / 8);
  if (stream.count > 0 && decompress(stream, words.data()) != 0)
    extension.refuse("its compressed bytes are damaged");
  if (stream.mode == "ATTRIBUTES") apply_filter(stream, words.data());
  return {reinterpret_cast<const char*>(words.data()), stream.count * stream.stride};
}

}  // namespace tessera::core::gltf
