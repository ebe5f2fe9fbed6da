// SPDX-License-Identifier: Apache-2.0
// Certificates and keys in PEM files, read and checked before anybody relies on them, so that a mistake is
// told with the file's name and not as a failed handshake. Stateless.
#pragma once

#include <string>

#include "core/base/error.hpp"

namespace tessera::proto {

// The file's bytes, which hold at least one certificate, the first of them valid today. Errors name the file.
core::Result<std::string> read_certificates(const std::string& path);

struct CertificateAndKey {
  std::string certificates, key;  // PEM
};
// The same with the private key of the first certificate.
core::Result<CertificateAndKey> read_certificate_and_key(const std::string& certificate_path,
                                                         const std::string& key_path);

}  // namespace tessera::proto
