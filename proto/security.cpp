// SPDX-License-Identifier: Apache-2.0
#include "proto/security.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdint>

#include "core/common/pem.hpp"
#include "core/image/file_io.hpp"
#include "proto/certificates.hpp"

namespace tessera::proto {
namespace {

using core::ErrorCode;

// Address schemes of gRPC for sockets of this machine, which have no port.
bool is_local_socket(const std::string& address) {
  return address.starts_with("unix:") || address.starts_with("unix-abstract:");
}

core::Status check_form(const std::string& address) {
  if (is_local_socket(address)) return {};
  const std::size_t colon = std::min(address.rfind(':'), address.size());
  const char* const end = address.data() + address.size();
  std::uint16_t port = 0;
  const auto [rest, error] = std::from_chars(address.data() + std::min(colon + 1, address.size()), end, port);
  const bool brackets = address.starts_with('[') && colon > 0 && address[colon - 1] == ']';
  const bool one_colon = address.find(':') == colon || brackets || address.starts_with("dns:///");
  if (colon > 0 && one_colon && error == std::errc() && rest == end) return {};
  return core::fail(
      ErrorCode::kInvalidArgument,
      fmt::format("'{}' is not HOST:PORT, such as render.example.org:7420, 127.0.0.1:7420 or [::1]:7420",
                  address));
}

core::Status both_or_neither(const std::string& certificate, const std::string& key) {
  if (certificate.empty() == key.empty()) return {};
  return core::fail(ErrorCode::kInvalidArgument,
                    "--tls-certificate and --tls-key belong together: give both or neither");
}

// Checks an address that other machines can reach for use without TLS.
core::Status allow_plain(const std::string& address, bool insecure, const char* how) {
  if (is_loopback(address) || insecure) return {};
  return core::fail(
      ErrorCode::kInvalidArgument,
      fmt::format("{} is not of this machine alone, and there is no TLS: {}, or --insecure on a "
                  "network where you trust everybody",
                  address, how));
}

// Checks an address that other machines can reach for use without client certificates.
core::Status allow_unauthenticated(const std::string& address, const ServerSecurity& security) {
  if (!security.client_ca.empty() || is_loopback(address) || security.allow_unauthenticated) return {};
  return core::fail(
      ErrorCode::kInvalidArgument,
      fmt::format("{} is not of this machine alone, and callers need no certificate: give --tls-client-ca "
                  "(deploy/make_certificates.sh makes a certificate for each machine and person); or "
                  "--allow-unauthenticated-connections, and then anybody who reaches the port can stop the "
                  "coordinator by using up its memory, whatever --tokens says",
                  address));
}

}  // namespace

bool is_loopback(const std::string& address) {
  if (is_local_socket(address)) return true;
  const std::string host = address.substr(0, address.find_last_of(':'));
  in_addr numeric{};
  const bool is_127 = inet_pton(AF_INET, host.c_str(), &numeric) == 1 && host.rfind("127.", 0) == 0;
  return is_127 || host == "localhost" || host == "[::1]";
}

bool is_token(std::string_view text) {
  constexpr std::string_view kBesides = "-._~+/=";
  return !text.empty() && std::all_of(text.begin(), text.end(), [&](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || kBesides.find(c) != std::string_view::npos;
  });
}

core::Result<std::shared_ptr<grpc::ChannelCredentials>> channel_credentials(const std::string& address,
                                                                            const ClientSecurity& security) {
  if (const auto formed = check_form(address); !formed) return core::fail(formed.error());
  if (const auto paired = both_or_neither(security.certificate, security.key); !paired)
    return core::fail(paired.error());
  if (security.ca.empty()) {
    if (!security.certificate.empty())
      return core::fail(ErrorCode::kInvalidArgument, "--tls-certificate is of no use without --tls-ca");
    if (const auto plain = allow_plain(address, security.insecure, "give --tls-ca"); !plain)
      return core::fail(plain.error());
    return grpc::InsecureChannelCredentials();
  }
  grpc::SslCredentialsOptions options;
  auto ca = common::read_certificates(security.ca);
  if (!ca) return core::fail(ca.error());
  options.pem_root_certs = *std::move(ca);
  if (!security.certificate.empty()) {
    auto mine = common::read_certificate_and_key(security.certificate, security.key);
    if (!mine) return core::fail(mine.error());
    options.pem_cert_chain = std::move(mine->certificates);
    options.pem_private_key = std::move(mine->key);
  }
  return grpc::SslCredentials(options);
}

core::Result<ServerCredentials> server_credentials(const std::string& address,
                                                   const ServerSecurity& security) {
  if (const auto formed = check_form(address); !formed) return core::fail(formed.error().within("--listen"));
  if (const auto paired = both_or_neither(security.certificate, security.key); !paired)
    return core::fail(paired.error());
  if (security.certificate.empty()) {
    if (!security.client_ca.empty())
      return core::fail(ErrorCode::kInvalidArgument,
                        "--tls-client-ca is of no use without --tls-certificate and --tls-key");
    if (const auto plain = allow_plain(address, security.insecure, "give --tls-certificate and --tls-key");
        !plain)
      return core::fail(plain.error());
    return ServerCredentials{grpc::InsecureServerCredentials()};
  }
  if (const auto allowed = allow_unauthenticated(address, security); !allowed)
    return core::fail(allowed.error());
  auto certificates = Certificates::open({security.certificate, security.key, security.client_ca});
  if (!certificates) return core::fail(certificates.error());
  return ServerCredentials{(*certificates)->server_credentials(), *certificates};
}

core::Result<std::string> read_token(const std::string& path) {
  if (path.empty()) return std::string();
  const auto text = core::read_file(path);
  if (!text) return core::fail(text.error());
  const std::string token = text->substr(0, text->find_first_of("\r\n"));
  if (!is_token(token)) {
    return core::fail(ErrorCode::kInvalidArgument,
                      fmt::format("{}: the first line must be a token of letters, digits and -._~+/=", path));
  }
  return token;
}

}  // namespace tessera::proto
