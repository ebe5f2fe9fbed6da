// SPDX-License-Identifier: Apache-2.0
// Writes a soup of triangles as an OBJ file: tessera-generate-soup NAME FILE
// The same bytes on every machine and at every run.
#include <span>
#include <string>

#include "bench/soups.hpp"
#include "core/image/file_io.hpp"
#include "core/scene/writer/curve_writer.hpp"
#include "scenes/modelling/files.hpp"
#include "scenes/modelling/program.hpp"
#include "scenes/modelling/surface.hpp"

namespace tessera::bench {
namespace {

core::Status write(const core::Soup& soup, const std::string& path) {
  core::MeshDescription mesh{soup.positions, {}, {}, soup.triangles, {0}};
  modelling::smooth_normals(mesh);
  return core::write_file_atomically(path, modelling::obj_text(mesh));
}

core::Status generate(const std::string& name, const std::string& path) {
  if (name == "blobs") return write(core::blobs(5, 132), path);
  if (name == "strands") return write(core::strands(), path);
  if (name == "strand_curves")
    return core::write_file_atomically(path, core::write_curve_file(core::strand_curves()));
  return core::fail(core::ErrorCode::kInvalidArgument,
                    "there is no soup '" + name + "'; there are blobs, strands and strand_curves");
}

}  // namespace
}  // namespace tessera::bench

int main(int argc, char** argv) {
  const tessera::modelling::Program program{
      "tessera-generate-soup", "NAME FILE",
      "Writes blobs (25, of 1.7 million triangles) or strands (a ball of "
      "hair, of 300,000) as an OBJ file, or strand_curves as a PLY file.",
      2, 2};
  return tessera::modelling::run_program(program, argc, argv, [](std::span<const std::string> arguments) {
    return tessera::bench::generate(arguments[0], arguments[1]);
  });
}
