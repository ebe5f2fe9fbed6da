// SPDX-License-Identifier: Apache-2.0
#include "tests/documentation/render_command.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "core/image/decode.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/client/process.hpp"

namespace tessera::test {
namespace {

constexpr const char* kTutorialScene = "first.json";

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream words(text);
  return {std::istream_iterator<std::string>(words), {}};
}

RenderCommand parse(const std::string& line) {
  std::vector<std::string> words = words_of(line);
  if (words.size() < 5 || words[0] != "tessera" || words[1] != "render" || words[words.size() - 2] != "-o")
    throw std::runtime_error(
        "docs/images/commands.txt: not 'tessera render SCENE [OPTION VALUE]... -o NAME': " + line);
  return {line, words[2], {words.begin() + 3, words.end() - 2}, words.back()};
}

// The scene that docs/scene-format.md begins with.
std::string tutorial_scene() {
  const std::string page = read_file(TESSERA_SOURCE_DIR "/docs/scene-format.md"), fence = "```jsonc\n";
  const std::size_t begin = page.find(fence) + fence.size();
  return page.substr(begin, page.find("```", begin) - begin);
}

// Its own options but for those that `changes` has, then these.
std::vector<std::string> changed_options(const RenderCommand& command,
                                         const std::vector<std::string>& changes) {
  std::vector<std::string> options;
  for (std::size_t i = 0; i + 1 < command.options.size(); i += 2)
    if (std::find(changes.begin(), changes.end(), command.options[i]) == changes.end())
      options.insert(options.end(), {command.options[i], command.options[i + 1]});
  options.insert(options.end(), changes.begin(), changes.end());
  return options;
}

}  // namespace

std::vector<RenderCommand> documented_commands() {
  std::ifstream file(TESSERA_SOURCE_DIR "/docs/images/commands.txt");
  std::vector<RenderCommand> commands;
  for (std::string line; std::getline(file, line);)
    if (!line.empty() && line[0] != '#') commands.push_back(parse(line));
  return commands;
}

std::string option_value(const RenderCommand& command, const std::string& option) {
  const auto found = std::find(command.options.begin(), command.options.end(), option);
  return found == command.options.end() ? "" : *std::next(found);
}

core::Image render(const RenderCommand& command, const std::vector<std::string>& changes) {
  const TemporaryFolder folder;
  std::string scene = command.scene;
  if (scene == kTutorialScene) {
    scene = folder.path() / kTutorialScene;
    write_file(scene, tutorial_scene());
  }
  const std::string image = folder.path() / "image.png";
  std::vector<std::string> arguments{"render", scene, "-q", "-o", image};
  const std::vector<std::string> options = changed_options(command, changes);
  arguments.insert(arguments.end(), options.begin(), options.end());
  const client::ProcessResult result = client::run_tessera(arguments);
  if (result.exit_status != 0) throw std::runtime_error(command.text + ": " + result.err);
  return core::read_image(image).value();
}

}  // namespace tessera::test
