// SPDX-License-Identifier: Apache-2.0
// The HTTP API of a real coordinator, with a real worker.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "tests/integration/farm_processes.hpp"
#include "tests/unit/http/raw_client.hpp"

namespace tessera::test {
namespace {

using ::testing::HasSubstr;

class HttpApiTest : public FarmTest {
 protected:
  // HOST:PORT of the page that the coordinator has printed.
  std::string page() {
    const std::regex line("the page is at http://([^/]+)/");
    std::smatch found;
    std::string out;
    poll_until(std::chrono::seconds(20), [&] {
      out = coordinator().out();
      return std::regex_search(out, found, line);
    });
    return found.empty() ? "" : found[1].str();
  }
  // As a browser on this machine.
  std::string get(const std::string& path) {
    http::RawClient client(page());
    EXPECT_TRUE(client.send("GET " + path + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"));
    return client.receive_all();
  }
  std::string body(const std::string& path) {
    const std::string response = get(path);
    EXPECT_EQ(response.substr(9, 3), "200") << path << response.substr(0, 200);
    return response.substr(response.find("\r\n\r\n") + 4);
  }
};

TEST_F(HttpApiTest, ShowsWhatTheFarmRenders) {
  coordinator_options_ = {"--http", "127.0.0.1:0"};
  start_coordinator();
  start_worker("worker", 1);
  http::RawClient events(page());
  ASSERT_TRUE(events.send("GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\n\r\n"));
  EXPECT_THAT(events.receive_until("event: reset"), HasSubstr("text/event-stream"));
  const std::string id = submit({"--size", "96x64", "--spp", "4"});
  EXPECT_THAT(events.receive_until("\"done\""), HasSubstr(id));
  EXPECT_EQ(body("/api/v1/jobs/" + id + "/image?format=exr"),
            render_here({"--size", "96x64", "--spp", "4"}, ".exr"));
  EXPECT_EQ(nlohmann::json::parse(body("/api/v1/jobs/" + id + "/pixel?x=80&y=60"))["samples"], 4);
  EXPECT_EQ(nlohmann::json::parse(body("/api/v1/workers"))["workers"][0]["name"], "worker");
  EXPECT_THAT(get("/"), HasSubstr("Content-Security-Policy"));
  const Outcome second =
      run_coordinator({"--state", (folder_ / "other").string(), "--listen", "127.0.0.1:0", "--http", page()});
  EXPECT_NE(second.exit_code, 0) << "its port is taken";
  EXPECT_THAT(second.err, HasSubstr(page()));
}

TEST_F(HttpApiTest, GoesOnAfterARestart) {
  coordinator_options_ = {"--http", "127.0.0.1:0"};
  start_coordinator();
  const std::string id = submit({"--size", "64x64", "--spp", "4"});
  kill_coordinator();
  restart_coordinator();
  http::RawClient events(page());
  // A token of before.
  ASSERT_TRUE(events.send("GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\nLast-Event-ID: AAAA\r\n\r\n"));
  EXPECT_THAT(events.receive_until(id), HasSubstr("event: reset"));
}

}  // namespace
}  // namespace tessera::test
