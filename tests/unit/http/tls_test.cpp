// SPDX-License-Identifier: Apache-2.0
// With certificates of deploy/make_certificates.sh, and openssl as the client.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include "tests/support/temporary_folder.hpp"
#include "tests/unit/http/raw_client.hpp"

namespace tessera::http {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string output_of(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen(command.c_str(), "r"), &::pclose);
  std::string output;
  std::array<char, 4096> some{};
  for (std::size_t count; pipe && (count = std::fread(some.data(), 1, some.size(), pipe.get())) > 0;)
    output.append(some.data(), count);
  return output;
}

class HttpTls : public testing::Test {
 protected:
  // Making certificates takes longer than the tests.
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    const std::string script = TESSERA_SOURCE_DIR "/deploy/make_certificates.sh";
    for (const std::string name : {"farm", "other"})
      EXPECT_EQ(std::system(("bash '" + script + "' '" + file(name) + "' 127.0.0.1 >/dev/null 2>&1").c_str()),
                0);
  }
  static void TearDownTestSuite() { folder_.reset(); }

  HttpTls() {
    handler_.on_handle = [](const Request& request) {
      return Response{.body = (request.is_secure ? "secure " : "open ") + request.client_name};
    };
  }

  static std::string file(const std::string& name) { return (folder_->path() / name).string(); }
  static std::string pem(const std::string& name) { return read_file(folder_->path() / name); }

  ServerOptions options() const { return {.address = {}, .tls = tls_of("farm")}; }
  static TlsOptions tls_of(const std::string& farm) {
    return {.certificate_pem = pem(farm + "/coordinator.pem"),
            .key_pem = pem(farm + "/coordinator.key"),
            .client_ca_pem = pem(farm + "/ca.pem")};
  }

  std::string get_over_tls(const Server& server, const std::string& more,
                           const std::string& farm = "farm") const {
    return output_of(
        "printf 'GET / HTTP/1.1\\r\\nHost: test\\r\\nConnection: close\\r\\n\\r\\n' | timeout 20 "
        "openssl s_client -quiet -verify_return_error -CAfile '" +
        file(farm + "/ca.pem") + "' -connect " + server.address() + " " + more + " 2>/dev/null");
  }

  std::string certificate(const std::string& stem) const {
    return "-cert '" + file(stem + ".pem") + "' -key '" + file(stem + ".key") + "'";
  }

  inline static std::unique_ptr<TemporaryFolder> folder_;
  FunctionHandler handler_;
};

TEST_F(HttpTls, ServesWithACertificate) {
  ServerOptions without_client_ca = options();
  without_client_ca.tls.client_ca_pem.clear();
  const auto server = start_server(handler_, without_client_ca);
  EXPECT_THAT(get_over_tls(*server, ""), HasSubstr("\r\n\r\nsecure "));
  EXPECT_THAT(get_over_tls(*server, "-tls1_1"), Not(HasSubstr("secure")));
  EXPECT_THAT(get(server->address(), "/"), Not(HasSubstr("open")));
}

TEST_F(HttpTls, NamesClientsWithACertificateOfTheFarm) {
  const auto server = start_server(handler_, options());
  EXPECT_THAT(get_over_tls(*server, certificate("farm/client")), HasSubstr("\r\n\r\nsecure client"));
  EXPECT_THAT(get_over_tls(*server, ""), HasSubstr("HTTP/1.1 403"));
  EXPECT_THAT(get_over_tls(*server, certificate("other/client")), Not(HasSubstr("secure")));
}

// openssl shows its certificate only to servers that name no CAs, or its own.
TEST_F(HttpTls, ReplacesItsCertificatesForNewConnections) {
  const auto server = start_server(handler_, options());
  TlsOptions wrong = tls_of("other");
  wrong.key_pem = pem("farm/coordinator.key");
  EXPECT_FALSE(server->replace_certificates(wrong));
  EXPECT_THAT(get_over_tls(*server, certificate("farm/client")), HasSubstr("\r\n\r\nsecure client"));
  ASSERT_TRUE(server->replace_certificates(tls_of("other")));
  EXPECT_THAT(get_over_tls(*server, certificate("other/client"), "other"),
              HasSubstr("\r\n\r\nsecure client"));
  EXPECT_THAT(get_over_tls(*server, certificate("farm/client"), "other"), Not(HasSubstr("secure")));
  EXPECT_THAT(get_over_tls(*server, certificate("farm/client")), Not(HasSubstr("secure")))
      << "its certificate is of another authority";
}

TEST_F(HttpTls, SaysIfTheKeyIsWrong) {
  ServerOptions wrong = options();
  wrong.address = "127.0.0.1:0";
  wrong.tls.key_pem = "no key";
  const auto server = Server::start(wrong, handler_);
  ASSERT_FALSE(server);
  EXPECT_THAT(server.error().message, HasSubstr("cannot serve HTTPS on 127.0.0.1:"));
}

}  // namespace
}  // namespace tessera::http
