// SPDX-License-Identifier: Apache-2.0
#include "core/http/request_target.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/host_port.hpp"
#include "core/http/server.hpp"

namespace tessera::http {
namespace {

using testing::ElementsAre;
using testing::Pair;

TEST(RequestTarget, IsDecoded) {
  const auto target = parse_target("/a%20b+c/%C3%A4?x=1%262&empty=&flag&y=a+b&x=2");
  ASSERT_TRUE(target);
  EXPECT_EQ(target->path, "/a b+c/ä");
  EXPECT_THAT(target->query,
              ElementsAre(Pair("empty", ""), Pair("flag", ""), Pair("x", "1&2"), Pair("y", "a b")));
}

TEST(RequestTarget, RejectsWhatIsMalformed) {
  for (const char* const text :
       {"", "jobs", "*", "http://host/", "/%", "/%2", "/%zz", "/%+1", "/%00", "/a%0ab", "/?x=%0d", "/?%7f"})
    EXPECT_FALSE(parse_target(text)) << text;
}

TEST(Request, FindsCookies) {
  Request request;
  request.headers["cookie"] = "a=1; tessera_session=x=y ;b=2";
  EXPECT_EQ(request.cookie("tessera_session"), "x=y");
  EXPECT_EQ(request.cookie("b"), "2");
  EXPECT_EQ(request.cookie("session"), "");
}

TEST(HostPort, KnowsLoopback) {
  for (const char* const address : {"127.0.0.1:80", "localhost:0", "[::1]:443", "127.8.0.1:1"}) {
    const auto parsed = core::parse_host_port(address);
    ASSERT_TRUE(parsed) << address;
    EXPECT_TRUE(core::is_loopback(*parsed)) << address;
  }
  EXPECT_FALSE(core::is_loopback(*core::parse_host_port("0.0.0.0:80")));
  EXPECT_FALSE(core::parse_host_port("::1:80"));
}

}  // namespace
}  // namespace tessera::http
