// SPDX-License-Identifier: Apache-2.0
// What a worker delivers, on its way into a film. Parts named "raw" are messages as they are; in others, what
// stands as the compressed sums is taken for the sums themselves, which get a frame and a checksum that are
// in order.
#include <algorithm>
#include <cstring>

#include "proto/convert.hpp"
#include "proto/tile_codec.hpp"
#include "tests/fuzz/farm.hpp"
#include "tests/fuzz/fuzzer.hpp"
#include "tests/fuzz/parts.hpp"

namespace tessera::fuzz::result_fuzz {
namespace {

// The bytes again and again.
void fill(std::vector<std::uint64_t>& sums, const std::string& bytes) {
  if (bytes.empty()) return;
  auto* const to = reinterpret_cast<char*>(sums.data());
  for (std::size_t i = 0; i < sums.size() * sizeof(std::uint64_t); ++i) to[i] = bytes[i % bytes.size()];
}

void put_in_order(v1::RenderedItem& item) {
  const auto work = proto::from_proto(item.item());
  if (!work || work->rect.width() > core::kTilePx || work->rect.height() > core::kTilePx) return;
  core::FilmTile tile(work->rect, work->range);
  fill(tile.sums, item.sums_zstd());
  fill(tile.odd_sums, item.sums_zstd());
  const v1::Counters counters = item.counters();
  item = proto::encode_tile(tile);
  *item.mutable_counters() = counters;
  if (counters.samples() == 0)
    item.mutable_counters()->set_samples(work->rect.pixel_count() * std::uint64_t{work->range.count()});
}

void deliver(Farm& farm, const Part& part) {
  v1::SubmitResultRequest request;
  if (!request.ParseFromString(std::string(part.bytes))) return;
  request.set_worker_id(id_of(request.worker_id()));
  request.set_job_id(id_of(request.job_id()));
  if (part.name != "raw") {
    for (v1::RenderedItem& item : *request.mutable_items()) put_in_order(item);
  }
  farm.sign(request);
  const auto counted = farm.coordinator().dispatcher().submit_result(request);
  expect_sendable(counted);
  if (!counted) return;
  const int items = static_cast<int>(counted->accepted_items() + counted->dropped_items());
  expect(items == request.items_size(), "every item is counted or dropped");
}

void feed(std::string_view input) {
  Farm farm;
  expect(farm.is_open(), "an intact state folder is taken up");
  farm.greet('1');
  for (const Part& part : parts_of(input)) {
    deliver(farm, part);
    farm.wait(std::chrono::seconds(1));
    farm.greet('1');
  }
  expect_told(farm.coordinator().images().get(id_of("a")));
  expect_told(farm.coordinator().checkpointer().checkpoint());
  farm.reopen();
  expect(farm.is_open(), "what a coordinator has written it can read");
  for (const v1::Job& job : listed(farm)) expect_sendable(job);
}

}  // namespace

TESSERA_FUZZER(result, std::string_view input) {
  feed(input);
}

}  // namespace tessera::fuzz::result_fuzz
