// SPDX-License-Identifier: Apache-2.0
// The coordinator's file of tokens and roles; the same bytes as a caller's token file and as an address.
#include "proto/security.hpp"
#include "server/auth/access.hpp"
#include "tests/fuzz/expect.hpp"
#include "tests/fuzz/parts.hpp"
#include "tests/fuzz/scratch_folder.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tessera;
  const std::string_view bytes = fuzz::as_text(data, size);
  const std::string file = fuzz::scratch_file("tokens", bytes);
  fuzz::expect_answer(auth::Access::read(file));
  const auto token = proto::read_token(file);
  if (fuzz::expect_answer(token)) fuzz::expect(proto::is_token(*token), "what is read is a token");
  if (proto::is_loopback(std::string(bytes)))
    fuzz::expect(bytes.find("0.0.0.0") != 0, "an address of all networks is not the loopback");
  return 0;
}
