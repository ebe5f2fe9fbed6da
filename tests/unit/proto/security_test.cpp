// SPDX-License-Identifier: Apache-2.0
#include "proto/security.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace tessera::proto {
namespace {

using testing::HasSubstr;

std::string file_with(const std::string& name, const std::string& text) {
  const std::string path = testing::TempDir() + "security_test_" + name;
  std::ofstream(path) << text;
  return path;
}

TEST(Security, KnowsWhatOtherMachinesReach) {
  for (const char* address :
       {"127.0.0.1:7420", "127.8.9.1:1", "localhost:7420", "[::1]:7420", "unix:/tmp/socket"})
    EXPECT_TRUE(is_loopback(address)) << address;
  for (const char* address : {"0.0.0.0:7420", "10.0.0.1:7420", "render.example.org:7420", "[::]:7420",
                              "unixbox:7420", "127.0.0.1.example.org:7420", "127.example.org:7420"})
    EXPECT_FALSE(is_loopback(address)) << address;
}

TEST(Security, BeyondTheLoopbackGoingWithoutTlsMustBeAskedFor) {
  EXPECT_TRUE(channel_credentials("127.0.0.1:1", {}));
  EXPECT_TRUE(server_credentials("127.0.0.1:1", {}));
  const auto channel = channel_credentials("10.0.0.1:1", {});
  ASSERT_FALSE(channel);
  EXPECT_THAT(channel.error().message, HasSubstr("--tls-ca"));
  EXPECT_THAT(channel.error().message, HasSubstr("--insecure"));
  const auto server = server_credentials("0.0.0.0:1", {});
  ASSERT_FALSE(server);
  EXPECT_THAT(server.error().message, HasSubstr("--tls-certificate"));
  ClientSecurity client;
  client.insecure = true;
  EXPECT_TRUE(channel_credentials("10.0.0.1:1", client));
  ServerSecurity serving;
  serving.insecure = true;
  EXPECT_TRUE(server_credentials("0.0.0.0:1", serving));
}

TEST(Security, AddressesAreHostAndPort) {
  ClientSecurity client;
  ServerSecurity server;
  client.insecure = server.insecure = true;
  for (const char* address :
       {"", "7420", "localhost", "localhost:", ":7420", "localhost:x", "localhost:65536", "localhost:-1",
        "http://localhost:7420", "::1:7420", "[::1]", "localhost:7420 "}) {
    const auto calling = channel_credentials(address, client);
    ASSERT_FALSE(calling) << address;
    EXPECT_THAT(calling.error().message, HasSubstr("is not HOST:PORT, such as")) << address;
    const auto serving = server_credentials(address, server);
    ASSERT_FALSE(serving) << address;
    EXPECT_THAT(serving.error().message, HasSubstr("--listen: '")) << address;
  }
  for (const char* address : {"localhost:1", "10.0.0.1:65535", "[2001:db8::1]:7420", "unix:/tmp/socket",
                              "dns:///render.example.org:7420"})
    EXPECT_TRUE(channel_credentials(address, client)) << address;
}

TEST(Security, OptionsThatBelongTogetherAreAskedForTogether) {
  ClientSecurity client;
  client.certificate = "worker.pem";
  EXPECT_THAT(channel_credentials("127.0.0.1:1", client).error().message, HasSubstr("--tls-key"));
  client.key = "worker.key";
  EXPECT_THAT(channel_credentials("127.0.0.1:1", client).error().message, HasSubstr("--tls-ca"));
  ServerSecurity server;
  server.client_ca = "ca.pem";
  EXPECT_THAT(server_credentials("127.0.0.1:1", server).error().message, HasSubstr("--tls-certificate"));
}

TEST(Security, FilesThatAreNoCertificatesAreNamed) {
  ClientSecurity client;
  client.ca = testing::TempDir() + "not there.pem";
  EXPECT_THAT(channel_credentials("127.0.0.1:1", client).error().message, HasSubstr("not there.pem"));
  client.ca = file_with("junk.pem", "-----BEGIN CERTIFICATE-----\njunk\n-----END CERTIFICATE-----\n");
  const auto junk = channel_credentials("127.0.0.1:1", client);
  ASSERT_FALSE(junk);
  EXPECT_THAT(junk.error().message, HasSubstr("junk.pem: there is no certificate"));
}

TEST(Security, ATokenIsTheFirstLineOfItsFile) {
  EXPECT_EQ(*read_token(""), "");
  EXPECT_EQ(*read_token(file_with("token", "0123abcd-._~+/=\nmore\n")), "0123abcd-._~+/=");
  EXPECT_EQ(*read_token(file_with("dos", "secret\r\n")), "secret");
  for (const std::string& text : {std::string(), std::string("\n"), std::string("two words\n"),
                                  std::string("naïve\n"), std::string("secret\0\n", 8)}) {
    const auto token = read_token(file_with("bad", text));
    ASSERT_FALSE(token) << text;
    EXPECT_THAT(token.error().message, HasSubstr("security_test_bad"));
  }
}

}  // namespace
}  // namespace tessera::proto
