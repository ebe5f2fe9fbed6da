// SPDX-License-Identifier: Apache-2.0
#include "proto/certificates.hpp"

#include <fmt/format.h>
#include <grpcpp/security/tls_credentials_options.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string_view>
#include <utility>

#include "core/common/pem.hpp"

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

Certificates::Certificates(Paths paths, core::OpenFile certificates, core::OpenFile key, core::OpenFile ca)
    : paths_(std::move(paths)),
      certificates_(std::move(certificates)),
      key_(std::move(key)),
      ca_(std::move(ca)) {}

core::Result<std::shared_ptr<Certificates>> Certificates::open(Paths paths) {
  core::OpenFile certificates = memory_file("certificates"), key = memory_file("key"), ca = memory_file("ca");
  if (!certificates.valid() || !key.valid() || !ca.valid())
    return core::fail(system_error("creating a file in memory"));
  std::shared_ptr<Certificates> opened(
      new Certificates(std::move(paths), std::move(certificates), std::move(key), std::move(ca)));
  if (auto loaded = opened->reload(); !loaded) return core::fail(loaded.error());
  return opened;
}

std::shared_ptr<grpc::experimental::CertificateProviderInterface> Certificates::provider() const {
  const bool has_own = !paths_.certificate.empty();
  return std::make_shared<grpc::experimental::FileWatcherCertificateProvider>(
      has_own ? path_of(key_) : "", has_own ? path_of(certificates_) : "",
      paths_.ca.empty() ? "" : path_of(ca_), kWatchSeconds);
}

std::shared_ptr<grpc::ServerCredentials> Certificates::server_credentials() const {
  const bool asks = !paths_.ca.empty();
  grpc::experimental::TlsServerCredentialsOptions options(provider());
  options.watch_identity_key_cert_pairs();
  if (asks) options.watch_root_certs();
  options.set_cert_request_type(asks ? GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY
                                     : GRPC_SSL_DONT_REQUEST_CLIENT_CERTIFICATE);
  return grpc::experimental::TlsServerCredentials(options);
}

std::shared_ptr<grpc::ChannelCredentials> Certificates::channel_credentials() const {
  grpc::experimental::TlsChannelCredentialsOptions options;
  options.set_certificate_provider(provider());
  options.watch_root_certs();
  if (!paths_.certificate.empty()) options.watch_identity_key_cert_pairs();
  return grpc::experimental::TlsCredentials(options);
}

core::Result<Certificates::Contents> Certificates::read() const {
  Contents contents;
  if (!paths_.certificate.empty()) {
    auto mine = common::read_certificate_and_key(paths_.certificate, paths_.key);
    if (!mine) return core::fail(mine.error());
    contents.certificates = std::move(mine->certificates);
    contents.key = std::move(mine->key);
  }
  if (paths_.ca.empty()) return contents;
  auto ca = common::read_certificates(paths_.ca);
  if (!ca) return core::fail(ca.error());
  contents.ca = *std::move(ca);
  return contents;
}

core::Status Certificates::reload() {
  const core::MutexLock one_at_a_time(reloading_);
  const auto contents = read();
  if (!contents) return core::fail(contents.error());
  if (auto replaced = replace(key_, contents->key); !replaced) return replaced;
  if (auto replaced = replace(certificates_, contents->certificates); !replaced) return replaced;
  return replace(ca_, contents->ca);
}

}  // namespace tessera::proto
