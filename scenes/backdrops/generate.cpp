// Paints a floor or a sky into a file: tessera-generate-backdrop NAME FILE
// The ending of FILE, .png or .hdr, says how. The same bytes on every machine and at every run.
#include <fmt/format.h>

#include <cstdio>
#include <string>

#include "core/image/encode.hpp"
#include "core/image/file_io.hpp"
#include "scenes/backdrops/backdrops.hpp"

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
  if (argc != 3) {
    fmt::print(stderr, "Usage: {} NAME FILE\nPaints a floor or a sky into a PNG or HDR file.\n", argv[0]);
    return 2;
  }
  const tessera::core::Status status = tessera::backdrops::generate(argv[1], argv[2]);
  if (!status) fmt::print(stderr, "{}\n", status.error().message);
  return status ? 0 : 1;
}
