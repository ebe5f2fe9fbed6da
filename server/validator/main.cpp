// SPDX-License-Identifier: Apache-2.0
// tessera-validator: see options.hpp. The coordinator starts one for every submitted scene, so that a hostile
// file can crash only this process.
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "core/cli/parse.hpp"
#include "core/sandbox/bundle_files.hpp"
#include "server/validator/options.hpp"
#include "server/validator/validate.hpp"

namespace {

using namespace tessera;

constexpr const char* kProgram = "tessera-validator";

std::vector<std::string> names_of(const v1::Bundle& bundle) {
  std::vector<std::string> names;
  for (const v1::Bundle::Asset& asset : bundle.assets()) names.push_back(asset.path());
  return names;
}

}  // namespace

#ifdef TESSERA_SANITIZED
// A confined process may not trace its own threads, as the leak check at exit does.
extern "C" int __lsan_is_turned_off() {
  return 1;
}
#endif

int main(int argc, char** argv) {
  const validator::Options options = validator::parse_options(argc, argv);
  if (const auto ended = sandbox::confine_or_end(options.sandbox, kProgram)) return *ended;
  validator::ValidateRequest request;
  const auto bytes = core::read_asset(core::OpenFile(STDIN_FILENO), "the request");
  if (!bytes || !request.ParseFromString(*bytes))
    return cli::print_error(
        kProgram,
        "stdin must have one serialised tessera.validator.ValidateRequest; the coordinator starts it");
  core::BundleAssets assets = sandbox::bundle_files(names_of(request.bundle()));
  const validator::ValidateResponse response = validator::validate(request, assets, options);
  return response.SerializeToFileDescriptor(STDOUT_FILENO) ? EXIT_SUCCESS : EXIT_FAILURE;
}
