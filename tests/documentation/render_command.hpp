// SPDX-License-Identifier: Apache-2.0
// The commands that render the images of the documentation (docs/images/commands.txt), for the tests that
// compare the images with what the commands render.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "core/image/image.hpp"

namespace tessera::test {

struct RenderCommand {
  std::string text;                  // as docs/images/commands.txt and the pages have it
  std::string scene;                 // the name or file that it renders
  std::vector<std::string> options;  // without -o
  std::string image_name;            // the file of -o, in docs/images
};

// For GoogleTest.
inline void PrintTo(const RenderCommand& command, std::ostream* out) {
  *out << command.text;
}

// All of docs/images/commands.txt. Throws std::runtime_error for a line that is not `tessera render SCENE ...
// -o NAME`.
std::vector<RenderCommand> documented_commands();

// The value of an option such as "--spp"; empty if the command does not have it.
std::string option_value(const RenderCommand& command, const std::string& option);

// The PNG image that the command renders when `changes`, options with their values, replace its own. Throws
// std::runtime_error with the program's messages if it fails.
core::Image render(const RenderCommand& command, const std::vector<std::string>& changes);

}  // namespace tessera::test
