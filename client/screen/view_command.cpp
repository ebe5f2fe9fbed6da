// SPDX-License-Identifier: Apache-2.0
#include "client/screen/view_command.hpp"

#include <fmt/format.h>

#include <memory>

#include "client/console.hpp"
#include "client/image_layers.hpp"
#include "client/scene_flags.hpp"
#include "client/screen/image_facts.hpp"
#include "client/screen/screen.hpp"

namespace tessera::client {

CLI::App* add_view_options(CLI::App& app, const std::string& what, ViewOptions& options) {
  CLI::App* command = app.add_subcommand("view", "Show an image in the terminal");
  command->add_option("IMAGE", options.image, what)->required();
  add_display_options(*command, options.display);
  command
      ->add_option_function<std::string>(
          "--protocol",
          [&options](const std::string& name) {
            options.graphics = graphics_from_name(name);
            if (!options.graphics && name != "auto")
              throw CLI::ValidationError("--protocol",
                                         fmt::format("must be auto, blocks, kitty or sixel; got '{}'", name));
          },
          "How the terminal is drawn to: half blocks in 24-bit colour, the graphics of kitty, or sixels; "
          "auto asks the terminal [default: auto]")
      ->type_name("auto|blocks|kitty|sixel");
  command
      ->add_option(
          "--layer", options.layer,
          "Show this layer of an .exr file or of a job, such as normal; of a file also by the name in "
          "it, such as DiffCol, or one channel, such as Normal.X")
      ->type_name("NAME");
  command->add_flag("--json", options.json,
                    "Print the size of the image and the least, mean and greatest linear values of its "
                    "channels, instead of showing it: one JSON object, and for a job one at each change");
  return command;
}

int view_file(const ViewOptions& options) {
  const auto file = ImageFile::read(options.image);
  if (!file) return print_error(file.error());
  const auto image = file->decode(options.layer);
  if (!image) return print_error(image.error());
  if (options.json) {
    print_result(image_facts(options.image, *image)
                     .dump(-1, ' ', true, nlohmann::ordered_json::error_handler_t::replace) +
                 "\n");
    return kExitOk;
  }
  const auto display = core::resolve_display({}, options.display);
  if (!display) return print_error(display.error());
  auto screen = Screen::open(options.graphics);
  if (!screen) return print_error(screen.error());
  const std::string caption = fmt::format("{}  {}x{} pixels", options.image, image->width, image->height);
  const core::Status shown = screen->show(*image, *display, caption, false);
  screen->close();
  return shown ? kExitOk : print_error(shown.error());
}

void add_view_command(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<ViewOptions>();
  CLI::App* command = add_view_options(app, "Image file: .png, .exr, .hdr or .pfm", *options);
  cli::set_help(*command, {.exit_statuses = kUsualExitStatuses, .examples = {"tessera view image.exr"}});
  command->callback([options, &exit_code] { exit_code = view_file(*options); });
}

}  // namespace tessera::client
