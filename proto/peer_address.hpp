// SPDX-License-Identifier: Apache-2.0
// The keys by which machines are told apart. Pure functions.
#pragma once

#include <sys/socket.h>

#include <string>

namespace tessera::proto {

// The key of a peer's machine: "10.0.0.5", or the upper 64 bits of an IPv6 address, since one host can use
// every address below that prefix.
std::string address_key(const sockaddr_storage& peer);
// The same of a peer as gRPC names it: "ipv4:10.0.0.5:4242", "ipv6:[2001:db8::5]:4242", or with %5B and %5D
// for the brackets. Of any other text, the part before the last colon.
std::string address_key(const std::string& peer);
// The host of a peer as gRPC names it, as in HOST:PORT: "10.0.0.5", "[2001:db8::5]". IPv4 addresses within
// IPv6 are written as such. Empty for link-local addresses, which mean nothing elsewhere, and for any other
// text.
std::string host_of(const std::string& peer);
// Whether it is an address of the loopback.
bool is_loopback_host(const std::string& host);
// The same key for a peer that did not call by gRPC. IPv4 addresses within IPv6 count as such.
std::string client_machine(const sockaddr_storage& peer);

}  // namespace tessera::proto
