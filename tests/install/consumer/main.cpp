// SPDX-License-Identifier: Apache-2.0
// consumer SCENE IMAGE: renders a scene small with libtessera, by its installed header alone.
#include <cstdio>
#include <exception>
#include <tessera/tessera.hpp>

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  try {
    tessera::RenderOptions options;
    options.width = 48;
    options.height = 32;
    options.spp = 4;
    tessera::write_image(tessera::Scene::load(argv[1]).render(options), argv[2]);
    std::printf("libtessera %s\n", tessera::version().c_str());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "consumer: %s\n", error.what());
    return 1;
  }
}
