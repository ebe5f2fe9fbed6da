// SPDX-License-Identifier: Apache-2.0
// The state folder of an earlier release is taken over as it is.
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <filesystem>
#include <string>

#include "proto/blob.hpp"
#include "server/store/schema.hpp"
#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::server {
namespace {

const std::string kDoneJob = "86bd532c1a1ccdb1a82b4a24061d5dd0",
                  kRunningJob = "04a4bb6070e1683bb57f731f1e9b876d";
constexpr std::uint64_t kPixelsOfEachJob = 72 * 6;

class EarlierState : public ScriptedFarm {
 protected:
  EarlierState() {
    coordinator_.reset();
    std::filesystem::create_directories(state_);
    sqlite3* database = nullptr;
    EXPECT_EQ(sqlite3_open((state_ / "tessera.db").c_str(), &database), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, read_file(TESSERA_STATE_OF_SCHEMA_7).c_str(), nullptr, nullptr, nullptr),
              SQLITE_OK)
        << sqlite3_errmsg(database);
    sqlite3_close(database);
    fingerprints_ = {"b41864b8d2d54d7f"};
    open(state_);
  }
  std::string image_digest(const std::string& id) {
    v1::GetImageRequest request;
    request.set_job_id(id);
    request.set_format(v1::IMAGE_FORMAT_PFM);
    const auto written = coordinator().images().write(request);
    EXPECT_TRUE(written) << written.error().message;
    if (!written) return "";
    return proto::digest_of(written->file.read_at(0, written->size_bytes).value_or("")).hex();
  }

  const std::filesystem::path state_ = folder_.path() / "earlier";
};

TEST_F(EarlierState, HasTheSameImages) {
  const v1::Job done = job(kDoneJob);
  EXPECT_EQ(done.state(), v1::JOB_STATE_DONE);
  EXPECT_EQ(done.image_count(), 1u);
  EXPECT_EQ(done.samples_total(), 4 * kPixelsOfEachJob);
  ASSERT_EQ(done.images_size(), 1);
  EXPECT_EQ(done.images(0).samples_done(), 4 * kPixelsOfEachJob);
  // The SHA-256 of the file that the earlier release wrote.
  EXPECT_EQ(image_digest(kDoneJob), "01cd840e0f207c8a33f5767537265daba565b107d85c25218626f84ca5f537a1");
}

TEST_F(EarlierState, HasJobsThatGoOn) {
  const v1::Job running = job(kRunningJob);
  EXPECT_EQ(running.state(), v1::JOB_STATE_RUNNING);
  EXPECT_EQ(running.settings().spp(), 6u);
  EXPECT_EQ(running.samples_done(), 2 * kPixelsOfEachJob);
  v1::ExtendJobRequest request;
  request.set_job_id(kRunningJob);
  v1::TileTarget& tile = *request.add_tiles();
  tile.mutable_rect()->set_x1(64);
  tile.mutable_rect()->set_y1(6);
  tile.set_spp(7);
  ASSERT_TRUE(coordinator().jobs().extend(request));
  open(state_);
  EXPECT_EQ(job(kRunningJob).samples_total(), 6 * kPixelsOfEachJob + 64 * 6);
  EXPECT_EQ(job(kRunningJob).samples_done(), 2 * kPixelsOfEachJob);
}

}  // namespace
}  // namespace tessera::server
