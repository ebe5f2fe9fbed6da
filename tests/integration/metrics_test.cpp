// SPDX-License-Identifier: Apache-2.0
// Metrics of real processes, as Prometheus scrapes them.
#include <gmock/gmock.h>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <regex>

#include "tests/integration/farm_processes.hpp"

namespace tessera::test {
namespace {

using ::testing::HasSubstr;

// The port of "metrics at http://127.0.0.1:PORT/metrics" in a log.
std::string metrics_port(const Process& process) {
  const std::regex line("metrics at http://127\\.0\\.0\\.1:([0-9]+)/metrics");
  std::smatch found;
  std::string log;
  poll_until(std::chrono::seconds(20), [&] {
    log = process.err();
    return std::regex_search(log, found, line);
  });
  return found.empty() ? "" : found[1].str();
}

// The whole answer.
std::string answer(const std::string& port, const std::string& path) {
  addrinfo* address = nullptr;
  if (getaddrinfo("127.0.0.1", port.c_str(), nullptr, &address) != 0) return "";
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const bool connected = ::connect(socket, address->ai_addr, address->ai_addrlen) == 0;
  freeaddrinfo(address);
  const std::string request = "GET " + path + " HTTP/1.0\r\n\r\n";
  std::string response, buffer(4096, '\0');
  if (connected && ::send(socket, request.data(), request.size(), MSG_NOSIGNAL) > 0)
    for (ssize_t count; (count = ::recv(socket, buffer.data(), buffer.size(), 0)) > 0;)
      response.append(buffer, 0, static_cast<std::size_t>(count));
  ::close(socket);
  return response;
}

// The metrics.
std::string scrape(const std::string& port) {
  const std::string response = answer(port, "/metrics");
  const std::size_t body = response.find("\r\n\r\n");
  return body == std::string::npos ? "" : response.substr(body + 4);
}

class MetricsTest : public FarmTest {
 protected:
  // What promtool says about the metrics; nothing if they are as they should be.
  std::string complaints(const std::string& metrics) {
    write_file(folder_ / "metrics", metrics);
    const std::string command = "promtool check metrics <" + (folder_ / "metrics").string() + " >" +
                                (folder_ / "complaints").string() + " 2>&1";
    const int status = std::system(command.c_str());
    const std::string said = read_file(folder_ / "complaints");
    return status == 0 ? said : said + "promtool failed";
  }
  static bool has_promtool() { return std::system("command -v promtool >/dev/null") == 0; }
};

TEST_F(MetricsTest, TellWhatAFarmHasDone) {
  coordinator_options_ = {"--metrics", "127.0.0.1:0"};
  start_coordinator();
  const Process& worker = start_worker("worker", 1, {"--metrics", "127.0.0.1:0"});
  const std::string id = submit({"--size", "64x64", "--spp", "4"});
  ASSERT_EQ(tessera({"watch", id}).exit_code, 0);
  const std::string samples = std::to_string(64 * 64 * 4);
  const std::string of_coordinator = scrape(metrics_port(coordinator()));
  EXPECT_THAT(of_coordinator, HasSubstr("\ntessera_jobs_ended_total{state=\"done\"} 1\n"));
  EXPECT_THAT(of_coordinator, HasSubstr("\ntessera_samples_accepted_total " + samples + "\n"));
  EXPECT_THAT(of_coordinator, HasSubstr("\ntessera_validations_total{outcome=\"accepted\"} 1\n"));
  const std::string of_worker = scrape(metrics_port(worker));
  EXPECT_THAT(of_worker, HasSubstr("\ntessera_worker_samples_rendered_total " + samples + "\n"));
  EXPECT_THAT(of_worker, HasSubstr("\ntessera_worker_connected 1\n"));
  EXPECT_THAT(of_worker, HasSubstr("\ntessera_worker_scene_loads_total{outcome=\"loaded\"} 1\n"));
  if (!has_promtool()) GTEST_SKIP() << "there is no promtool (scripts/setup.sh test)";
  EXPECT_EQ(complaints(of_coordinator), "");
  EXPECT_EQ(complaints(of_worker), "");
  EXPECT_NE(complaints("tessera_without_help 1\n"), "") << "promtool accepts anything";
}

// As the probes of Kubernetes ask (deploy/kubernetes/base/worker.yaml).
TEST_F(MetricsTest, SayThatAWorkerIsReadyWhileItsCoordinatorAnswers) {
  start_coordinator();
  const std::string port = metrics_port(start_worker("worker", 1, {"--metrics", "127.0.0.1:0"}));
  const auto is_ok = [&](const std::string& path) { return answer(port, path).find(" 200 ") == 8; };
  EXPECT_TRUE(poll_until(std::chrono::seconds(20), [&] { return is_ok("/readyz"); }));
  EXPECT_TRUE(is_ok("/healthz"));
  kill_coordinator();
  EXPECT_TRUE(poll_until(std::chrono::seconds(20), [&] { return !is_ok("/readyz"); }));
  EXPECT_TRUE(is_ok("/healthz")) << "a restart would not bring the coordinator back";
}

TEST_F(MetricsTest, ProgramsDoNotStartWithoutThem) {
  coordinator_options_ = {"--metrics", "127.0.0.1:0"};
  start_coordinator();
  const std::string taken = "127.0.0.1:" + metrics_port(coordinator());
  const Outcome second =
      run_coordinator({"--listen", "127.0.0.1:0", "--state", folder_ / "other", "--metrics", taken});
  EXPECT_EQ(second.exit_code, 1);
  EXPECT_THAT(second.err, HasSubstr("--metrics: cannot listen on " + taken + ": Address already in use"));
  Process& worker = start_worker("worker", 1, {"--metrics", "9464"});
  EXPECT_EQ(worker.wait(std::chrono::seconds(20)), 1);
  EXPECT_THAT(worker.err(), HasSubstr("--metrics: must be HOST:PORT"));
}

}  // namespace
}  // namespace tessera::test
