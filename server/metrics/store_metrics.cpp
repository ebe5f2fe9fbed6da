// SPDX-License-Identifier: Apache-2.0
// Films, checkpoints and the state folder.
#include <chrono>
#include <filesystem>
#include <string>
#include <system_error>

#include "server/metrics/histogram.hpp"
#include "server/metrics/parts.hpp"

namespace tessera::metrics {

namespace {

// 0 if there is no such file.
double file_bytes(const std::filesystem::path& file) {
  std::error_code missing;
  const std::uintmax_t bytes = std::filesystem::file_size(file, missing);
  return missing ? 0 : static_cast<double>(bytes);
}

}  // namespace

void write_films(common::MetricWriter& writer, const film::FilmMemory& memory) {
  writer.gauge("tessera_film_memory_bytes", "Memory of all films", static_cast<double>(memory.used_bytes()));
  writer.gauge("tessera_film_memory_limit_bytes", "Limit on the memory of all films (--max-film-gib)",
               static_cast<double>(memory.budget_bytes()));
}

void write_checkpoints(common::MetricWriter& writer, const jobs::CheckpointStats& stats) {
  writer.gauge("tessera_checkpoint_age_seconds",
               "Time since the last checkpoint that was written: the work that a crash would cost",
               std::chrono::duration<double>(stats.age()).count());
  writer.begin_histogram("tessera_checkpoint_duration_seconds", "Time of writing a checkpoint");
  writer.add(to_prometheus(stats.durations()));
  writer.counter("tessera_checkpoints_failed_total", "Checkpoints that could not be written",
                 static_cast<double>(stats.failed()));
}

void write_store(common::MetricWriter& writer, server::Coordinator& coordinator) {
  const std::filesystem::path& database = coordinator.store().file();
  writer.begin_gauge("tessera_store_bytes", "Size of the state folder, by part");
  writer.add(file_bytes(database), {{"part", "database"}});
  writer.add(file_bytes(database.string() + "-wal"), {{"part", "log"}});
  writer.add(static_cast<double>(coordinator.files().used_bytes()), {{"part", "blobs"}});
  writer.gauge("tessera_store_blobs_limit_bytes", "Limit on the files of scenes (--max-store-mib)",
               static_cast<double>(coordinator.files().limit_bytes()));
  std::error_code unknown;
  const std::filesystem::space_info space = std::filesystem::space(database.parent_path(), unknown);
  writer.gauge("tessera_store_free_bytes", "Free space of the file system of the state folder",
               unknown ? 0 : static_cast<double>(space.available));
  writer.gauge("tessera_store_capacity_bytes", "Size of the file system of the state folder",
               unknown ? 0 : static_cast<double>(space.capacity));
}

}  // namespace tessera::metrics
