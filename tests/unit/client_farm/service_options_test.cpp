// SPDX-License-Identifier: Apache-2.0
#include "client/farm/service_options.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace tessera::client {
namespace {

ServiceOptions parse(std::vector<std::string> arguments) {
  CLI::App app;
  ServiceOptions options;
  add_service_options(app, "0", options);
  app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  return options;
}

std::string mistake(std::vector<std::string> arguments) {
  try {
    parse(std::move(arguments));
  } catch (const CLI::ParseError& e) {
    return e.what();
  }
  return "";
}

TEST(ServiceOptions, AreAbsentUnlessGiven) {
  const ServiceOptions none = parse({});
  EXPECT_FALSE(none.priority || none.max_workers);
  const ServiceOptions both = parse({"--priority", "-7", "--max-workers", "0"});
  EXPECT_EQ(both.priority, -7);
  EXPECT_EQ(both.max_workers, 0u);
}

TEST(ServiceOptions, ThatAreNoNumbersNameTheFlag) {
  for (const char* text : {"x", "1.5", "1 ", "2147483648", "-2147483649", "--1"}) {
    EXPECT_EQ(
        mistake({"--priority=" + std::string(text)}),
        "--priority: must be a whole number from -2147483648 to 2147483647; got '" + std::string(text) + "'");
  }
  for (const char* text : {"-1", "x", "4294967296"}) {
    EXPECT_EQ(mistake({"--max-workers", text}),
              "--max-workers: must be a whole number from 0 to 4294967295; got '" + std::string(text) + "'");
  }
}

}  // namespace
}  // namespace tessera::client
