// SPDX-License-Identifier: Apache-2.0
#include "server/film/producer_keys.hpp"

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <vector>

namespace tessera::film {

namespace {

constexpr std::size_t kKeyBytes = 8;

// FNV-1a. The mark keeps workers, machines and principals apart.
std::uint64_t key_of(char mark, std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325;
  const auto add = [&](char c) { hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3; };
  add(mark);
  for (const char c : text) add(c);
  return hash;
}

// Of all that is known of the producer and proves something: see scheduler::Producers::distrust().
std::vector<std::uint64_t> keys_of(const scheduler::Producer& producer) {
  std::vector<std::uint64_t> keys{key_of('w', producer.worker.value)};
  if (!producer.machine.empty()) keys.push_back(key_of('m', producer.machine));
  if (!producer.principal.empty()) keys.push_back(key_of('p', producer.principal));
  return keys;
}

}  // namespace

ProducerKeys::ProducerKeys(const std::string& bytes) {
  for (std::size_t at = 0; at + kKeyBytes <= bytes.size(); at += kKeyBytes) {
    std::uint64_t key = 0;
    for (std::size_t i = kKeyBytes; i-- > 0;) key = key << 8 | static_cast<unsigned char>(bytes[at + i]);
    keys_.insert(key);
  }
}

void ProducerKeys::add(const scheduler::Producer& producer) {
  for (const std::uint64_t key : keys_of(producer)) keys_.insert(key);
}

bool ProducerKeys::contains(const scheduler::Producer& producer) const {
  const std::vector<std::uint64_t> keys = keys_of(producer);
  return std::any_of(keys.begin(), keys.end(), [this](std::uint64_t key) { return keys_.contains(key); });
}

std::string ProducerKeys::encode() const {
  std::string bytes;
  for (std::uint64_t key : keys_)
    for (std::size_t i = 0; i < kKeyBytes; ++i, key >>= 8) bytes.push_back(static_cast<char>(key & 0xff));
  return bytes;
}

}  // namespace tessera::film
