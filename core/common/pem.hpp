// SPDX-License-Identifier: Apache-2.0
// Reads and checks PEM files with certificates and keys at the start, so that an error names the file and
// does not appear later as a failed handshake. Stateless.
#pragma once

#include <string>

#include "core/base/error.hpp"

namespace tessera::common {

// The file's bytes. They must have at least one certificate, the first of which must be valid today. Errors
// name the file.
core::Result<std::string> read_certificates(const std::string& path);

struct CertificateAndKey {
  std::string certificates, key;  // PEM
};
// The same with the private key of the first certificate.
core::Result<CertificateAndKey> read_certificate_and_key(const std::string& certificate_path,
                                                         const std::string& key_path);

}  // namespace tessera::common
