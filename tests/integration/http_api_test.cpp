// SPDX-License-Identifier: Apache-2.0
// The HTTP API of a real coordinator, with a real worker.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/mount.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>

#include "tests/integration/farm_processes.hpp"
#include "tests/unit/http/raw_client.hpp"

namespace tessera::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class HttpApiTest : public FarmTest {
 protected:
  // HOST:PORT of the page that the coordinator has printed.
  std::string page() { return page("http"); }
  std::string page(const std::string& scheme) {
    const std::regex line("the page is at " + scheme + "://([^/]+)/");
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
  void make_certificates(const std::string& name) {
    const Process made = run({TESSERA_SOURCE_DIR "/deploy/make_certificates.sh", folder_ / name, "127.0.0.1"},
                             name + ".certificates");
    ASSERT_TRUE(std::filesystem::exists(folder_ / name / "coordinator.pem")) << made.err();
  }
  // The response to a client that trusts the authority of these certificates alone; empty if it does not
  // trust the server.
  std::string get_over_tls(const std::string& address, const std::string& path, const std::string& trusted) {
    const std::string request =
        "GET " + path + " HTTP/1.1\\r\\nHost: 127.0.0.1\\r\\nConnection: close\\r\\n\\r\\n";
    const Process client =
        run({"/bin/sh", "-c",
             "printf '" + request + "' | timeout 20 openssl s_client -quiet -verify_return_error -CAfile '" +
                 (folder_ / trusted / "ca.pem").string() + "' -connect " + address},
            "client" + std::to_string(++clients_));
    return client.out();
  }

 private:
  // Runs a program to its end.
  Process run(const std::vector<std::string>& arguments, const std::string& name) {
    ProcessOptions options;
    options.arguments = arguments;
    options.out = folder_ / (name + ".out");
    options.err = folder_ / (name + ".err");
    Process process(options);
    EXPECT_TRUE(process.wait(std::chrono::seconds(30)).has_value()) << name;
    return process;
  }

  int clients_ = 0;
};

// Unmounts a file system, whatever ends the test.
struct Mounted {
  explicit Mounted(std::filesystem::path at) : path(std::move(at)) {}
  ~Mounted() { umount2(path.c_str(), MNT_DETACH); }
  Mounted(const Mounted&) = delete;
  Mounted& operator=(const Mounted&) = delete;

  const std::filesystem::path path;
};

TEST_F(HttpApiTest, IsNotReadyWhileTheDiskOfTheStateIsFull) {
  const std::filesystem::path disk = folder_ / "disk";
  std::filesystem::create_directory(disk);
  if (mount("tessera-test", disk.c_str(), "tmpfs", 0, "size=16m,mode=0700") != 0)
    GTEST_SKIP() << "a file system for this test cannot be mounted (that needs root): "
                 << std::strerror(errno);
  const Mounted mounted(disk);
  state_ = disk / "state";
  coordinator_options_ = {"--http", "127.0.0.1:0"};
  start_coordinator();
  const auto is_ready = [&] { return get("/readyz").substr(9, 3) == "200"; };
  EXPECT_TRUE(is_ready()) << get("/readyz");
  write_file(disk / "filler", std::string(32 << 20, 'f'));  // as much of it as fits
  EXPECT_TRUE(poll_until(std::chrono::seconds(20), [&] { return !is_ready(); }));
  EXPECT_THAT(get("/readyz"), AllOf(HasSubstr("503"), HasSubstr("its disk is full")));
  EXPECT_THAT(get("/healthz"), HasSubstr("200"));
  std::filesystem::remove(disk / "filler");
  EXPECT_TRUE(poll_until(std::chrono::seconds(20), is_ready)) << get("/readyz");
  stop_coordinator();
}

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

// The page speaks TLS with the certificate of gRPC, and nothing else.
TEST_F(HttpApiTest, SpeaksTlsWithTheCertificateOfTheFarm) {
  make_certificates("farm");
  make_certificates("others");
  coordinator_options_ = {"--http",
                          "127.0.0.1:0",
                          "--tls-certificate",
                          folder_ / "farm" / "coordinator.pem",
                          "--tls-key",
                          folder_ / "farm" / "coordinator.key"};
  security_.ca = folder_ / "farm" / "ca.pem";
  start_coordinator();
  const std::string address = page("https");
  ASSERT_NE(address, "");
  EXPECT_THAT(get_over_tls(address, "/", "farm"), AllOf(HasSubstr("HTTP/1.1 200"), HasSubstr("text/html")));
  EXPECT_THAT(get_over_tls(address, "/api/v1/server", "farm"), HasSubstr("determinism_fingerprints"));
  EXPECT_EQ(get_over_tls(address, "/", "others"), "") << "its certificate is by another authority";
  http::RawClient plain(address);
  ASSERT_TRUE(plain.send("GET / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"));
  EXPECT_THAT(plain.receive_all(), Not(HasSubstr("200 OK"))) << "HTTP on an HTTPS port";
  EXPECT_TRUE(plain.is_ended());
  EXPECT_THAT(get_over_tls(address, "/healthz", "farm"), HasSubstr("HTTP/1.1 200")) << "it goes on";

  for (const char* const name : {"coordinator.pem", "coordinator.key"})
    std::filesystem::copy_file(folder_ / "others" / name, folder_ / "farm" / name,
                               std::filesystem::copy_options::overwrite_existing);
  coordinator().signal(SIGHUP);
  EXPECT_TRUE(poll_until(std::chrono::seconds(20), [&] {
    return coordinator().err().find("has read the certificate in ") != std::string::npos;
  })) << coordinator().err();
  EXPECT_THAT(get_over_tls(address, "/healthz", "others"), HasSubstr("HTTP/1.1 200"));
  EXPECT_EQ(get_over_tls(address, "/healthz", "farm"), "") << "the certificate was replaced";
}

TEST_F(HttpApiTest, NeedsAnUsableCertificate) {
  make_certificates("farm");
  make_certificates("others");
  const Outcome refused = run_coordinator(
      {"--state", folder_ / "state", "--listen", "127.0.0.1:0", "--http", "127.0.0.1:0", "--tls-certificate",
       folder_ / "farm" / "coordinator.pem", "--tls-key", folder_ / "others" / "coordinator.key"});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("coordinator: error: "), HasSubstr("coordinator.key")));
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
