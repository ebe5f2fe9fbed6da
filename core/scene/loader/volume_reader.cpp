// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/volume_reader.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstring>

#include "core/scene/loader/bytes_at.hpp"

namespace tessera::core {
namespace {

constexpr std::size_t kVolumeHeaderBytes = 48;
constexpr unsigned char kVolumeVersion = 3;
constexpr std::uint32_t kFloatEncoding = 1;

tl::unexpected<Error> bad_volume(std::string message) {
  return fail(ErrorCode::kInvalidArgument, std::move(message));
}

// The size and channels; no values.
Result<VoxelGrid> read_volume_header(std::string_view bytes) {
  if (bytes.size() < kVolumeHeaderBytes || !bytes.starts_with(kVolumeMagic))
    return bad_volume("is not a grid volume file: it does not begin with \"VOL\" and a header");
  const auto word_at = [&](std::size_t offset) { return *bytes_at<std::uint32_t>(bytes, offset); };
  if (static_cast<unsigned char>(bytes[3]) != kVolumeVersion)
    return bad_volume(fmt::format("is a grid volume of version {}; only version {} is read",
                                  static_cast<unsigned char>(bytes[3]), kVolumeVersion));
  if (const std::uint32_t encoding = word_at(4); encoding != kFloatEncoding)
    return bad_volume(fmt::format("has values of encoding {}; only encoding {}, 32-bit floats, is read",
                                  encoding, kFloatEncoding));
  VoxelGrid grid;
  for (std::size_t axis = 0; axis < 3; ++axis) grid.size[axis] = word_at(8 + 4 * axis);
  grid.channels = word_at(20);
  for (const std::uint32_t side : grid.size)
    if (side == 0 || side > kMaxGridSide)
      return bad_volume(fmt::format("has {} x {} x {} voxels; a side may have 1 to {}", grid.size[0],
                                    grid.size[1], grid.size[2], kMaxGridSide));
  if (grid.channels != 1 && grid.channels != 3)
    return bad_volume(fmt::format("has {} channels; only 1 and 3 are read", grid.channels));
  return grid;
}

}  // namespace

Result<VoxelGrid> read_volume(std::string_view bytes) {
  auto grid = read_volume_header(bytes);
  if (!grid) return grid;
  const std::size_t count = grid->voxel_count() * grid->channels;
  if ((bytes.size() - kVolumeHeaderBytes) / sizeof(float) < count)
    return bad_volume(fmt::format("is cut short: it has {} bytes, and {} x {} x {} voxels take {}",
                                  bytes.size(), grid->size[0], grid->size[1], grid->size[2],
                                  kVolumeHeaderBytes + count * sizeof(float)));
  grid->values.resize(count);
  std::memcpy(grid->values.data(), bytes.data() + kVolumeHeaderBytes, count * sizeof(float));
  for (std::size_t i = 0; i < count; ++i)
    if (!(std::isfinite(grid->values[i]) && grid->values[i] >= 0))
      return bad_volume(fmt::format("has the value {} in voxel {}; values must be finite and not negative",
                                    grid->values[i], i / grid->channels));
  return grid;
}

}  // namespace tessera::core
