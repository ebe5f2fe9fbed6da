// SPDX-License-Identifier: Apache-2.0
// tessera-validator: see options.hpp. The coordinator starts one for every submitted scene, so that a hostile
// file can crash only this process.
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

#include "server/validator/options.hpp"
#include "server/validator/validate.hpp"
#include "server/validator/visible_files.hpp"

namespace {

using namespace tessera::validator;

int fail(const std::string& why) {
  std::cerr << "tessera-validator: " << why << '\n';
  return EXIT_FAILURE;
}

std::vector<std::string> paths_of(const ValidateRequest& request) {
  std::vector<std::string> paths;
  for (const auto& [name, path] : request.files()) paths.push_back(path);
  return paths;
}

}  // namespace

#ifdef TESSERA_SANITIZED
// A confined process may not trace its own threads, as the leak check at exit does.
extern "C" int __lsan_is_turned_off() {
  return 1;
}
#endif

int main(int argc, char** argv) {
  const Options options = parse_options(argc, argv);
  if (const auto confined = confine(options.confinement); !confined) return fail(confined.error().message);
  ValidateRequest request;
  if (!request.ParseFromIstream(&std::cin))
    return fail("reads one serialised tessera.validator.ValidateRequest; the coordinator starts it");
  if (const auto seen = see_only(paths_of(request)); !seen) return fail(seen.error().message);
  const ValidateResponse response = validate(request, options);
  return response.SerializeToOstream(&std::cout) && std::cout.flush() ? EXIT_SUCCESS : EXIT_FAILURE;
}
