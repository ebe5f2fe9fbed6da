// SPDX-License-Identifier: Apache-2.0
// A certificate and its key: the input's two parts.
#include "core/common/pem.hpp"
#include "tests/fuzz/expect.hpp"
#include "tests/fuzz/parts.hpp"
#include "tests/fuzz/scratch_folder.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tessera;
  const auto parts = fuzz::parts_of(fuzz::as_text(data, size));
  const std::string certificate = fuzz::scratch_file("certificate", parts.front().bytes);
  const std::string key = fuzz::scratch_file("key", parts.back().bytes);
  fuzz::expect_answer(common::read_certificate_and_key(certificate, key));
  return 0;
}
