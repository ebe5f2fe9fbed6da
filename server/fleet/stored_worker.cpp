// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/stored_worker.hpp"

#include "server/farm/wire.hpp"
#include "server/fleet/stored_worker.pb.h"

namespace tessera::fleet {

namespace {

void encode(const farm::QuarantineEntry& entry, StoredWorkerMessage& message) {
  message.set_worker_name(entry.producer.name);
  message.set_machine(entry.producer.machine);
  message.set_individual_principal(entry.producer.principal);
  message.set_principal(entry.principal);
  message.set_because(entry.because);
  message.set_since_ms(entry.since_ms);
}

farm::QuarantineEntry decode_quarantine(const StoredWorkerMessage& message) {
  return {{message.worker_name(), {message.worker_id()}, message.machine(), message.individual_principal()},
          message.principal(),
          message.because(),
          message.since_ms()};
}

}  // namespace

std::string encode(const StoredWorker& worker) {
  StoredWorkerMessage message;
  message.set_worker_id(worker.id);
  if (worker.quarantine) encode(*worker.quarantine, message);
  if (worker.drain) message.mutable_drain()->set_stop(worker.drain->stop);
  return message.SerializeAsString();
}

std::optional<StoredWorker> decode(const std::string& bytes) {
  StoredWorkerMessage message;
  if (!message.ParseFromString(bytes) || message.worker_id().empty()) return std::nullopt;
  StoredWorker worker{message.worker_id()};
  if (!message.because().empty()) worker.quarantine = decode_quarantine(message);
  if (message.has_drain()) worker.drain = farm::Drain{message.drain().stop()};
  return worker;
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
