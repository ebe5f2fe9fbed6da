// SPDX-License-Identifier: Apache-2.0
// Writes the meshes and textures of the still life into a folder: tessera-generate-still-life FOLDER
// The files are the same bytes on every machine and at every run.
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/image/encode.hpp"
#include "core/image/file_io.hpp"
#include "scenes/modelling/files.hpp"
#include "scenes/modelling/program.hpp"
#include "scenes/still_life/fruit.hpp"
#include "scenes/still_life/mosaic_vase.hpp"
#include "scenes/still_life/pottery.hpp"
#include "scenes/still_life/table.hpp"

namespace tessera::still_life {
namespace {

core::Status write_model(const std::string& folder, const std::string& name, const Model& model) {
  const auto write = [&](const std::string& ending, const std::string& bytes) {
    return core::write_file_atomically(folder + "/" + name + ending, bytes);
  };
  core::Status status;
  if (!model.mesh.triangles.empty())
    status = write(".obj", modelling::obj_text(model.mesh, model.material_names, name + ".mtl"));
  if (status && !model.materials_mtl.empty()) status = write(".mtl", model.materials_mtl);
  if (!status || model.texture.pixels.empty()) return status;
  const core::Result<std::string> png = core::encode_image(model.texture, core::ImageFormat::kPng);
  return png ? write(".png", *png) : core::fail(png.error().within(name + ".png"));
}

core::Status generate(const std::string& folder) {
  const std::vector<std::pair<std::string, std::function<Model()>>> models{
      {"vase", mosaic_vase},   {"bottle", stoneware_bottle},
      {"bowl", speckled_bowl}, {"goblet", goblet},
      {"orange", orange},      {"lemon", lemon},
      {"pear", pear},          {"table", table},
      {"linen", linen},        {"plaster", plaster}};
  for (const auto& [name, make] : models) {
    core::Status written = write_model(folder, name, make());
    if (!written) return written;
  }
  return {};
}

}  // namespace
}  // namespace tessera::still_life

int main(int argc, char** argv) {
  const tessera::modelling::Program program{"tessera-generate-still-life", "FOLDER",
                                            "Writes the meshes and textures of the still life into FOLDER.",
                                            1, 1};
  return tessera::modelling::run_program(program, argc, argv, [](std::span<const std::string> arguments) {
    return tessera::still_life::generate(arguments[0]);
  });
}
