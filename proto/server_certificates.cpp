// SPDX-License-Identifier: Apache-2.0
#include "proto/server_certificates.hpp"

#include <fmt/format.h>
#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_credentials_options.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string_view>
#include <utility>

#include "core/common/pem.hpp"
#include "proto/security.hpp"

namespace tessera::proto {
namespace {

// How often gRPC reads the files in memory.
constexpr unsigned kWatchSeconds = 1;

core::Error system_error(const char* doing) {
  return {core::ErrorCode::kInternal, fmt::format("{}: {}", doing, std::strerror(errno))};
}

core::OpenFile memory_file(const char* name) {
  return core::OpenFile(::memfd_create(name, MFD_CLOEXEC));
}

// A name for gRPC, valid in this process while the file is open.
std::string path_of(const core::OpenFile& file) {
  return fmt::format("/proc/self/fd/{}", file.get());
}

core::Status replace(const core::OpenFile& file, std::string_view content) {
  if (::ftruncate(file.get(), 0) != 0) return core::fail(system_error("emptying a file in memory"));
  for (std::size_t done = 0; done < content.size();) {
    const ssize_t count =
        ::pwrite(file.get(), content.data() + done, content.size() - done, static_cast<off_t>(done));
    if (count < 0 && errno != EINTR) return core::fail(system_error("writing a file in memory"));
    if (count > 0) done += static_cast<std::size_t>(count);
  }
  return {};
}

}  // namespace

ServerCertificates::ServerCertificates(const ServerSecurity& security, core::OpenFile certificates,
                                       core::OpenFile key, core::OpenFile client_ca)
    : certificate_path_(security.certificate),
      key_path_(security.key),
      client_ca_path_(security.client_ca),
      certificates_(std::move(certificates)),
      key_(std::move(key)),
      client_ca_(std::move(client_ca)) {}

core::Result<std::shared_ptr<ServerCertificates>> ServerCertificates::open(const ServerSecurity& security) {
  core::OpenFile certificates = memory_file("certificates"), key = memory_file("key"),
                 client_ca = memory_file("client-ca");
  if (!certificates.valid() || !key.valid() || !client_ca.valid())
    return core::fail(system_error("creating a file in memory"));
  std::shared_ptr<ServerCertificates> opened(
      new ServerCertificates(security, std::move(certificates), std::move(key), std::move(client_ca)));
  if (auto loaded = opened->reload(); !loaded) return core::fail(loaded.error());
  return opened;
}

std::shared_ptr<grpc::ServerCredentials> ServerCertificates::credentials() const {
  namespace tls = grpc::experimental;
  const bool asks = !client_ca_path_.empty();
  tls::TlsServerCredentialsOptions options(std::make_shared<tls::FileWatcherCertificateProvider>(
      path_of(key_), path_of(certificates_), asks ? path_of(client_ca_) : "", kWatchSeconds));
  options.watch_identity_key_cert_pairs();
  if (asks) options.watch_root_certs();
  options.set_cert_request_type(asks ? GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY
                                     : GRPC_SSL_DONT_REQUEST_CLIENT_CERTIFICATE);
  return tls::TlsServerCredentials(options);
}

core::Result<ServerCertificates::Contents> ServerCertificates::read() const {
  auto mine = common::read_certificate_and_key(certificate_path_, key_path_);
  if (!mine) return core::fail(mine.error());
  Contents contents{std::move(mine->certificates), std::move(mine->key), {}};
  if (client_ca_path_.empty()) return contents;
  auto ca = common::read_certificates(client_ca_path_);
  if (!ca) return core::fail(ca.error());
  contents.client_ca = *std::move(ca);
  return contents;
}

core::Status ServerCertificates::reload() {
  const core::MutexLock one_at_a_time(reloading_);
  const auto contents = read();
  if (!contents) return core::fail(contents.error());
  if (auto replaced = replace(key_, contents->key); !replaced) return replaced;
  if (auto replaced = replace(certificates_, contents->certificates); !replaced) return replaced;
  return replace(client_ca_, contents->client_ca);
}

}  // namespace tessera::proto
