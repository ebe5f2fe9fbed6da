// SPDX-License-Identifier: Apache-2.0
// The certificates of a coordinator, which can be replaced while it runs. gRPC watches files for new ones;
// here they are files in memory, whose contents change only after the new files were checked. Thread-safe.
#pragma once

#include <grpcpp/security/server_credentials.h>

#include <memory>
#include <string>

#include "core/base/error.hpp"
#include "core/base/mutex.hpp"
#include "core/base/open_file.hpp"

namespace tessera::proto {

struct ServerSecurity;

class ServerCertificates {
 public:
  // Reads the files of these options, which must name a certificate and its key. Errors name the file.
  static core::Result<std::shared_ptr<ServerCertificates>> open(const ServerSecurity& security);

  // For a server that ends before this object does.
  std::shared_ptr<grpc::ServerCredentials> credentials() const;

  // Reads the files again. Connections that begin some seconds later use the new contents; others go on.
  // After an error, which names the file, nothing has changed.
  core::Status reload();

 private:
  struct Contents {
    std::string certificates, key, client_ca;
  };

  ServerCertificates(const ServerSecurity& security, core::OpenFile certificates, core::OpenFile key,
                     core::OpenFile client_ca);
  core::Result<Contents> read() const;

  const std::string certificate_path_, key_path_, client_ca_path_;  // the last is empty if callers need none
  const core::OpenFile certificates_, key_, client_ca_;             // in memory
  core::Mutex reloading_;
};

}  // namespace tessera::proto
