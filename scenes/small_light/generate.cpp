// SPDX-License-Identifier: Apache-2.0
// Makes the planets and their chart into a folder: tessera-generate-small-light FOLDER
// The files are the same bytes on every machine and at every run.
#include <span>
#include <string>

#include "core/image/encode.hpp"
#include "core/image/file_io.hpp"
#include "scenes/modelling/files.hpp"
#include "scenes/modelling/program.hpp"
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
  const tessera::modelling::Program program{"tessera-generate-small-light", "FOLDER",
                                            "Makes the planets and their chart into FOLDER.", 1, 1};
  return tessera::modelling::run_program(program, argc, argv, [](std::span<const std::string> arguments) {
    return tessera::small_light::generate(arguments[0]);
  });
}
