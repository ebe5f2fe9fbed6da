// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/quarantine_codec.hpp"

#include "server/farm/wire.hpp"
#include "server/fleet/quarantine_entry.pb.h"

namespace tessera::fleet {

std::string encode(const farm::QuarantineEntry& entry) {
  StoredQuarantineEntry stored;
  stored.set_worker_id(entry.producer.worker.value);
  stored.set_worker_name(entry.producer.name);
  stored.set_machine(entry.producer.machine);
  stored.set_individual_principal(entry.producer.principal);
  stored.set_principal(entry.principal);
  stored.set_because(entry.because);
  stored.set_since_ms(entry.since_ms);
  return stored.SerializeAsString();
}

std::optional<farm::QuarantineEntry> decode(const std::string& bytes) {
  StoredQuarantineEntry stored;
  if (!stored.ParseFromString(bytes) || stored.worker_id().empty()) return std::nullopt;
  return farm::QuarantineEntry{
      {stored.worker_name(), {stored.worker_id()}, stored.machine(), stored.individual_principal()},
      stored.principal(),
      stored.because(),
      stored.since_ms()};
}

v1::QuarantineEntry to_wire(const farm::QuarantineEntry& entry) {
  v1::QuarantineEntry message;
  message.set_id(entry.producer.worker.value);
  message.set_worker_id(entry.producer.worker.value);
  message.set_worker_name(entry.producer.name);
  message.set_principal(entry.principal);
  message.set_reason(entry.because);
  *message.mutable_since() = farm::timestamp_from_ms(entry.since_ms);
  return message;
}

}  // namespace tessera::fleet
