// SPDX-License-Identifier: Apache-2.0
#include "server/validator/options.hpp"

#include <CLI/CLI.hpp>
#include <cstdlib>

#include "core/base/version.hpp"
#include "core/cli/help.hpp"
#include "core/cli/parse.hpp"
#include "server/validator/flags.hpp"

namespace tessera::validator {

namespace {

const cli::HelpText kHelp{
    .notes =
        R"(Reads a serialised request on stdin and answers on stdout. The coordinator starts one process for every submitted
scene. The process gives up all rights that it does not need,
loads the scene and ends.)",
    .exit_statuses = {{cli::kExitOk, "answered, whether the scene is valid or not"},
                      {cli::kExitFailed, "failed"},
                      {cli::kExitUsage, "wrong command line"}}};

// Limits on scenes have the coordinator's option names.
void add_limit(CLI::App& app, const char* flag, core::SceneLimit& limit, const char* what) {
  app.add_option(flag, limit.most, what)->type_name("N");
  limit.option = std::string("tessera-coordinator ") + flag;
}

}  // namespace

Options parse_options(int argc, char** argv) {
  Options options;
  CLI::App app("Validate a scene for tessera-coordinator", "tessera-validator");
  cli::set_help(app, kHelp);
  app.set_version_flag("--version", "tessera-validator " + std::string(core::version()), "Print the version");
  sandbox::add_flags(app, options.sandbox, {.memory_mib = kMemoryFlag, .cpu_seconds = kSecondsFlag});
  add_limit(app, kTrianglesFlag, options.scene.triangles,
            "Maximum triangles of a scene's meshes [default: no limit]");
  add_limit(app, kLightsFlag, options.scene.lights,
            "Maximum lights of a scene, emissive triangles of every instance included [default: no limit]");
  add_limit(app, kTexturePixelsFlag, options.scene.texture_pixels,
            "Maximum pixels of a texture [default: no limit]");
  add_limit(app, kSceneTexturePixelsFlag, options.scene.scene_texture_pixels,
            "Maximum pixels of all textures of a scene [default: no limit]");
  if (const auto ended = cli::parse(app, argc, argv, "tessera-validator")) std::exit(*ended);
  return options;
}

}  // namespace tessera::validator
