// SPDX-License-Identifier: Apache-2.0
#include "proto/worker_key.hpp"

#include "proto/blob.hpp"

namespace tessera::proto {
namespace {

constexpr std::size_t kIdDigits = 32;

}  // namespace

std::string worker_id_of(const std::string& worker_key) {
  return digest_of(worker_key).hex().substr(0, kIdDigits);
}

std::string client_key(const std::string& worker_key) {
  if (worker_key.size() != kWorkerKeyBytes) return "";
  return digest_of(worker_key.substr(0, kMachineKeyBytes)).hex().substr(0, kIdDigits);
}

}  // namespace tessera::proto
