// SPDX-License-Identifier: Apache-2.0
// Paints a floor or a sky into a file: tessera-generate-backdrop NAME FILE
// The ending of FILE, .png or .hdr, says how. The same bytes on every machine and at every run.
#include <span>
#include <string>

#include "core/image/encode.hpp"
#include "core/image/file_io.hpp"
#include "scenes/backdrops/backdrops.hpp"
#include "scenes/modelling/program.hpp"

namespace tessera::backdrops {
namespace {

core::Status generate(const std::string& name, const std::string& path) {
  const core::Result<core::Image> image = backdrop(name);
  if (!image) return core::fail(image.error());
  const core::Result<core::ImageFormat> format = core::image_format_from_path(path);
  if (!format) return core::fail(format.error());
  const core::Result<std::string> bytes = core::encode_image(*image, *format);
  return bytes ? core::write_file_atomically(path, *bytes) : core::fail(bytes.error().within(path));
}

}  // namespace
}  // namespace tessera::backdrops

int main(int argc, char** argv) {
  const tessera::modelling::Program program{"tessera-generate-backdrop", "NAME FILE",
                                            "Paints a floor or a sky into a PNG or HDR file.", 2, 2};
  return tessera::modelling::run_program(program, argc, argv, [](std::span<const std::string> arguments) {
    return tessera::backdrops::generate(arguments[0], arguments[1]);
  });
}
