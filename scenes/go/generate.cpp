// SPDX-License-Identifier: Apache-2.0
// tessera-generate-go: writes the meshes and textures of the go scene for one position of one game. The files
// are the same bytes on every machine and at every run.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/image/encode.hpp"
#include "core/image/file_io.hpp"
#include "scenes/go/furniture.hpp"
#include "scenes/go/position.hpp"
#include "scenes/go/setting.hpp"
#include "scenes/go/sgf.hpp"
#include "scenes/modelling/files.hpp"

namespace tessera::go {
namespace {

constexpr const char* kDescription =
    "Writes the meshes and textures of the example scene go for a game that an SGF file records, so that\n"
    "  tessera render go -o go.png\n"
    "shows its board, with the stones that each side captured in the other's lid.";

constexpr const char* kFooter =
    R"(Of an SGF file the first game and its main line are read; boards have 5 to 19 lines.
What an error says begins with the file and the line to mend.

Examples:
  tessera-generate-go --game my_game.sgf --output build/release/share/tessera/scenes/go/generated
  tessera-generate-go --game my_game.sgf --moves 120 --output build/release/share/tessera/scenes/go/generated)";

struct Options {
  std::string game, output;
  std::optional<int> moves;
};

core::Status write_model(const std::string& folder, const std::string& name, const Model& model) {
  core::Status status;
  const auto write = [&](const std::string& file, const core::Result<std::string>& bytes) {
    if (!status) return;
    status = bytes ? core::write_file_atomically(folder + "/" + file, *bytes)
                   : core::Status(core::fail(bytes.error().within(file)));
  };
  const auto png = [](const core::Image& image) {
    return core::encode_image(image, core::ImageFormat::kPng);
  };
  if (!model.mesh.triangles.empty()) write(name + ".obj", modelling::obj_text(model.mesh));
  if (!model.color.pixels.empty()) write(name + ".png", png(model.color));
  if (!model.normals.pixels.empty()) write(name + "_normals.png", png(model.normals));
  return status;
}

core::Status generate(const Options& options) {
  const core::Result<std::string> text = core::read_file(options.game);
  if (!text) return core::fail(text.error());
  const core::Result<GameRecord> record = parse_sgf(*text, options.game);
  if (!record) return core::fail(record.error());
  const core::Result<Position> position = replay(*record, options.moves, options.game);
  if (!position) return core::fail(position.error());
  std::error_code failed;
  std::filesystem::create_directories(options.output, failed);
  for (const auto& [name, make] : setting(*position)) {
    const core::Status written = write_model(options.output, name, make());
    if (!written) return written;
  }
  fmt::print("{}\n", summary(*record, *position));
  return {};
}

int run(int argc, char** argv) {
  CLI::App app{kDescription, "tessera-generate-go"};
  app.footer(kFooter);
  Options options;
  app.add_option("--game", options.game, "The game's record")->type_name("FILE.sgf")->required();
  app.add_option("--output", options.output, "Folder to write into; made if it is not there")
      ->type_name("FOLDER")
      ->required();
  app.add_option("--moves", options.moves, "Stop after so many moves, passes included [all]")
      ->type_name("N")
      ->check(CLI::Range(0, 1000000));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& end) {
    return app.exit(end) == 0 ? 0 : 2;
  }
  const core::Status status = generate(options);
  if (!status) fmt::print(stderr, "tessera-generate-go: {}\n", status.error().message);
  return status ? 0 : 1;
}

}  // namespace
}  // namespace tessera::go

int main(int argc, char** argv) {
  return tessera::go::run(argc, argv);
}
