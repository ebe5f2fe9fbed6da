// SPDX-License-Identifier: Apache-2.0
// The page of a local render (--view), asked over HTTP while the built program renders and after it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/temporary_folder.hpp"
#include "tests/unit/client/glowing_sphere.hpp"
#include "tests/unit/client/process.hpp"
#include "tests/unit/http/raw_client.hpp"

namespace tessera::client {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// HOST:PORT of the page that the program has printed.
std::string address_in(const std::string& err) {
  const std::string before = "the page is at http://";
  const std::size_t begin = err.find(before) + before.size();
  return err.substr(begin, err.find('/', begin) - begin);
}

class View : public testing::Test {
 protected:
  View() { write_file(path("scene.json"), kGlowingSphere); }

  std::string path(const std::string& name) const { return folder_.path() / name; }
  // Renders with the page, and calls `use` with its address when `text` has appeared on stderr; then Ctrl-C.
  ProcessResult render(std::vector<std::string> more, const std::string& text,
                       const std::function<void(const std::string&)>& use) const {
    more.insert(more.begin(),
                {"render", path("scene.json"), "-o", path("a.exr"), "--view", "127.0.0.1:0", "--quiet"});
    return run_tessera_and_use(
        more, text, [&](const std::string& err) { use(address_in(err)); }, SIGINT);
  }
  static std::string response(const std::string& address, const std::string& request,
                              const std::string& host = "localhost") {
    http::RawClient client(address);
    EXPECT_TRUE(client.send(request + " HTTP/1.1\r\nHost: " + host + "\r\nConnection: close\r\n\r\n"));
    return client.receive_all();
  }
  static std::string body(const std::string& address, const std::string& target) {
    const std::string all = response(address, "GET " + target);
    EXPECT_THAT(all, HasSubstr("HTTP/1.1 200")) << target;
    return body_of(all);
  }
  static std::string body_of(const std::string& all) {
    return all.find("Transfer-Encoding: chunked") == std::string::npos ? all.substr(all.find("\r\n\r\n") + 4)
                                                                       : http::unchunked(all);
  }

  const TemporaryFolder folder_;
};

TEST_F(View, ShowsTheImageWhileItIsRendered) {
  const auto use = [](const std::string& address) {
    EXPECT_THAT(response(address, "GET /"), AllOf(HasSubstr("200 OK"), HasSubstr("Content-Security-Policy"),
                                                  HasSubstr("Content-Type: text/html")));
    const nlohmann::json job = nlohmann::json::parse(body(address, "/api/v1/jobs/local"));
    EXPECT_EQ(job["state"], "running");
    EXPECT_EQ(job["width"], 150);
    EXPECT_EQ(nlohmann::json::parse(body(address, "/api/v1/server"))["features"],
              nlohmann::json::array({"local"}));
    nlohmann::json pixel = {{"samples", 0}};
    for (int i = 0; i < 2000 && pixel["samples"] == 0; ++i) {
      // 503 before the render has begun.
      const std::string answer = response(address, "GET /api/v1/jobs/local/pixel?x=75&y=50");
      if (answer.starts_with("HTTP/1.1 200")) pixel = nlohmann::json::parse(body_of(answer));
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    EXPECT_GT(pixel["samples"], 0);
    EXPECT_GT(pixel["value"][0], 0.5);
    EXPECT_EQ(nlohmann::json::parse(body(address, "/api/v1/jobs/local/map"))["tiles"].size(), 6u);
    EXPECT_THAT(body(address, "/api/v1/jobs/local/thumbnail?size=32").substr(0, 4),
                testing::StrEq("\x89PNG"));
    http::RawClient events(address);
    ASSERT_TRUE(events.send("GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\n\r\n"));
    EXPECT_THAT(events.receive_until("\"running\""), HasSubstr("event: reset"));
  };
  const ProcessResult result = render({"--spp", "10000000"}, "the page is at", use);
  EXPECT_EQ(result.exit_status, 130) << result.err;
  EXPECT_TRUE(std::filesystem::exists(path("a.exr")));
}

TEST_F(View, StaysWithTheFinishedImageUntilCtrlC) {
  const auto use = [&](const std::string& address) {
    EXPECT_EQ(nlohmann::json::parse(body(address, "/api/v1/jobs/local"))["state"], "done");
    EXPECT_TRUE(body(address, "/api/v1/jobs/local/image?format=exr") == read_file(path("a.exr")));
    EXPECT_THAT(body(address, "/api/v1/jobs/local/tiles"), HasSubstr(R"({"type":"end"})"));
  };
  const ProcessResult result = render({}, "the page stays at", use);
  EXPECT_EQ(result.exit_status, 0) << result.err;
}

TEST_F(View, DownloadsAreWhatARenderWrites) {
  const auto use = [&](const std::string& address) {
    const std::string image = "/api/v1/jobs/local/image?format=exr";
    EXPECT_TRUE(body(address, image) == read_file(path("a.exr")));
    write_file(path("part.exr"), body(address, image + "&region=10,20,90,75"));
  };
  const ProcessResult result = render({"--layers", "alpha,normal,crypto_object"}, "the page stays at", use);
  EXPECT_EQ(result.exit_status, 0) << result.err;
  const ProcessResult part = run_tessera({"render", path("scene.json"), "-o", path("crop.exr"), "--crop",
                                          "10,20,90,75", "--layers", "alpha,normal,crypto_object"});
  EXPECT_EQ(part.exit_status, 0) << part.err;
  EXPECT_TRUE(read_file(path("part.exr")) == read_file(path("crop.exr")));
}

TEST_F(View, IsForThisMachineAndChangesNothing) {
  const auto use = [](const std::string& address) {
    EXPECT_THAT(response(address, "GET /api/v1/jobs/local", "evil.example"), HasSubstr("HTTP/1.1 403"));
    EXPECT_THAT(response(address, "POST /api/v1/jobs/local/cancel"), HasSubstr("HTTP/1.1 4"));
    EXPECT_THAT(response(address, "GET /api/v1/workers"), HasSubstr("HTTP/1.1 404"));
    EXPECT_THAT(response(address, "GET /api/v1/jobs/local/pixel?x=150&y=0"), HasSubstr("OUT_OF_RANGE"));
    EXPECT_THAT(response(address, "GET /api/v1/jobs/local/tiles?level=9"), HasSubstr("\"field\":\"level\""));
    EXPECT_EQ(nlohmann::json::parse(body(address, "/api/v1/jobs/local"))["state"], "done");
    // Its port is taken.
    const ProcessResult second = run_tessera({"render", "cornell", "-o", "never.png", "--view", address});
    EXPECT_EQ(second.exit_status, 1);
    EXPECT_THAT(second.err, AllOf(HasSubstr("error: --view: "), HasSubstr(address)));
  };
  EXPECT_EQ(render({}, "the page stays at", use).exit_status, 0);
}

// The scene is not taken for the address.
TEST_F(View, NeedsNoAddress) {
  const ProcessResult result = run_tessera_and_use(
      {"render", "-o", path("a.exr"), "--view", path("scene.json")}, "the page stays at",
      [](const std::string& err) { EXPECT_THAT(address_in(err), testing::StartsWith("127.0.0.1:")); },
      SIGTERM);
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("wrote "));
}

}  // namespace
}  // namespace tessera::client
