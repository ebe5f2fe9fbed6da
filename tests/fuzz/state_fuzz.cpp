// SPDX-License-Identifier: Apache-2.0
// A state folder that something has happened to, looked at, taken up by a coordinator, and salvaged where
// none takes it. The input's parts change it one after another: bytes of the database file ("patch", "cut")
// or of its log
// ("log"), or, under checksums that are in order, what stands in a job's row ("spec", "counters", "failure",
// "numbers") and a tile's content or samples ("tile", "done").
#include <algorithm>
#include <fstream>

#include "server/admin/state_check.hpp"
#include "server/store/job_store.hpp"
#include "tests/fuzz/farm.hpp"
#include "tests/fuzz/fuzzer.hpp"
#include "tests/fuzz/parts.hpp"
#include "tests/fuzz/scratch_folder.hpp"

namespace tessera::fuzz::state_fuzz {
namespace {

namespace fs = std::filesystem;

// Takes a number off the front of `bytes`; 0 at the end.
template <typename T>
T take(std::string_view& bytes) {
  T value{};
  const std::size_t size = std::min(sizeof value, bytes.size());
  std::copy_n(bytes.data(), size, reinterpret_cast<char*>(&value));
  bytes.remove_prefix(size);
  return value;
}

// The first four bytes say where the others go.
void patch(const fs::path& file, std::string_view bytes) {
  const auto at = take<std::uint32_t>(bytes) % std::max<std::uintmax_t>(fs::file_size(file), 1);
  std::fstream stream(file, std::ios::binary | std::ios::in | std::ios::out);
  stream.seekp(static_cast<std::streamoff>(at));
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

void set_numbers(store::JobRow& row, std::string_view bytes) {
  row.state = take<std::int8_t>(bytes);
  row.spp = take<std::uint32_t>(bytes);
  row.priority = take<std::int32_t>(bytes);
  row.created_ms = take<std::int64_t>(bytes);
  if (!bytes.empty()) row.finished_ms = take<std::int64_t>(bytes);
}

// Of job "a", with its tiles.
void change_job(store::JobStore& jobs, const Part& part) {
  auto rows = jobs.jobs();
  if (!rows || rows->empty()) return;
  store::JobRow& row = rows->front();
  if (part.name == "spec") row.spec = part.bytes;
  if (part.name == "counters") row.counters = part.bytes;
  if (part.name == "failure") row.failure = part.bytes;
  if (part.name == "request_id") row.request_id = part.bytes;
  if (part.name == "numbers") set_numbers(row, part.bytes);
  std::vector<store::TileRow> tiles;
  for (const int number : {0, 1}) {
    const auto tile = jobs.tile(row.id, number);
    if (tile && *tile) tiles.push_back(**tile);
  }
  if (!jobs.delete_job(row.id)) return;
  if (jobs.insert_job(row)) expect_answer(jobs.write_tiles(tiles));
}

// Of job "a": the first byte is its number.
void change_tile(store::JobStore& jobs, std::string_view bytes, bool change_done) {
  const int number = take<std::int8_t>(bytes);
  const auto known = jobs.tile(id_of("a"), number);
  store::TileRow row{id_of("a"), number, {{0, 2}}, ""};
  if (known && *known) row = **known;
  if (!change_done) row.content = bytes;
  if (change_done) row.done.clear();
  while (change_done && !bytes.empty()) {
    const auto begin = take<std::uint32_t>(bytes);
    row.done.push_back({begin, take<std::uint32_t>(bytes)});
  }
  expect_answer(jobs.write_tiles({row}));
}

void change(const fs::path& folder, const Part& part) {
  const fs::path file = folder / store::kDatabaseName;
  if (part.name == "patch") return patch(file, part.bytes);
  if (part.name == "cut") return fs::resize_file(file, part.bytes.size());
  if (part.name == "log") {
    std::ofstream(folder / "tessera.db-wal", std::ios::binary) << part.bytes;
    return;
  }
  auto jobs = store::JobStore::open(file);
  if (!expect_answer(jobs)) return;
  if (part.name == "tile" || part.name == "done") return change_tile(*jobs, part.bytes, part.name == "done");
  if (!part.name.empty()) change_job(*jobs, part);
}

void look_at(const fs::path& folder) {
  const auto findings = admin::check_state(folder);
  if (expect_answer(findings)) expect_message(admin::to_text(*findings));
}

void go_on(Farm& farm) {
  for (const v1::Job& job : listed(farm)) {
    expect_sendable(job);
    const std::uint64_t pixels = std::uint64_t{job.settings().width_px()} * job.settings().height_px();
    if (pixels < 1 << 16) expect_answer(farm.coordinator().images().get(job.id()));
  }
  farm.greet('1');
  farm.wait(std::chrono::seconds(1));
  expect_answer(farm.coordinator().checkpointer().checkpoint());
  expect_answer(farm.coordinator().jobs().extend(id_of("c"), 3));
  farm.wait(std::chrono::seconds(20));
}

void take_up(std::string_view input) {
  Farm farm(nullptr, [&](const fs::path& folder) {
    for (const Part& part : parts_of(input)) change(folder, part);
    look_at(folder);
  });
  if (farm.is_open()) return go_on(farm);
  if (!expect_answer(admin::salvage_state(scratch_folder() / "state"))) return;
  farm.reopen();
  expect(farm.is_open(), "what was salvaged can be taken up");
  go_on(farm);
}

}  // namespace

TESSERA_FUZZER(state, std::string_view input) {
  take_up(input);
}

}  // namespace tessera::fuzz::state_fuzz
