// SPDX-License-Identifier: Apache-2.0
#include "proto/peer_ticket.hpp"

#include <fmt/format.h>
#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>

#include <array>
#include <new>

namespace tessera::proto {

v1::PeerTicket sign_ticket(const std::string& key, const Digest& blob, const Segment& segment,
                           std::uint64_t expires_seconds) {
  // The first word separates this use of the key from others.
  const std::string message = fmt::format("segment {} {} {} {}", blob_name(blob), segment.offset_bytes,
                                          segment.size_bytes, expires_seconds);
  std::array<unsigned char, EVP_MAX_MD_SIZE> code{};
  unsigned size = 0;
  const void* const made =
      HMAC(EVP_sha256(), key.data(), static_cast<int>(key.size()),
           reinterpret_cast<const unsigned char*>(message.data()), message.size(), code.data(), &size);
  if (made == nullptr) throw std::bad_alloc();  // only lack of memory makes it fail
  v1::PeerTicket ticket;
  ticket.set_expires_seconds(expires_seconds);
  ticket.set_signature(code.data(), size);
  return ticket;
}

bool is_valid(const v1::PeerTicket& ticket, const std::string& key, const Digest& blob,
              const Segment& segment, std::uint64_t now_seconds) {
  if (ticket.expires_seconds() < now_seconds) return false;
  const std::string expected = sign_ticket(key, blob, segment, ticket.expires_seconds()).signature();
  return ticket.signature().size() == expected.size() &&
         CRYPTO_memcmp(ticket.signature().data(), expected.data(), expected.size()) == 0;
}

}  // namespace tessera::proto
