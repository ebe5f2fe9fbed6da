// SPDX-License-Identifier: Apache-2.0
// The certificate with which a worker serves others. It is made for one process: the coordinator passes it on
// to those who connect, who trust no other one at this address.
#pragma once

#include <string>

namespace tessera::worker {

struct PeerCertificate {
  std::string certificate_pem, key_pem;
};

// A self-signed certificate for the name proto::kPeerName, with a new P-256 key. Throws std::runtime_error if
// the library cannot make one. Thread-safe.
PeerCertificate make_peer_certificate();

}  // namespace tessera::worker
