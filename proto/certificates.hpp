// SPDX-License-Identifier: Apache-2.0
// The certificates of a process, which can be replaced while it runs. gRPC watches files for new ones; here
// they are files in memory, whose contents change only after the new files were checked. Thread-safe.
#pragma once

#include <grpcpp/security/credentials.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/security/tls_certificate_provider.h>

#include <memory>
#include <string>

#include "core/base/error.hpp"
#include "core/base/mutex.hpp"
#include "core/base/open_file.hpp"

namespace tessera::proto {

class Certificates {
 public:
  // PEM files; an empty path means that the file is not used.
  struct Paths {
    std::string certificate{}, key{};  // of this process; both or neither
    std::string ca{};                  // the authority of its peers' certificates
  };

  // Reads the files. Errors name the file.
  static core::Result<std::shared_ptr<Certificates>> open(Paths paths);

  // For a server that ends before this object does. It needs a certificate; it requests those of its callers
  // if there is an authority.
  std::shared_ptr<grpc::ServerCredentials> server_credentials() const;
  // For channels that end before this object does. They need an authority.
  std::shared_ptr<grpc::ChannelCredentials> channel_credentials() const;

  // Reads the files again. Connections that begin some seconds later use the new contents; others go on.
  // After an error, which names the file, nothing has changed.
  core::Status reload();

 private:
  struct Contents {
    std::string certificates, key, ca;
  };

  Certificates(Paths paths, core::OpenFile certificates, core::OpenFile key, core::OpenFile ca);
  core::Result<Contents> read() const;
  std::shared_ptr<grpc::experimental::CertificateProviderInterface> provider() const;

  const Paths paths_;
  const core::OpenFile certificates_, key_, ca_;  // in memory
  core::Mutex reloading_;
};

}  // namespace tessera::proto
