// SPDX-License-Identifier: Apache-2.0
// A job store in a folder of its own, and rows for it.
#pragma once

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>

#include "server/store/job_store.hpp"
#include "tests/support/temporary_folder.hpp"

namespace tessera::store {

inline JobRow job_row(const std::string& id) {
  JobRow row;
  row.id = id;
  row.spec = std::string("\0spec\xff", 6);
  row.revision = 1;
  row.state = 1;
  row.spp = 16;
  row.created_ms = 1'700'000'000'000;
  return row;
}

inline TileRow tile_row(const std::string& job, int tile, std::string content) {
  return {job, tile, {{0, 3}, {5, 16'777'216}}, std::move(content)};
}

class JobStoreTest : public testing::Test {
 protected:
  void reopen() { store_.emplace(*JobStore::open(file_)); }
  JobStore& store() { return *store_; }

  // Takes back the changes of the schema since this version.
  void make_of_version(int version) {
    store_.reset();
    const auto drop_columns = [this](std::initializer_list<std::string> columns) {
      for (const std::string& column : columns) meddle("ALTER TABLE jobs DROP COLUMN " + column);
    };
    if (version < 8) drop_columns({"targets"});
    if (version < 7) {
      meddle("DROP INDEX jobs_by_number; DROP INDEX jobs_unsettled; DROP INDEX jobs_by_end");
      meddle("DROP TABLE deleted_jobs");
      drop_columns({"owner", "producers", "settled", "number", "bundle_xxh3", "bundle"});
    }
    if (version < 6) drop_columns({"failure_details", "submission"});
    if (version < 5) meddle("DROP TABLE quarantine");
    if (version < 4) meddle("DROP TRIGGER tile_deleted; DROP TABLE tile_revisions");
    if (version < 3) drop_columns({"max_workers"});
    if (version < 2) drop_columns({"row_xxh3"});
    meddle("PRAGMA user_version = " + std::to_string(version));
  }

  // Runs SQL as another program could on the file.
  void meddle(const std::string& sql) {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(file_.c_str(), &database), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database);
    sqlite3_close(database);
  }

  TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_.path() / "tessera.db";
  std::optional<JobStore> store_{*JobStore::open(file_)};
};

}  // namespace tessera::store
