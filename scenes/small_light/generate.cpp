// Makes the planets and their chart into a folder: tessera-generate-small-light FOLDER
// The files are the same bytes on every machine and at every run.
#include <fmt/format.h>

#include <cstdio>
#include <string>

#include "core/image/encode.hpp"
#include "core/image/file_io.hpp"
#include "scenes/modelling/files.hpp"
#include "scenes/small_light/planets.hpp"

namespace tessera::small_light {
namespace {

core::Status generate(const std::string& folder) {
  for (const auto& [name, paint] : paintings()) {
    const core::Result<std::string> png = core::encode_image(paint(), core::ImageFormat::kPng);
    if (!png) return core::fail(png.error().within(name));
    if (core::Status written = core::write_file_atomically(folder + "/" + name + ".png", *png); !written)
      return written;
  }
  return core::write_file_atomically(folder + "/ring.obj", modelling::obj_text(ring_mesh()));
}

}  // namespace
}  // namespace tessera::small_light

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "Usage: {} FOLDER\nMakes the planets and their chart into FOLDER.\n", argv[0]);
    return 2;
  }
  const tessera::core::Status status = tessera::small_light::generate(argv[1]);
  if (!status) fmt::print(stderr, "{}\n", status.error().message);
  return status ? 0 : 1;
}
