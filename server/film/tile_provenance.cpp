// SPDX-License-Identifier: Apache-2.0
#include "server/film/tile_provenance.hpp"

#include <map>

namespace tessera::film {

stored::v1::Provenance to_stored(const Produced& provenance) {
  stored::v1::Provenance message;
  message.set_fingerprinter(provenance.fingerprinter);
  std::map<scheduler::Producer, std::uint32_t> numbers;
  for (const scheduler::ProducedItem& each : provenance.items) {
    const auto [number, is_new] =
        numbers.try_emplace(each.producer, static_cast<std::uint32_t>(message.producers_size()));
    if (is_new) {
      stored::v1::Provenance::Producer& producer = *message.add_producers();
      producer.set_name(each.producer.name);
      producer.set_worker_id(each.producer.worker.value);
      producer.set_machine(each.producer.machine);
      producer.set_principal(each.producer.principal);
    }
    stored::v1::Provenance::Range& range = *message.add_ranges();
    range.set_sample_begin(each.item.samples.begin);
    range.set_sample_end(each.item.samples.end);
    range.set_producer(number->second);
    range.set_low(each.fingerprint.low);
    range.set_high(each.fingerprint.high);
    range.set_largest(each.fingerprint.largest);
    range.set_due(static_cast<std::uint32_t>(each.due));
  }
  return message;
}

Produced from_stored(int tile, const stored::v1::Provenance& message) {
  Produced provenance;
  provenance.fingerprinter = message.fingerprinter();
  for (const stored::v1::Provenance::Range& range : message.ranges()) {
    const bool possible = range.producer() < static_cast<std::uint32_t>(message.producers_size()) &&
                          range.due() <= static_cast<std::uint32_t>(scheduler::Due::kDoubted);
    if (!possible) continue;
    const stored::v1::Provenance::Producer& producer = message.producers(static_cast<int>(range.producer()));
    provenance.items.push_back(
        {{tile, {range.sample_begin(), range.sample_end()}},
         {producer.name(), {producer.worker_id()}, producer.machine(), producer.principal()},
         {range.low(), range.high(), range.largest()},
         static_cast<scheduler::Due>(range.due())});
  }
  return provenance;
}

}  // namespace tessera::film
