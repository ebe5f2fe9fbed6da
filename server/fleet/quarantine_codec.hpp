// SPDX-License-Identifier: Apache-2.0
// Conversions of quarantine entries, for the store and for the protocol. Pure functions.
#pragma once

#include <optional>
#include <string>

#include "server/farm/quarantine.hpp"
#include "tessera/v1/admin_service.pb.h"

namespace tessera::fleet {

std::string encode(const farm::QuarantineEntry& entry);
// Empty if the bytes are no entry.
std::optional<farm::QuarantineEntry> decode(const std::string& bytes);

v1::QuarantineEntry to_wire(const farm::QuarantineEntry& entry);

}  // namespace tessera::fleet
