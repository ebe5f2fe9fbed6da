// SPDX-License-Identifier: Apache-2.0
// A certificate and its key: the input's two parts.
#include "core/common/pem.hpp"
#include "tests/fuzz/expect.hpp"
#include "tests/fuzz/fuzzer.hpp"
#include "tests/fuzz/parts.hpp"
#include "tests/fuzz/scratch_folder.hpp"

namespace tessera::fuzz {

TESSERA_FUZZER(pem, std::string_view input) {
  const auto parts = parts_of(input);
  const std::string certificate = scratch_file("certificate", parts.front().bytes);
  const std::string key = scratch_file("key", parts.back().bytes);
  expect_answer(common::read_certificate_and_key(certificate, key));
}

}  // namespace tessera::fuzz
