// SPDX-License-Identifier: Apache-2.0
#include "core/scene/mitsuba/serialized_mesh.hpp"

#include <fmt/format.h>
#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <memory>
#include <optional>

#include "core/scene/loader/bytes_at.hpp"

namespace tessera::core::mitsuba {
namespace {

constexpr std::uint16_t kMagic = 0x041c, kVersion3 = 3, kVersion4 = 4;
constexpr std::uint32_t kHasNormals = 0x0001, kHasUvs = 0x0002, kHasColors = 0x0008, kFaceNormals = 0x0010;
constexpr std::uint32_t kDoubles = 0x2000;
constexpr std::size_t kHeaderBytes = 4, kMaxRatio = 256;

tl::unexpected<Error> broken_file(std::string_view what) {
  return fail(ErrorCode::kInvalidArgument, fmt::format("is a broken serialized mesh: {}", what));
}

// Where a mesh begins, from the table at the end of the file: the offsets of all meshes, then their number.
Result<std::size_t> offset_of(std::string_view bytes, std::int64_t index, std::uint16_t version) {
  if (index == 0) return std::size_t{0};
  const std::size_t entry = version == kVersion4 ? sizeof(std::uint64_t) : sizeof(std::uint32_t);
  const auto count = bytes_at<std::uint32_t>(bytes, bytes.size() - sizeof(std::uint32_t));
  if (!count || index < 0 || index >= std::int64_t{*count})
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("has no mesh number {}, but {}", index, count.value_or(0)));
  const std::size_t table_bytes = entry * std::size_t{*count} + sizeof(std::uint32_t);
  if (table_bytes > bytes.size()) return broken_file("its table of meshes is longer than the file");
  const std::size_t place = bytes.size() - table_bytes + entry * static_cast<std::size_t>(index);
  const std::size_t offset = version == kVersion4
                                 ? std::size_t{bytes_at<std::uint64_t>(bytes, place).value_or(0)}
                                 : bytes_at<std::uint32_t>(bytes, place).value_or(0);
  if (offset >= bytes.size()) return broken_file("a mesh begins beyond its end");
  return offset;
}

struct InflateFree {
  void operator()(libdeflate_decompressor* decompressor) const { libdeflate_free_decompressor(decompressor); }
};

// The zlib stream at the start of `bytes`. Its size is not known beforehand.
Result<std::string> inflate(std::string_view bytes) {
  const std::unique_ptr<libdeflate_decompressor, InflateFree> decompressor(libdeflate_alloc_decompressor());
  if (!decompressor) return fail(ErrorCode::kResourceExhausted, "does not fit into memory");
  std::string content;
  for (std::size_t ratio = 4; ratio <= kMaxRatio; ratio *= 4) {
    content.resize(bytes.size() * ratio);
    std::size_t taken = 0, made = 0;
    const auto result = libdeflate_zlib_decompress_ex(decompressor.get(), bytes.data(), bytes.size(),
                                                      content.data(), content.size(), &taken, &made);
    if (result == LIBDEFLATE_BAD_DATA) return broken_file("its compressed data are damaged");
    if (result != LIBDEFLATE_SUCCESS) continue;
    content.resize(made);
    return content;
  }
  return fail(ErrorCode::kResourceExhausted, "expands more than 256 times, as no mesh does");
}

// The decompressed data, from front to back.
class MeshData {
 public:
  explicit MeshData(std::string_view bytes) : rest_(bytes) {}

  template <typename T>
  std::optional<T> next() {
    const auto value = bytes_at<T>(rest_, 0);
    if (value) rest_.remove_prefix(sizeof(T));
    return value;
  }
  bool skip_name() {
    const std::size_t end = rest_.find('\0');
    if (end == std::string_view::npos) return false;
    rest_.remove_prefix(end + 1);
    return true;
  }
  bool has(std::uint64_t count, std::size_t bytes_each) const { return count <= rest_.size() / bytes_each; }

  // Calls add(values) for each of `count` groups of numbers. There must be as many.
  template <std::size_t kNumbers, typename Add>
  void take_numbers(std::uint64_t count, bool doubles, const Add& add) {
    for (std::uint64_t i = 0; i < count; ++i) {
      std::array<float, kNumbers> values{};
      for (float& value : values)
        value = doubles ? static_cast<float>(next<double>().value_or(0)) : next<float>().value_or(0);
      add(values);
    }
  }

 private:
  std::string_view rest_;
};

struct MeshHeader {
  std::uint32_t flags = 0;
  std::uint64_t vertices = 0, triangles = 0;

  bool has(std::uint32_t flag) const { return (flags & flag) != 0; }
  std::size_t numbers_of_vertex() const {
    return std::size_t{3} + (has(kHasNormals) ? 3u : 0u) + (has(kHasUvs) ? 2u : 0u) +
           (has(kHasColors) ? 3u : 0u);
  }
};

std::optional<MeshHeader> read_mesh_header(MeshData& data, std::uint16_t version) {
  const auto flags = data.next<std::uint32_t>();
  if (!flags || (version == kVersion4 && !data.skip_name())) return std::nullopt;
  const auto vertices = data.next<std::uint64_t>(), triangles = data.next<std::uint64_t>();
  if (!vertices || !triangles) return std::nullopt;
  return MeshHeader{*flags, *vertices, *triangles};
}

MeshDescription read_mesh(MeshData& data, const MeshHeader& header) {
  const bool doubles = header.has(kDoubles);
  MeshDescription mesh;
  const auto as_vec3 = [](const std::array<float, 3>& v) { return Vec3{v[0], v[1], v[2]}; };
  data.take_numbers<3>(header.vertices, doubles,
                       [&](const auto& v) { mesh.positions.push_back(as_vec3(v)); });
  if (header.has(kHasNormals))
    data.take_numbers<3>(header.vertices, doubles,
                         [&](const auto& v) { mesh.normals.push_back(as_vec3(v)); });
  if (header.has(kHasUvs))
    data.take_numbers<2>(header.vertices, doubles, [&](const auto& v) { mesh.uvs.push_back({v[0], v[1]}); });
  if (header.has(kHasColors)) data.take_numbers<3>(header.vertices, doubles, [](const auto&) {});
  mesh.triangles.reserve(header.triangles);
  for (std::uint64_t i = 0; i < header.triangles; ++i) {
    std::array<std::uint32_t, 3> triangle{};
    for (std::uint32_t& corner : triangle) corner = data.next<std::uint32_t>().value_or(0);
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

}  // namespace

Result<SerializedMesh> read_serialized_mesh(std::string_view bytes, std::int64_t index,
                                            const SceneLimit& triangles) {
  const auto magic = bytes_at<std::uint16_t>(bytes, 0), version = bytes_at<std::uint16_t>(bytes, 2);
  if (magic != kMagic) return fail(ErrorCode::kInvalidArgument, "is no serialized mesh");
  if (version != kVersion3 && version != kVersion4)
    return fail(ErrorCode::kInvalidArgument, "is a serialized mesh of an unknown version");
  const auto offset = offset_of(bytes, index, *version);
  if (!offset) return fail(offset.error());
  if (bytes.size() - *offset <= kHeaderBytes) return broken_file("it ends early");
  const auto next = offset_of(bytes, index + 1, *version);
  const std::size_t end = next && *next > *offset + kHeaderBytes ? *next : bytes.size();
  const auto content = inflate(bytes.substr(*offset + kHeaderBytes, end - *offset - kHeaderBytes));
  if (!content) return fail(content.error());
  MeshData data(*content);
  const auto header = read_mesh_header(data, *version);
  if (!header) return broken_file("it ends early");
  if (header->triangles > triangles.most)
    return fail(ErrorCode::kResourceExhausted,
                fmt::format("has {} triangles, more than the {} that a scene may have here ({})",
                            header->triangles, triangles.most, triangles.option));
  const std::size_t number_bytes = header->has(kDoubles) ? sizeof(double) : sizeof(float);
  const std::size_t vertex_bytes = header->numbers_of_vertex() * number_bytes;
  constexpr std::size_t kTriangleBytes = 3 * sizeof(std::uint32_t);
  if (!data.has(header->vertices, vertex_bytes) || !data.has(header->triangles, kTriangleBytes) ||
      !data.has(header->vertices * vertex_bytes + header->triangles * kTriangleBytes, 1))
    return broken_file("it has fewer vertices or triangles than it says");
  return SerializedMesh{read_mesh(data, *header), header->has(kFaceNormals)};
}

}  // namespace tessera::core::mitsuba
