// SPDX-License-Identifier: Apache-2.0
#include "core/scene/writer/curve_writer.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstdint>

namespace tessera::core {
namespace {

void put_word(std::string& bytes, std::uint32_t word) {
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(word >> shift & 0xff);
}
void put_number(std::string& bytes, float value) {
  put_word(bytes, std::bit_cast<std::uint32_t>(value));
}
void put_point(std::string& bytes, Vec3 p) {
  for (int axis = 0; axis < 3; ++axis) put_number(bytes, p[axis]);
}

}  // namespace

std::string write_curve_file(const CurveStrands& strands) {
  const bool has_radii = strands.radii.size() > 1;
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
      "property float z\n{}element curve {}\nproperty uint points\n",
      strands.points.size(), has_radii ? "property float radius\n" : "", strands.counts.size());
  if (!strands.normals.empty())
    bytes += fmt::format("element normal {}\nproperty float nx\nproperty float ny\nproperty float nz\n",
                         strands.normals.size());
  bytes += "end_header\n";
  constexpr std::size_t kPointBytes = 16, kNormalBytes = 12, kCountBytes = 4;
  bytes.reserve(bytes.size() + kPointBytes * strands.points.size() + kCountBytes * strands.counts.size() +
                kNormalBytes * strands.normals.size());
  for (std::size_t i = 0; i < strands.points.size(); ++i) {
    put_point(bytes, strands.points[i]);
    if (has_radii) put_number(bytes, strands.radii[i]);
  }
  for (const std::uint32_t count : strands.counts) put_word(bytes, count);
  for (const Vec3 normal : strands.normals) put_point(bytes, normal);
  return bytes;
}

}  // namespace tessera::core
