#include "server/validator/options.hpp"

#include <CLI/CLI.hpp>
#include <cstdlib>

#include "core/base/version.hpp"
#include "server/validator/flags.hpp"

namespace tessera::validator {

namespace {

constexpr int kExitUsage = 2;

// Options of the scene have the coordinator's names.
void add_limit(CLI::App& app, const char* flag, core::SceneLimit& limit, const char* what) {
  app.add_option(flag, limit.most, what)->type_name("N");
  limit.option = std::string("tessera-coordinator ") + flag;
}

}  // namespace

Options parse_options(int argc, char** argv) {
  Options options;
  Confinement& confinement = options.confinement;
  CLI::App app(
      "Reads one serialised tessera.validator.Question on standard input, loads its scene and answers with a "
      "Verdict on standard output. The coordinator starts one for every scene that is submitted.");
  app.set_version_flag("--version", "tessera-validator " + std::string(core::version()));
  app.add_option(kMemoryFlag, confinement.memory_mib, "Memory it may take (addresses)")
      ->type_name("N")
      ->capture_default_str();
  app.add_option(kSecondsFlag, confinement.cpu_seconds, "Processor time it may take")
      ->type_name("N")
      ->capture_default_str();
  app.add_option(kParentFlag, confinement.parent, "Ends with this process")->type_name("PID");
  add_limit(app, kTrianglesFlag, options.scene.triangles, "Triangles of a scene's meshes");
  add_limit(app, kTexturePixelsFlag, options.scene.texture_pixels, "Pixels of a texture");
  add_limit(app, kSceneTexturePixelsFlag, options.scene.scene_texture_pixels,
            "Pixels of all textures of a scene");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error) == EXIT_SUCCESS ? EXIT_SUCCESS : kExitUsage);
  }
  return options;
}

}  // namespace tessera::validator
