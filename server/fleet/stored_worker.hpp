// SPDX-License-Identifier: Apache-2.0
// What the store keeps of a worker, and its conversions. Pure functions.
#pragma once

#include <optional>
#include <string>

#include "server/farm/drains.hpp"
#include "server/farm/quarantine.hpp"
#include "tessera/v1/admin_service.pb.h"

namespace tessera::fleet {

struct StoredWorker {
  std::string id;
  std::optional<farm::QuarantineEntry> quarantine{};
  std::optional<farm::Drain> drain{};
  bool operator==(const StoredWorker&) const = default;
};

std::string encode(const StoredWorker& worker);
// Empty if the bytes are of no worker.
std::optional<StoredWorker> decode(const std::string& bytes);

v1::QuarantineEntry to_wire(const farm::QuarantineEntry& entry);

}  // namespace tessera::fleet
