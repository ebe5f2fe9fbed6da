// SPDX-License-Identifier: Apache-2.0
#include "server/film/tile_provenance.hpp"

#include <map>

#include "server/film/tile_provenance.pb.h"

namespace tessera::film {

std::string encode_provenance(const Produced& provenance) {
  TileProvenance message;
  message.set_fingerprinter(provenance.fingerprinter);
  std::map<scheduler::Producer, std::uint32_t> numbers;
  for (const scheduler::ProducedItem& each : provenance.items) {
    const auto [number, is_new] =
        numbers.try_emplace(each.producer, static_cast<std::uint32_t>(message.producers_size()));
    if (is_new) {
      TileProvenance::Producer& producer = *message.add_producers();
      producer.set_name(each.producer.name);
      producer.set_worker_id(each.producer.worker.value);
      producer.set_machine(each.producer.machine);
    }
    TileProvenance::Range& range = *message.add_ranges();
    range.set_sample_begin(each.item.samples.begin);
    range.set_sample_end(each.item.samples.end);
    range.set_producer(number->second);
    range.set_low(each.fingerprint.low);
    range.set_high(each.fingerprint.high);
    range.set_largest(each.fingerprint.largest);
    range.set_due(static_cast<std::uint32_t>(each.due));
  }
  return message.SerializeAsString();
}

Produced decode_provenance(int tile, const std::string& bytes) {
  Produced provenance;
  TileProvenance message;
  if (!message.ParseFromString(bytes)) return provenance;
  provenance.fingerprinter = message.fingerprinter();
  for (const TileProvenance::Range& range : message.ranges()) {
    const bool possible = range.producer() < static_cast<std::uint32_t>(message.producers_size()) &&
                          range.due() <= static_cast<std::uint32_t>(scheduler::Due::kDoubted);
    if (!possible) continue;
    const TileProvenance::Producer& producer = message.producers(static_cast<int>(range.producer()));
    provenance.items.push_back({{tile, {range.sample_begin(), range.sample_end()}},
                                {producer.name(), {producer.worker_id()}, producer.machine()},
                                {range.low(), range.high(), range.largest()},
                                static_cast<scheduler::Due>(range.due())});
  }
  return provenance;
}

}  // namespace tessera::film
