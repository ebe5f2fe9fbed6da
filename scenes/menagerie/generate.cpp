// SPDX-License-Identifier: Apache-2.0
// Writes the meshes and textures of the menagerie into a folder:
// tessera-generate-menagerie FOLDER [ORIGINALS]
// The files are the same bytes on every machine and at every run. What fetch.sh has put into the folder
// ORIGINALS is used in place of our own animals.
#include <filesystem>
#include <span>
#include <string>

#include "core/image/encode.hpp"
#include "core/image/file_io.hpp"
#include "scenes/menagerie/cow.hpp"
#include "scenes/menagerie/meadow.hpp"
#include "scenes/menagerie/originals.hpp"
#include "scenes/menagerie/rabbit.hpp"
#include "scenes/modelling/files.hpp"
#include "scenes/modelling/program.hpp"

namespace tessera::menagerie {
namespace {

constexpr float kCubeCm = 0.15f;
constexpr int kCoatPx = 2048;
// The bunny looks along -x, Spot along -z; ours along z.
constexpr Pose kBunnyPose{75, 16}, kSpotPose{180, 19};

core::Status write_mesh(const std::string& path, const core::MeshDescription& mesh) {
  return core::write_file_atomically(path, modelling::obj_text(mesh));
}

core::Status write_original(const std::string& path, const std::string& original, const Pose& pose) {
  const core::Result<core::MeshDescription> mesh = read_original(original, pose);
  return mesh ? write_mesh(path, *mesh) : core::fail(mesh.error());
}

core::Status write_image_file(const std::string& path, const core::Image& image) {
  const core::Result<std::string> png = core::encode_image(image, core::ImageFormat::kPng);
  return png ? core::write_file_atomically(path, *png) : core::fail(png.error().within(path));
}

core::Status write_rabbit(const std::string& folder, const std::string& originals) {
  const std::string bunny = originals + "/bunny.obj", path = folder + "/rabbit.obj";
  if (!originals.empty() && std::filesystem::exists(bunny)) return write_original(path, bunny, kBunnyPose);
  return write_mesh(path, rabbit(kCubeCm));
}

core::Status write_cow(const std::string& folder) {
  const core::MeshDescription mesh = cow(kCubeCm, kCoatPx);
  if (core::Status written = write_mesh(folder + "/cow.obj", mesh); !written) return written;
  return write_image_file(folder + "/cow.png", cow_coat(mesh, kCoatPx));
}

core::Status write_spot(const std::string& folder, const std::string& originals) {
  if (core::Status written = write_original(folder + "/cow.obj", originals + "/spot.obj", kSpotPose);
      !written)
    return written;
  const core::Result<std::string> texture = core::read_file(originals + "/spot_texture.png");
  return texture ? core::write_file_atomically(folder + "/cow.png", *texture) : core::fail(texture.error());
}

core::Status write_meadow(const std::string& folder) {
  if (core::Status written = write_mesh(folder + "/meadow.obj", meadow()); !written) return written;
  if (core::Status written = write_image_file(folder + "/meadow.png", meadow_colors()); !written)
    return written;
  return write_image_file(folder + "/ground.png", ground_colors());
}

core::Status generate(const std::string& folder, const std::string& originals) {
  if (core::Status written = write_rabbit(folder, originals); !written) return written;
  if (core::Status written = write_meadow(folder); !written) return written;
  const bool has_spot = !originals.empty() && std::filesystem::exists(originals + "/spot.obj");
  return has_spot ? write_spot(folder, originals) : write_cow(folder);
}

}  // namespace
}  // namespace tessera::menagerie

int main(int argc, char** argv) {
  const tessera::modelling::Program program{"tessera-generate-menagerie", "FOLDER [ORIGINALS]",
                                            "Writes the meshes and textures of the menagerie into FOLDER, "
                                            "from those in ORIGINALS where it has them.",
                                            1, 2};
  return tessera::modelling::run_program(program, argc, argv, [](std::span<const std::string> arguments) {
    return tessera::menagerie::generate(arguments[0], arguments.size() > 1 ? arguments[1] : "");
  });
}
