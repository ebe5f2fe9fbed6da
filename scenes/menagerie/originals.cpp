// SPDX-License-Identifier: Apache-2.0
#include "scenes/menagerie/originals.hpp"

#include "core/image/file_io.hpp"
#include "core/math/transform.hpp"
#include "core/scene/loader/mesh_builder.hpp"
#include "core/scene/loader/obj_reader.hpp"

namespace tessera::menagerie {
namespace {

using core::Vec3;

// Scales and moves; normals stay what they are.
void stand(core::MeshDescription& mesh, float height_cm) {
  Vec3 low = mesh.positions.front(), high = low;
  for (const Vec3 p : mesh.positions) {
    low = min(low, p);
    high = max(high, p);
  }
  const Vec3 foot{(low.x + high.x) / 2, low.y, (low.z + high.z) / 2};
  const float scale = height_cm / (high.y - low.y);
  for (Vec3& p : mesh.positions) p = (p - foot) * scale;
}

}  // namespace

core::Result<core::MeshDescription> read_original(const std::string& path, const Pose& pose) {
  const core::Result<std::string> bytes = core::read_file(path);
  if (!bytes) return core::fail(bytes.error());
  const core::Result<core::ObjFile> file = core::read_obj(*bytes, path);
  if (!file) return core::fail(file.error());
  const core::Transform turn = core::rotation({0, 1, 0}, pose.yaw_degrees);
  core::Result<core::MeshDescription> mesh = core::build_mesh(*file, core::NormalsMode::kFile, turn, {0});
  if (!mesh) return core::fail(mesh.error().within(path));
  stand(*mesh, pose.height_cm);
  return mesh;
}

}  // namespace tessera::menagerie
