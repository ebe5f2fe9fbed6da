// Writes 25 bumpy bodies of 1.7 million triangles as an OBJ file: tessera-generate-field FILE
// The same bytes on every machine and at every run.
#include <span>
#include <string>

#include "bench/soups.hpp"
#include "core/image/file_io.hpp"
#include "scenes/modelling/files.hpp"
#include "scenes/modelling/program.hpp"
#include "scenes/modelling/surface.hpp"

namespace tessera::bench {
namespace {

core::Status generate(const std::string& path) {
  constexpr int kSide = 5, kRows = 132;
  const core::Soup soup = core::blobs(kSide, kRows);
  core::MeshDescription mesh{soup.positions, {}, {}, soup.triangles, {0}};
  modelling::smooth_normals(mesh);
  return core::write_file_atomically(path, modelling::obj_text(mesh));
}

}  // namespace
}  // namespace tessera::bench

int main(int argc, char** argv) {
  const tessera::modelling::Program program{
      "tessera-generate-field", "FILE", "Writes 25 bodies of 1.7 million triangles as an OBJ file.", 1, 1};
  return tessera::modelling::run_program(program, argc, argv, [](std::span<const std::string> arguments) {
    return tessera::bench::generate(arguments[0]);
  });
}
