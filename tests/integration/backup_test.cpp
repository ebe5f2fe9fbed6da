// SPDX-License-Identifier: Apache-2.0
// Backups are made while a coordinator runs and workers deliver. What is restored elsewhere goes on to the
// same bytes; what is not whole is refused.
#include <gmock/gmock.h>
#include <signal.h>

#include <filesystem>
#include <fstream>

#include "tests/integration/farm_processes.hpp"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;

namespace fs = std::filesystem;

const std::vector<std::string> kLong{"--size", "192x128", "--spp", "32"};
const std::vector<std::string> kShort{"--size", "64x64", "--spp", "2"};
constexpr Timeout kRendered = 200s;
constexpr std::uint64_t kLongSamples = std::uint64_t{192} * 128 * 32;

class BackupTest : public FarmTest {
 protected:
  const fs::path backup_ = folder_ / "backup", restored_ = folder_ / "restored";

  Outcome back_up(const fs::path& to) { return run_coordinator({"--state", state_, "--backup", to}); }
  Outcome restore(const fs::path& from, const fs::path& to) {
    return run_coordinator({"--restore", from, "--state", to});
  }
  // The pixel samples of the unfinished job that a backup has.
  std::uint64_t samples_of(const fs::path& backup) {
    const Outcome checked = run_coordinator({"--check", backup});
    EXPECT_EQ(checked.exit_code, 0) << checked.out;
    const std::string key = ", running, ";
    const std::size_t at = checked.out.find(key);
    return at == std::string::npos ? 0 : std::stoull(checked.out.substr(at + key.size()));
  }
  // One finished job, of which a backup is made after the coordinator has stopped.
  void make_backup() {
    start_coordinator();
    start_worker("one", 1);
    id_ = submit(kShort);
    ASSERT_TRUE(wait_for_state(id_, v1::JOB_STATE_DONE));
    stop_coordinator();
    const Outcome made = back_up(backup_);
    ASSERT_EQ(made.exit_code, 0) << made.err;
    EXPECT_THAT(made.out, HasSubstr("has 1 jobs with 3 files"));
  }
  // A copy of the backup to damage.
  fs::path copy_of_backup(const std::string& name) {
    fs::path copy = folder_ / name;
    fs::copy(backup_, copy, fs::copy_options::recursive);
    return copy;
  }
  // One of the files in `blobs`.
  static fs::path some_blob(const fs::path& folder) {
    for (const auto& entry : fs::recursive_directory_iterator(folder / "blobs"))
      if (entry.is_regular_file()) return entry.path();
    ADD_FAILURE() << "there is no blob";
    return {};
  }
  void expect_refused(const fs::path& backup, const std::string& why) {
    const Outcome refused = restore(backup, restored_);
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_THAT(refused.err, AllOf(HasSubstr("is not whole: "), HasSubstr(why), HasSubstr("another backup")));
    EXPECT_FALSE(fs::exists(restored_ / "tessera.db"));
    EXPECT_EQ(run_coordinator({"--check", backup}).exit_code, 1);
  }

  std::string id_;
};

// Changes the byte at this position.
void damage(const fs::path& file, std::streamoff at) {
  std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
  bytes.seekg(at);
  const int byte = bytes.get();
  bytes.seekp(at);
  bytes.put(static_cast<char>(byte ^ 0x55));
}

// In the middle.
void damage(const fs::path& file) {
  damage(file, static_cast<std::streamoff>(fs::file_size(file) / 2));
}

TEST_F(BackupTest, AJobThatIsBackedUpWhileItRendersGoesOnElsewhereToTheSameBytes) {
  start_coordinator();
  Process& worker = start_worker("one", 1);
  const std::string finished = submit(kShort);
  ASSERT_TRUE(wait_for_state(finished, v1::JOB_STATE_DONE));
  const std::string id = submit(kLong);
  ASSERT_TRUE(wait_for_samples(id, 1));
  // Samples reach the database within seconds of their arrival.
  worker.signal(SIGSTOP);
  int backups = 0;
  ASSERT_TRUE(poll_until(20s, [&] {
    const fs::path early = folder_ / ("early-" + std::to_string(++backups));
    return back_up(early).exit_code == 0 && samples_of(early) > 0;
  }));
  worker.signal(SIGCONT);
  const Outcome made = back_up(backup_);
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("has 2 jobs with 3 files"));

  // The coordinator goes on as if nothing had been.
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE, kRendered));
  EXPECT_TRUE(image(id, ".exr") == render_here(kLong, ".exr"));
  worker.signal(SIGTERM);
  ASSERT_EQ(worker.wait(30s), 0);
  stop_coordinator();
  fs::remove_all(state_);

  const Outcome restored = restore(backup_, restored_);
  ASSERT_EQ(restored.exit_code, 0) << restored.err;
  state_ = restored_;
  start_coordinator();
  EXPECT_EQ(job(finished).state(), v1::JOB_STATE_DONE);
  EXPECT_TRUE(image(finished, ".exr") == render_here(kShort, ".exr"));
  EXPECT_GT(job(id).samples_done(), 0u);
  start_worker("two", 1);
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE, kRendered));
  EXPECT_TRUE(image(id, ".exr") == render_here(kLong, ".exr"));
  EXPECT_EQ(job(id).counters().samples(), kLongSamples);
  stop_coordinator();
  EXPECT_EQ(run_coordinator({"--check", state_}).exit_code, 0);
}

TEST_F(BackupTest, BackupsThatAreNotWholeAreRefused) {
  make_backup();
  fs::path backup = copy_of_backup("without-blob");
  const std::string blob = fs::relative(some_blob(backup), backup);
  fs::remove(backup / blob);
  expect_refused(backup, blob + " is missing");

  backup = copy_of_backup("damaged-blob");
  damage(backup / blob);
  expect_refused(backup, blob + " is damaged");

  backup = copy_of_backup("damaged-database");
  damage(backup / "tessera.db");
  expect_refused(backup, "tessera.db is damaged");

  backup = copy_of_backup("short-database");
  fs::resize_file(backup / "tessera.db", fs::file_size(backup / "tessera.db") / 2);
  expect_refused(backup, "tessera.db is damaged");

  backup = copy_of_backup("short-list");
  fs::resize_file(backup / "tessera-backup.sha256", fs::file_size(backup / "tessera-backup.sha256") - 60);
  expect_refused(backup, "tessera-backup.sha256 is damaged");

  backup = copy_of_backup("without-list");
  fs::remove(backup / "tessera-backup.sha256");
  const Outcome refused = restore(backup, restored_);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, HasSubstr("is no backup"));

  // What was refused before does not prevent a whole one.
  const Outcome restored = restore(backup_, restored_);
  EXPECT_EQ(restored.exit_code, 0) << restored.err;
  EXPECT_EQ(run_coordinator({"--check", restored_}).exit_code, 0);
}

TEST_F(BackupTest, BackupsAndStatesAreNotOverwritten) {
  make_backup();
  const Outcome again = back_up(backup_);
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_THAT(again.err, HasSubstr("exists already: name a new folder"));
  const Outcome over_state = restore(backup_, state_);
  EXPECT_EQ(over_state.exit_code, 1);
  EXPECT_THAT(over_state.err, HasSubstr("has the state of a coordinator already"));
  const Outcome started = run_coordinator({"--listen", "127.0.0.1:0", "--state", backup_});
  EXPECT_EQ(started.exit_code, 1);
  EXPECT_THAT(started.err, AllOf(HasSubstr("is a backup"), HasSubstr("--restore")));
  EXPECT_EQ(run_coordinator({"--check", backup_}).exit_code, 0);
}

TEST_F(BackupTest, AStateWithoutACoordinatorIsRefused) {
  fs::create_directory(folder_ / "empty");
  const Outcome refused = run_coordinator({"--state", folder_ / "empty", "--backup", backup_});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, HasSubstr("there is no state of a coordinator"));
  EXPECT_FALSE(fs::exists(backup_));
  for (const auto& entry : fs::directory_iterator(folder_.path()))
    EXPECT_THAT(entry.path().filename().string(), ::testing::Not(HasSubstr("partial")));
}

// A lost file concerns its job alone: the others are backed up, and the operator is told.
TEST_F(BackupTest, DamageOfTheStateIsReportedAndNotTakenAlong) {
  make_backup();
  damage(some_blob(state_));
  const Outcome made = back_up(folder_ / "second");
  EXPECT_EQ(made.exit_code, 1);
  EXPECT_THAT(made.out, HasSubstr("has 1 jobs with 2 files"));
  EXPECT_THAT(made.err, AllOf(HasSubstr("damaged in the state: job " + id_), HasSubstr("its file ")));
  const Outcome restored = restore(folder_ / "second", restored_);
  EXPECT_EQ(restored.exit_code, 0) << restored.err;

  damage(state_ / "tessera.db", 0);
  const Outcome none = back_up(folder_ / "third");
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, HasSubstr("is damaged"));
  EXPECT_FALSE(fs::exists(folder_ / "third"));
}

}  // namespace
}  // namespace tessera::test
