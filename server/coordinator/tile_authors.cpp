#include "server/coordinator/tile_authors.hpp"

#include <map>

#include "server/coordinator/tile_authors.pb.h"

namespace tessera::coordinator {

std::string encode_authors(const Authored& authored) {
  TileAuthors message;
  message.set_fingerprinter(authored.fingerprinter);
  std::map<scheduler::Author, std::uint32_t> numbers;
  for (const scheduler::AuthoredItem& each : authored.items) {
    const auto [number, is_new] =
        numbers.try_emplace(each.author, static_cast<std::uint32_t>(message.authors_size()));
    if (is_new) {
      TileAuthors::Author& author = *message.add_authors();
      author.set_name(each.author.name);
      author.set_worker_id(each.author.worker.value);
      author.set_machine(each.author.machine);
    }
    TileAuthors::Range& range = *message.add_ranges();
    range.set_sample_begin(each.item.samples.begin);
    range.set_sample_end(each.item.samples.end);
    range.set_author(number->second);
    range.set_low(each.fingerprint.low);
    range.set_high(each.fingerprint.high);
    range.set_largest(each.fingerprint.largest);
    range.set_due(static_cast<std::uint32_t>(each.due));
  }
  return message.SerializeAsString();
}

Authored decode_authors(int tile, const std::string& bytes) {
  Authored authored;
  TileAuthors message;
  if (!message.ParseFromString(bytes)) return authored;
  authored.fingerprinter = message.fingerprinter();
  for (const TileAuthors::Range& range : message.ranges()) {
    const bool possible = range.author() < static_cast<std::uint32_t>(message.authors_size()) &&
                          range.due() <= static_cast<std::uint32_t>(scheduler::Due::kDoubted);
    if (!possible) continue;
    const TileAuthors::Author& author = message.authors(static_cast<int>(range.author()));
    authored.items.push_back({{tile, {range.sample_begin(), range.sample_end()}},
                              {author.name(), {author.worker_id()}, author.machine()},
                              {range.low(), range.high(), range.largest()},
                              static_cast<scheduler::Due>(range.due())});
  }
  return authored;
}

}  // namespace tessera::coordinator
