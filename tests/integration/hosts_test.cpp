// SPDX-License-Identifier: Apache-2.0
// A farm on several hosts: a coordinator, workers and a client with a network namespace each.
#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tests/integration/network_farm.hpp"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;

constexpr double kMegabit = 1e6 / 8;

class HostsTest : public NetworkFarmTest {
 protected:
  const std::vector<std::string> options_{"--size", "128x96", "--spp", "16"};
  static constexpr std::uint64_t kSamples = 128ull * 96 * 16;

  // Renders on the farm with a client of its own host, and compares with a render here.
  void expect_same_bytes() {
    const std::string waited = folder_ / "waited.exr";
    std::vector<std::string> arguments{"submit", kCornell, "--wait", "-o", waited};
    arguments.insert(arguments.end(), options_.begin(), options_.end());
    Process client = start_tessera(arguments);
    EXPECT_EQ(client.wait(180s), 0) << client.err();
    EXPECT_TRUE(read_file(waited) == render_here(options_, ".exr"));
  }
};

TEST_F(HostsTest, ThreeWorkersOneOfThemFarAwayAndOneOfThemLateRenderTheSameBytes) {
  network().set_line(kSecond, 50ms, 10 * kMegabit);  // 100 ms there and back
  start_coordinator();
  start_worker("first", 1);
  start_worker("second", 1);
  ASSERT_TRUE(wait_for_workers(2));
  const std::string id = submit(options_);
  ASSERT_TRUE(wait_for_samples(id, kSamples / 20));
  start_worker("third", 1);
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE, 180s));
  EXPECT_TRUE(image(id, ".exr") == render_here(options_, ".exr"));
  EXPECT_EQ(job(id).samples_done(), kSamples);
  EXPECT_TRUE(poll_until(60s, [&] { return is_heard("third"); }));
}

// The other one is tried, by workers and clients alike.
TEST_F(HostsTest, ANameWithTwoAddressesOneOfThemDead) {
  // Nobody has the first; connections to it are not refused, but get no answer.
  write_file(folder_ / "hosts",
             "fd77::99 farm.example\n" + Network::address_of(kCoordinator) + " farm.example\n");
  if (const auto why_not = Process::cannot_replace_hosts(folder_ / "hosts"))
    GTEST_SKIP() << "no hosts file of its own: " << *why_not;
  hosts_file_ = folder_ / "hosts";
  start_coordinator();
  coordinator_name_ = "farm.example";
  start_worker("first", 1);
  expect_same_bytes();
}

TEST_F(HostsTest, AFarmWithoutIPv4) {
  listen_ = "[" + Network::ipv6_address_of(kCoordinator) + "]:0";
  for (const int host : {1, kCoordinator, kFirst, kSecond, kThird, kClient}) network().remove_ipv4(host);
  start_coordinator();
  for (const std::string name : {"first", "second", "third"})
    start_worker(name, 1, {"--serve-blobs", "[::]:0"});
  ASSERT_TRUE(wait_for_workers(3));
  expect_same_bytes();
}

class AssetsTest : public NetworkFarmTest {
 protected:
  static constexpr std::uint64_t kAssetBytes = 24'000'000, kTextureBytes = 8'000'000;
  static constexpr int kWorkers = 6;

  // A mesh that is mostly comments, and a texture: two files of bytes that have no pattern.
  void write_scene() {
    std::string mesh = "v -1 0 -1\nv 1 0 -1\nv 0 1 -1\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
    while (mesh.size() < kAssetBytes)
      mesh += "# " + std::to_string(std::hash<std::size_t>{}(mesh.size())) + "\n";
    write_file(folder_ / "mesh.obj", mesh);
    constexpr std::uint32_t kWidth = 1000, kHeight = kTextureBytes / (3 * sizeof(float) * kWidth);
    std::vector<float> pixels(3 * kWidth * kHeight);
    std::uint32_t state = 1;
    for (float& value : pixels) {
      state = state * 1664525u + 1013904223u;
      value = static_cast<float>(state >> 8) / (1 << 24);
    }
    std::string texture = "PF\n" + std::to_string(kWidth) + " " + std::to_string(kHeight) + "\n-1.0\n";
    texture.append(reinterpret_cast<const char*>(pixels.data()), pixels.size() * sizeof(float));
    write_file(folder_ / "texture.pfm", texture);
    write_file(folder_ / "scene.json", R"({"camera": {"position": [0, 0, 4], "look_at": [0, 0, 0]},
      "textures": {"noise": {"file": "texture.pfm"}},
      "materials": {"lamp": {"type": "lambert", "emission": 1, "albedo": 0.5},
                    "noisy": {"type": "lambert", "albedo": {"texture": "noise"}}},
      "shapes": [{"type": "mesh", "file": "mesh.obj", "material": "noisy"},
                 {"type": "sphere", "center": [0, -2, 0], "radius": 2, "material": "lamp"}]})");
  }
  std::uint64_t cached_bytes(const std::string& worker) const {
    std::uint64_t bytes = 0;
    std::error_code none;
    for (const auto& file : std::filesystem::directory_iterator(folder_ / ("cache-" + worker), none))
      if (file.path().filename().string().size() == 64) bytes += file.file_size(none);  // whole blobs
    return bytes;
  }
  std::uint64_t scene_bytes() const {
    std::uint64_t bytes = 0;
    for (const char* const file : {"scene.json", "mesh.obj", "texture.pfm"})
      bytes += std::filesystem::file_size(folder_ / file);
    return bytes;
  }
};

// Six workers that begin at the same time. One by one, they would take 80 s, and six times the bytes.
TEST_F(AssetsTest, CostTheCoordinatorLessThanTwiceTheirBytes) {
  write_scene();
  std::vector<std::string> names;
  for (int i = 0; i < kWorkers; ++i) {
    names.push_back("worker" + std::to_string(i));
    add_host(names.back(), 10 + i);
    if (IsSkipped()) return;
    network().set_line(10 + i, 0ms, 20 * kMegabit);
  }
  start_coordinator(30);
  const Outcome submitted =
      tessera({"submit", folder_ / "scene.json", "--size", "1024x1024", "--spp", "256"});
  ASSERT_EQ(submitted.exit_code, 0) << submitted.err;
  ASSERT_TRUE(wait_for_state(jobs().at(0).id(), v1::JOB_STATE_RUNNING));
  network().set_line(kCoordinator, 0ms, 20 * kMegabit);
  const std::uint64_t before = network().sent_bytes(kCoordinator);
  for (const std::string& name : names) start_worker(name, 1, {"--serve-blobs", "0.0.0.0:0"});
  const bool all_have_it = poll_until(200s, [&] {
    return std::all_of(names.begin(), names.end(),
                       [&](const std::string& name) { return cached_bytes(name) >= scene_bytes(); });
  });
  const auto sent = static_cast<double>(network().sent_bytes(kCoordinator) - before);
  EXPECT_TRUE(all_have_it);
  RecordProperty("sent_over_scene_bytes", std::to_string(sent / static_cast<double>(scene_bytes())));
  EXPECT_LT(sent, 2 * static_cast<double>(scene_bytes()));
  EXPECT_GT(sent, static_cast<double>(scene_bytes())) << "they had it from elsewhere";
  for (const std::string& name : names)
    EXPECT_EQ(cached_bytes(name), scene_bytes()) << "more than the scene needs";
}

}  // namespace
}  // namespace tessera::test
