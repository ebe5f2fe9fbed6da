// SPDX-License-Identifier: Apache-2.0
#include "core/scene/cache/loaded_scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <utility>

#include "core/base/overloaded.hpp"
#include "core/base/printable.hpp"
#include "core/scene/cache/archive.hpp"
#include "core/scene/cache/scene_maker.hpp"

namespace tessera::core {

static auto fields(stored::Is<LoadRequest> auto& value) {
  auto& [scene_path, names] = value;
  return std::tie(scene_path, names);
}

namespace {

constexpr const char* kFileName = "the file between the processes";
constexpr std::size_t kMaxMessageBytes = 4096;  // escaping makes it up to four times as long
// Ids of vertices and primitives have 32 bits.
constexpr std::uint64_t kMaxElements = std::uint64_t{1} << 31;

tl::unexpected<Error> damaged() {
  return fail(ErrorCode::kInternal, "the process that loads scenes has written what no scene is");
}

Result<BlockFileReader> open_file(OpenFile file, int threads) {
  auto reader = BlockFileReader::of(std::move(file), kFileName, stored::file_version(), threads);
  if (reader) return reader;
  if (reader.error().message.ends_with("another version"))
    return fail(ErrorCode::kFailedPrecondition,
                "the program that loads scenes is of another build: install both of one release");
  return damaged();
}

Error as_error(std::int32_t code, const std::string& message) {
  const bool known = code >= 0 && code <= static_cast<std::int32_t>(ErrorCode::kInternal);
  return {known ? static_cast<ErrorCode>(code) : ErrorCode::kInternal,
          printable_lines(std::string_view(message).substr(0, kMaxMessageBytes))};
}

bool is_finite(Vec2 v) {
  return std::isfinite(v.x) && std::isfinite(v.y);
}

bool are_finite(const std::vector<Vec3>& normals, const std::vector<VertexTangent>& tangents) {
  return std::ranges::all_of(normals, [](Vec3 normal) { return core::is_finite(normal); }) &&
         std::ranges::all_of(tangents, [](const VertexTangent& tangent) {
           return core::is_finite(tangent.direction) && std::isfinite(tangent.handedness);
         });
}

bool is_finite_mesh(const MeshDescription& mesh) {
  return are_finite(mesh.normals, mesh.tangents) &&
         std::ranges::all_of(mesh.uvs, [](Vec2 uv) { return is_finite(uv); }) &&
         std::ranges::all_of(mesh.second_uvs, [](Vec2 uv) { return is_finite(uv); }) &&
         std::ranges::all_of(mesh.steps,
                             [](const MeshStep& step) { return are_finite(step.normals, step.tangents); });
}

// What the shapes take of the 32-bit ids.
struct Elements {
  std::uint64_t vertices = 0, primitives = 0;

  void add(const ShapeDescription& shape) {
    std::visit(Overloaded{[this](const MeshDescription& mesh) {
                            vertices += mesh.positions.size() * (1 + mesh.steps.size());
                            primitives += mesh.triangles.size();
                          },
                          [this](const QuadDescription&) { vertices += 4, primitives += 2; },
                          [this](const CurvesDescription& curves) {
                            vertices += curves.strands.points.size();
                            primitives += kMaxCurveParts * segment_count(curves.strands);
                          },
                          [this](const auto&) { ++primitives; }},
               shape);
  }
};

bool are_sound(const std::vector<ShapeDescription>& shapes) {
  Elements elements;
  for (const ShapeDescription& shape : shapes) {
    elements.add(shape);
    const auto* const mesh = std::get_if<MeshDescription>(&shape);
    if (mesh != nullptr && !is_finite_mesh(*mesh)) return false;
  }
  return elements.vertices < kMaxElements && elements.primitives < kMaxElements;
}

// What every loader guarantees, and validate_scene() therefore does not check.
bool is_sound(const SceneDescription& scene) {
  return are_sound(scene.shapes) && core::is_sound(scene.animation) &&
         std::ranges::all_of(scene.objects,
                             [](const ObjectDescription& object) { return are_sound(object.shapes); }) &&
         std::ranges::all_of(scene.textures, [](const Texture& texture) {
           return is_finite(texture.scale) && is_finite(texture.offset) && is_finite(texture.shear);
         });
}

}  // namespace

Status write_load_request(OpenFile file, const LoadRequest& request) {
  auto out = BlockFileWriter::to(std::move(file), kFileName, stored::file_version(), 1);
  stored::Writer writer(out);
  writer(request);
  return out.finish(writer.bytes());
}

Result<LoadRequest> read_load_request(OpenFile file) {
  auto in = open_file(std::move(file), 1);
  if (!in) return fail(in.error());
  stored::Reader reader(*in);
  LoadRequest request;
  reader(request);
  if (!reader.complete()) return damaged();
  return request;
}

Status write_loaded(OpenFile file, const Result<SceneDescription>& loaded) {
  auto out = BlockFileWriter::to(std::move(file), kFileName, stored::file_version(), 1);
  stored::Writer writer(out);
  writer(loaded.has_value());
  if (loaded) {
    writer(*loaded);
  } else {
    writer(static_cast<std::int32_t>(loaded.error().code));
    writer(loaded.error().message);
  }
  return out.finish(writer.bytes());
}

Result<SceneDescription> read_loaded(OpenFile file, int threads) {
  auto in = open_file(std::move(file), threads);
  if (!in) return fail(in.error());
  stored::Reader reader(*in);
  bool is_loaded = false;
  reader(is_loaded);
  if (is_loaded) {
    SceneDescription scene;
    reader(scene);
    if (!reader.complete() || !is_sound(scene)) return damaged();
    return scene;
  }
  std::int32_t code = 0;
  std::string message;
  reader(code);
  reader(message);
  if (!reader.complete() || message.empty()) return damaged();
  return fail(as_error(code, message));
}

}  // namespace tessera::core
