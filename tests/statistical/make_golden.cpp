// SPDX-License-Identifier: Apache-2.0
// Makes golden images anew: tessera_make_golden NAME... (all, if none is named). See golden.hpp.
#include <fmt/format.h>

#include <string>
#include <vector>

#include "core/image/encode.hpp"
#include "core/image/file_io.hpp"
#include "tests/statistical/golden.hpp"
#include "tests/statistical/shipped_scenes.hpp"

namespace {

using namespace tessera;

core::Status write(const std::string& path, const core::Image& image) {
  const auto bytes = core::encode_image(image, core::ImageFormat::kExr);
  if (!bytes) return core::fail(bytes.error());
  return core::write_file_atomically(path, *bytes);
}

core::Status make_golden(const std::string& name) {
  const auto scene = core::Scene::build(test::load_shipped_scene(name), 2);
  if (!scene) return core::fail(scene.error());
  const test::Golden golden = test::render_golden(*scene, 0, test::kReferenceBatches);
  if (auto ok = write(test::golden_mean_path(name), golden.mean); !ok) return ok;
  return write(test::golden_variance_path(name), golden.variance);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> names(argv + 1, argv + argc);
  if (names.empty()) names = test::shipped_scenes();
  for (const std::string& name : names) {
    fmt::print("{}\n", name);
    if (const auto ok = make_golden(name); !ok) {
      fmt::print(stderr, "tessera_make_golden: {}: {}\n", name, ok.error().message);
      return 1;
    }
  }
}
