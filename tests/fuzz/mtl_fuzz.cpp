// A material library.
#include "core/scene/loader/mtl_reader.hpp"
#include "tests/fuzz/expect.hpp"
#include "tests/fuzz/parts.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto materials = tessera::core::read_mtl(tessera::fuzz::as_text(data, size), "x.mtl");
  if (!tessera::fuzz::expect_answer(materials)) {
    tessera::fuzz::expect(materials.error().message.starts_with("x.mtl:"), "an error names file and line");
  }
  return 0;
}
