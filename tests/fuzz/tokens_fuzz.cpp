// SPDX-License-Identifier: Apache-2.0
// The coordinator's file of tokens and roles; the same bytes as a caller's token file and as an address.
#include "proto/security.hpp"
#include "server/auth/access.hpp"
#include "tests/fuzz/expect.hpp"
#include "tests/fuzz/fuzzer.hpp"
#include "tests/fuzz/scratch_folder.hpp"

namespace tessera::fuzz {

TESSERA_FUZZER(tokens, std::string_view bytes) {
  const std::string file = scratch_file("tokens", bytes);
  expect_answer(auth::Access::read(file));
  const auto token = proto::read_token(file);
  if (expect_answer(token)) expect(proto::is_token(*token), "what is read is a token");
  if (proto::is_loopback(std::string(bytes)))
    expect(bytes.find("0.0.0.0") != 0, "an address of all networks is not the loopback");
}

}  // namespace tessera::fuzz
