// SPDX-License-Identifier: Apache-2.0
// Disks that are full, read-only or damaged: messages name the file and say what to do, and everything intact
// keeps working.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/mount.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <functional>
#include <map>

#include "proto/blob.hpp"
#include "tests/integration/farm_processes.hpp"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const std::vector<std::string> kSmall{"--size", "64x64", "--spp", "4"};

class DiskFaultsTest : public FarmTest {
 protected:
  std::filesystem::path database() const { return state_ / "tessera.db"; }
  std::filesystem::path log() const { return state_ / "tessera.db-wal"; }

  Outcome start_expecting_failure() {
    return run_coordinator({"--listen", "127.0.0.1:0", "--state", state_});
  }
  Outcome check() { return run_coordinator({"--check", state_}); }

  // All files in the state folder, by path.
  std::map<std::string, std::string> everything() const {
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(state_))
      files[entry.path()] = entry.is_regular_file() ? read_file(entry.path()) : "";
    return files;
  }
  // The end of each transaction in the log since it was last restarted (SQLite Consortium 2022, section 4).
  std::vector<std::size_t> commits_in_log() const {
    constexpr std::size_t kHeader = 32;
    const std::string bytes = read_file(log());
    std::vector<std::size_t> commits;
    for (std::size_t at = kHeader; at + kFrame <= bytes.size(); at += kFrame) {
      const bool of_this_log = bytes.compare(at + 8, 8, bytes, 16, 8) == 0;
      if (of_this_log && bytes.compare(at + 4, 4, std::string(4, '\0')) != 0) commits.push_back(at + kFrame);
    }
    return commits;
  }
  static constexpr std::size_t kFrame = 24 + 16384;
  static void flip(const std::filesystem::path& file, std::uint64_t at, std::size_t count = 1) {
    std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
    for (std::size_t i = 0; i < count; ++i) {
      bytes.seekg(static_cast<std::streamoff>(at + i));
      const int byte = bytes.get();
      bytes.seekp(static_cast<std::streamoff>(at + i));
      bytes.put(static_cast<char>(byte ^ 0x55));
    }
  }
  // The position of these bytes in the file.
  static std::uint64_t find(const std::filesystem::path& file, const std::string& bytes) {
    const std::size_t at = read_file(file).find(bytes);
    EXPECT_NE(at, std::string::npos);
    return at;
  }
  std::filesystem::path blob_of(const v1::Job& job, const std::string& path) const {
    for (const v1::Bundle::Asset& asset : job.bundle().assets()) {
      const std::string hex = proto::from_proto(asset.digest())->hex();
      if (asset.path() == path) return state_ / "blobs" / hex.substr(0, 2) / hex.substr(2);
    }
    ADD_FAILURE() << "the job has no " << path;
    return {};
  }
  // Makes two done jobs, and stops the coordinator.
  std::vector<std::string> make_state() {
    start_coordinator();
    start_worker("worker", 1);
    const std::vector<std::string> ids{submit(kSmall), submit({"--size", "128x64", "--spp", "4"})};
    for (const std::string& id : ids) EXPECT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
    stop_coordinator();
    return ids;
  }
};

TEST_F(DiskFaultsTest, FilesBeyondALimitOfTheShellAreErrors) {
  const std::string image = folder_ / "a.pfm";
  for (const std::string& command :
       {TESSERA_CLIENT " render " + kCornell + " --size 64x64 --spp 1 -o " + image,
        TESSERA_COORDINATOR_PROGRAM " --listen 127.0.0.1:0 --state " + state_.string()}) {
    Process process({.arguments = {"/bin/bash", "-c", "exec 2> >(cat >&2); ulimit -f 0; exec " + command},
                     .out = folder_ / "out",
                     .err = folder_ / "err"});
    EXPECT_EQ(process.wait(60s), 1) << command;
    EXPECT_TRUE(poll_until(10s, [&] { return process.err().find("too large") != std::string::npos; }))
        << process.err();
  }
}

TEST_F(DiskFaultsTest, CheckingAnIntactStateChangesNothing) {
  const std::vector<std::string> ids = make_state();
  const auto before = everything();
  const Outcome stopped = check();
  EXPECT_EQ(stopped.exit_code, 0) << stopped.out << stopped.err;
  for (const std::string& id : ids) EXPECT_THAT(stopped.out, HasSubstr("job " + id));
  EXPECT_THAT(stopped.out,
              AllOf(HasSubstr("16384 of 16384 samples: whole"), HasSubstr("everything is whole: 2 jobs")));
  EXPECT_EQ(everything(), before);

  restart_coordinator();
  const Outcome running = check();
  EXPECT_EQ(running.exit_code, 1);
  EXPECT_THAT(running.err, HasSubstr("another coordinator runs on " + state_.string()));
  kill_coordinator();
  const auto crashed = everything();
  const Outcome died = check();
  EXPECT_EQ(died.exit_code, 0) << died.out << died.err;
  EXPECT_THAT(died.out, HasSubstr("the next start takes in tessera.db-wal"));
  EXPECT_EQ(everything(), crashed);

  const Outcome nothing = run_coordinator({"--check", folder_ / "."});
  EXPECT_EQ(nothing.exit_code, 1);
  EXPECT_THAT(nothing.err, HasSubstr("no state of a coordinator"));
  EXPECT_EQ(run_coordinator({"--check", folder_ / "nowhere"}).exit_code, 2);
}

TEST_F(DiskFaultsTest, ASecondCoordinatorAndALaterReleaseAreRefused) {
  start_coordinator();
  const Outcome second = start_expecting_failure();
  EXPECT_EQ(second.exit_code, 1);
  EXPECT_THAT(second.err,
              AllOf(HasSubstr("another coordinator runs on " + state_.string()), HasSubstr("--state")));
  std::filesystem::remove(state_ / "lock");
  const Outcome third = start_expecting_failure();
  EXPECT_EQ(third.exit_code, 1);
  EXPECT_THAT(third.err, HasSubstr("another coordinator runs on " + state_.string()));
  EXPECT_THAT(check().err, HasSubstr("another coordinator runs on " + state_.string()));
  stop_coordinator();
  flip(database(), 60, 4);  // the file's user_version
  const Outcome later = start_expecting_failure();
  EXPECT_EQ(later.exit_code, 1);
  EXPECT_THAT(later.err, AllOf(HasSubstr(database()), HasSubstr("release")));
}

TEST_F(DiskFaultsTest, AMissingEmptyOrInvalidDatabaseIsReportedAndNeverReplaced) {
  make_state();
  const std::string whole = read_file(database());
  const std::string garbage(whole.size(), 'g');
  for (const std::string& content :
       {std::string(), garbage, whole.substr(0, whole.size() / 2), whole.substr(0, 100)}) {
    SCOPED_TRACE(content.size());
    write_file(database(), content);
    const Outcome refused = start_expecting_failure();
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_THAT(refused.err, AllOf(HasSubstr(database()), HasSubstr("put back a copy")));
    EXPECT_EQ(check().exit_code, 1);
    EXPECT_TRUE(read_file(database()) == content);
  }
  std::filesystem::remove(database());
  EXPECT_THAT(start_expecting_failure().err, HasSubstr("is missing or empty"));
  std::filesystem::remove(log());
  write_file(database(), whole);
  EXPECT_EQ(check().exit_code, 0);
}

TEST_F(DiskFaultsTest, SalvageKeepsEveryJobAndRendersDamagedTilesAgain) {
  const std::vector<std::string> ids = make_state();
  const std::string images_here[] = {render_here(kSmall, ".exr"),
                                     render_here({"--size", "128x64", "--spp", "4"}, ".exr")};
  // Films are most of the file. First a page in use near the middle is damaged, then the last page is cut
  // off.
  constexpr std::uint64_t kPage = 16384;
  const std::function<void()> damages[] = {
      [&] {
        const std::uint64_t pages = std::filesystem::file_size(database()) / kPage;
        for (std::uint64_t page = pages / 2; page < pages && check().exit_code == 0; ++page)
          flip(database(), page * kPage, 64);
      },
      [&] { std::filesystem::resize_file(database(), std::filesystem::file_size(database()) - kPage); }};
  int number = 0;
  for (const auto& damage : damages) {
    SCOPED_TRACE(++number);
    damage();
    const Outcome checked = check();
    EXPECT_EQ(checked.exit_code, 1);
    EXPECT_THAT(checked.out, HasSubstr("not everything is whole"));
    const Outcome salvaged = run_coordinator({"--salvage", state_});
    EXPECT_EQ(salvaged.exit_code, 0) << salvaged.err;
    EXPECT_THAT(salvaged.out, HasSubstr("kept 2 jobs"));
    EXPECT_TRUE(std::filesystem::exists(database().string() + ".damaged-" + std::to_string(number)));
    EXPECT_EQ(check().exit_code, 0);
    restart_coordinator();
    for (std::size_t i = 0; i < ids.size(); ++i) {
      ASSERT_TRUE(wait_for_state(ids[i], v1::JOB_STATE_DONE)) << "lost tiles are not rendered again";
      EXPECT_TRUE(image(ids[i], ".exr") == images_here[i]);
    }
    stop_coordinator();
  }
}

TEST_F(DiskFaultsTest, ADamagedLogIsReported) {
  start_coordinator();
  start_worker("worker", 1);
  const std::string id = submit({"--size", "128x128", "--spp", "100000"});
  ASSERT_TRUE(wait_for_samples(id, 1));
  ASSERT_TRUE(poll_until(60s, [&] { return commits_in_log().size() >= 4; }));
  kill_coordinator();
  flip(log(), 32 + 24 + 100);  // in its first page: SQLite would drop everything after it
  const auto before = everything();
  const Outcome refused = start_expecting_failure();
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, AllOf(HasSubstr(log().string() + " is damaged"), HasSubstr("--salvage")));
  EXPECT_EQ(check().exit_code, 1);
  EXPECT_EQ(everything(), before);
  ASSERT_EQ(run_coordinator({"--salvage", state_}).exit_code, 0);
  restart_coordinator();
  // The row that says that its scene was validated may be lost: it is validated again.
  EXPECT_TRUE(wait_for_state(id, v1::JOB_STATE_RUNNING));
  EXPECT_TRUE(wait_for_samples(id, job(id).samples_done() + 1));
}

// As after a crash of the machine. Also in a folder of another name to which the state was copied.
TEST_F(DiskFaultsTest, ATruncatedLogLosesOnlyItsLastTransaction) {
  const std::vector<std::string> options{"--size", "128x128", "--spp", "4000"};
  start_coordinator();
  Process& worker = start_worker("worker", 1);
  const std::string done = submit(kSmall);
  ASSERT_TRUE(wait_for_state(done, v1::JOB_STATE_DONE));
  const std::string image_here = image(done, ".exr");
  const std::string id = submit(options);
  ASSERT_TRUE(poll_until(60s, [&] { return job(id).samples_done() > 0 && commits_in_log().size() >= 4; }));
  kill_coordinator();
  worker.signal(SIGKILL);
  const std::vector<std::size_t> commits = commits_in_log();
  const std::size_t last = commits.back(), last_but_one = commits.at(commits.size() - 2);
  const auto whole = state_;
  const auto samples_with_log_of = [&](std::size_t bytes) {
    state_ = folder_ / std::to_string(bytes);
    std::filesystem::copy(whole, state_, std::filesystem::copy_options::recursive);
    std::filesystem::resize_file(log(), bytes);
    const Outcome checked = check();
    EXPECT_EQ(checked.exit_code, 0) << checked.out;
    EXPECT_THAT(checked.out,
                AllOf(HasSubstr("everything is whole: 2 jobs"), HasSubstr("takes in tessera.db-wal")));
    const bool torn = bytes != last && bytes != last_but_one;
    const std::string not_all = "tessera.db-wal is not all there, as a crash may leave it: ";
    EXPECT_EQ(checked.out.find(not_all) != std::string::npos, torn) << checked.out;
    restart_coordinator();
    EXPECT_EQ(coordinator().err().find(not_all + "continuing with") != std::string::npos, torn);
    const std::uint64_t samples = job(id).samples_done();
    EXPECT_THAT(checked.out, HasSubstr(std::to_string(samples) + " of "));
    EXPECT_EQ(job(id).state(), v1::JOB_STATE_RUNNING);
    EXPECT_TRUE(image(done, ".exr") == image_here);
    kill_coordinator();
    return samples;
  };
  const std::uint64_t all = samples_with_log_of(last), fewer = samples_with_log_of(last_but_one);
  EXPECT_LE(fewer, all);
  for (const std::size_t cut : {std::size_t{1}, kFrame, last - last_but_one - 1})
    EXPECT_EQ(samples_with_log_of(last - cut), fewer) << cut;
}

TEST_F(DiskFaultsTest, ADamagedBlobIsNamedAndAffectsNoOtherJob) {
  start_coordinator();
  const std::string id = submit(kSmall);
  const auto blob = blob_of(job(id), "box.obj");
  kill_coordinator();
  flip(blob, 10);
  const Outcome checked = check();
  EXPECT_EQ(checked.exit_code, 1);
  EXPECT_THAT(checked.out,
              AllOf(HasSubstr(blob.string()), HasSubstr("box.obj"), HasSubstr("submit the scene again")));
  restart_coordinator();
  start_worker("worker", 1);
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_FAILED));
  EXPECT_THAT(job(id).failure(), HasSubstr("box.obj"));
  const std::string again = submit(kSmall);
  EXPECT_TRUE(wait_for_state(again, v1::JOB_STATE_DONE));
}

// Mounts a file system for the state folder, which needs root.
class OwnDiskTest : public DiskFaultsTest {
 protected:
  void SetUp() override {
    std::filesystem::create_directory(disk_);
    if (mount("tessera-test", disk_.c_str(), "tmpfs", 0, "size=2m,mode=0700") != 0)
      GTEST_SKIP() << "a file system for this test cannot be mounted (that needs root): "
                   << std::strerror(errno);
    mounted_ = true;
    state_ = disk_ / "state";
  }
  ~OwnDiskTest() override {
    if (mounted_) umount2(disk_.c_str(), MNT_DETACH);
  }
  void remount(unsigned long flags, const char* options) {
    ASSERT_EQ(mount("tessera-test", disk_.c_str(), "tmpfs", MS_REMOUNT | flags, options), 0)
        << std::strerror(errno);
  }

  const std::filesystem::path disk_ = folder_ / "disk";
  bool mounted_ = false;
};

TEST_F(OwnDiskTest, AFullDiskIsReportedAndCheckpointsResumeWithSpace) {
  const std::vector<std::string> options{"--size", "256x192", "--spp", "8"};
  start_coordinator();
  const std::string id = submit(options);
  write_file(disk_ / "filler", std::string(4 << 20, 'f'));  // as much of it as fits
  start_worker("worker", 1);
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE)) << "the render does not carry on in memory";
  ASSERT_TRUE(
      poll_until(20s, [&] { return coordinator().err().find("the disk is full") != std::string::npos; }));
  EXPECT_THAT(coordinator().err(),
              HasSubstr(database().string() + ": the disk is full: free some space there"));
  EXPECT_TRUE(image(id, ".exr") == render_here(options, ".exr"));
  // There may be room for a small job in what an earlier write left; else its submitter is told.
  Process another = start_tessera({"submit", kCornell, "--size", "32x32"});
  const auto is_told = [&] {
    return another.err().find("the disk is full: free some space there") != std::string::npos;
  };
  EXPECT_TRUE(poll_until(60s, [&] { return another.wait(0s) == 0 || is_told(); })) << another.err();

  remount(0, "size=64m");
  EXPECT_TRUE(another.wait(60s).has_value());
  ASSERT_TRUE(poll_until(
      20s, [&] { return coordinator().err().find("checkpoints are written again") != std::string::npos; }));
  kill_coordinator();
  EXPECT_EQ(check().exit_code, 0) << check().out;
  restart_coordinator();
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_DONE);
  EXPECT_TRUE(image(id, ".exr") == render_here(options, ".exr"));
}

// Waiting clients see the reason as soon as the worker has failed once.
TEST_F(DiskFaultsTest, AFullDiskOfAWorkerIsReportedToWaitingClients) {
  const std::filesystem::path cache = folder_ / "cache-full";
  std::filesystem::create_directory(cache);
  if (mount("tessera-test", cache.c_str(), "tmpfs", 0, "size=64k,mode=0700") != 0)
    GTEST_SKIP() << "a file system for this test cannot be mounted (that needs root): "
                 << std::strerror(errno);
  std::string mesh = "v -1 0 -1\nv 1 0 -1\nv 0 1 -1\nf 1 2 3\n";
  mesh += "#" + std::string(400'000, '.') + "\n";
  write_file(folder_ / "mesh.obj", mesh);
  write_file(folder_ / "scene.json", R"({"camera": {"position": [0, 0, 4], "look_at": [0, 0, 0]},
    "materials": {"lamp": {"type": "lambert", "emission": 1}},
    "shapes": [{"type": "mesh", "file": "mesh.obj", "material": "lamp"}]})");
  start_coordinator();
  start_worker("full", 1);
  Process waits = start_tessera({"submit", folder_ / "scene.json", "--wait", "-o", folder_ / "x.png"});
  const auto says = [](const std::string& text) {
    return text.find("No space left on device") != std::string::npos;
  };
  EXPECT_TRUE(poll_until(60s, [&] { return says(tessera({"workers"}).out); })) << tessera({"workers"}).out;
  EXPECT_THAT(tessera({"workers"}).out, HasSubstr(") says: cannot fetch mesh.obj"));
  ASSERT_EQ(jobs().size(), 1u);
  const std::string id = jobs()[0].id();
  EXPECT_THAT(tessera({"job", id}).out, HasSubstr("worker full says: cannot fetch mesh.obj"));
  EXPECT_TRUE(poll_until(20s, [&] { return says(waits.err()); })) << waits.err();
  EXPECT_TRUE(poll_until(20s, [&] { return says(coordinator().err()); }));
  start_worker("other", 1);
  EXPECT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
  EXPECT_EQ(waits.wait(30s), 0);
  umount2(cache.c_str(), MNT_DETACH);
}

TEST_F(OwnDiskTest, AReadOnlyStateFolderIsNamedAndCanBeChecked) {
  start_coordinator();
  const std::string id = submit(kSmall);
  kill_coordinator();
  remount(MS_RDONLY, "");
  const Outcome refused = start_expecting_failure();
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err,
              AllOf(HasSubstr(state_.string()), HasSubstr("read-only file system"), HasSubstr("--state")));
  const Outcome checked = check();
  EXPECT_EQ(checked.exit_code, 0) << checked.out << checked.err;
  EXPECT_THAT(checked.out, HasSubstr(id));
  remount(0, "size=64m");
  start_worker("worker", 1);
  restart_coordinator();
  EXPECT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
}

}  // namespace
}  // namespace tessera::test
