// SPDX-License-Identifier: Apache-2.0
// Who may call what over HTTP, and what other web sites may not.
#include <gmock/gmock.h>

#include <regex>

#include "core/image/file_io.hpp"
#include "server/http/origin.hpp"
#include "server/http/routes.hpp"
#include "server/http/sessions.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/server/http_service.hpp"

namespace tessera::http_api {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class HttpAccess : public HttpService {
 protected:
  using Sent = std::unique_ptr<http::RawClient>;
  // Sends a call of the route. The answers of many come at once, also where they are delayed.
  Sent send_to(const Route& route, Headers headers) {
    const std::string path = std::regex_replace(std::string(route.pattern), std::regex("\\{id\\}"), "0123");
    if (route.is_change()) headers.emplace("X-Tessera", "1");
    return send(std::string(route.verb), path, route.is_change() ? "{}" : "", headers);
  }
  Sent send_as(const Route& route, const std::string& name) {
    return send_to(route, {{"Authorization", "Bearer " + token_of(name)}});
  }
  // Streams need not end.
  static int status_of(const Sent& sent) {
    const std::string head = sent->receive_until("\r\n\r\n");
    return head.size() < 12 ? 0 : std::stoi(head.substr(9, 3));
  }
  std::string log_in(const std::string& name) {
    const Reply reply = call("POST", "/api/v1/session", R"({"token":")" + token_of(name) + R"("})");
    EXPECT_EQ(reply.status, 200) << reply.body;
    const std::string cookie = reply.header("Set-Cookie");
    return cookie.substr(0, cookie.find(';'));
  }
};

TEST_F(HttpAccess, IsThatOfTheMethodOfEachRoute) {
  start_page_with_names();
  struct Calls {
    const Route& route;
    bool is_for_users;
    Sent nobody, stranger, worker, ada, root;
  };
  std::vector<Calls> all;
  for (const Route& route : routes())
    all.push_back({route,
                   server_->services().gate.methods().at(route.method_path()).role != auth::Role::kAdmin,
                   send_to(route, {}), send_as(route, "x"), send_as(route, "work"), send_as(route, "ada"),
                   send_as(route, "root")});
  for (const Calls& calls : all) {
    SCOPED_TRACE(calls.route.name());
    const auto is_admitted = testing::AnyOf(200, 204, 400, 404, 412);
    EXPECT_EQ(status_of(calls.nobody), 401);
    EXPECT_EQ(status_of(calls.stranger), 401);
    EXPECT_EQ(status_of(calls.worker), 403);
    const int of_ada = status_of(calls.ada);
    if (calls.is_for_users) {
      EXPECT_THAT(of_ada, is_admitted);
    } else {
      EXPECT_EQ(of_ada, 403);
    }
    EXPECT_THAT(status_of(calls.root), is_admitted);
  }
}

TEST_F(HttpAccess, NeedsNoTokenOnAnOpenFarm) {
  start_page();
  EXPECT_EQ(get("/api/v1/jobs").status, 200);
  const auto session = get("/api/v1/session").json();
  EXPECT_EQ(session["open"], true);
  EXPECT_EQ(session["role"], "");
}

TEST_F(HttpAccess, OfASessionIsThatOfItsToken) {
  start_page_with_names();
  EXPECT_EQ(get("/api/v1/session").json()["principal"], nullptr);
  EXPECT_EQ(call("POST", "/api/v1/session", R"({"token":"wrongwrongwrongwrong"})").status, 401);
  const Reply opened = call("POST", "/api/v1/session", R"({"token":")" + token_of("ada") + R"("})");
  EXPECT_EQ(opened.json()["principal"], "ada");
  EXPECT_EQ(opened.json()["role"], "submit");
  const std::string cookie = opened.header("Set-Cookie");
  EXPECT_THAT(cookie, HasSubstr("; HttpOnly; SameSite=Strict; Path=/; Max-Age=43200"));
  EXPECT_THAT(cookie, Not(HasSubstr("Secure"))) << "browsers would not send it without TLS";
  EXPECT_THAT(cookie, Not(HasSubstr(token_of("ada"))));
  const Headers with_cookie{{"Cookie", cookie.substr(0, cookie.find(';'))}};
  EXPECT_EQ(get("/api/v1/jobs", with_cookie).status, 200);
  EXPECT_EQ(get("/api/v1/session", with_cookie).json()["principal"], "ada");
  EXPECT_EQ(get("/api/v1/quarantine", with_cookie).status, 403);
  EXPECT_EQ(call("DELETE", "/api/v1/session", {}, with_cookie).status, 204);
  EXPECT_EQ(get("/api/v1/jobs", with_cookie).status, 401);
}

TEST_F(HttpAccess, OfASessionEndsWithItsToken) {
  start_page_with_names();
  const Headers as_ada{{"Cookie", log_in("ada")}}, as_ben{{"Cookie", log_in("ben")}};
  write_file(folder_.path() / "fewer", "submit ben " + token_of("ben") + "\n");
  server_->replace_access(*auth::Access::read(folder_.path() / "fewer"));
  EXPECT_EQ(get("/api/v1/jobs", as_ada).status, 401);
  EXPECT_EQ(get("/api/v1/session", as_ada).json()["principal"], nullptr);
  EXPECT_EQ(get("/api/v1/jobs", as_ben).status, 200);
}

TEST_F(HttpAccess, ThrottlesFailedLogins) {
  start_page_with_names();
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < 22; ++i)
    EXPECT_EQ(call("POST", "/api/v1/session", R"({"token":"wrongwrongwrongwrong"})").status, 401);
  EXPECT_GT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1));
}

TEST_F(HttpAccess, IsNotForOtherSites) {
  start_page();
  const std::string own = "http://" + page_->address();
  const std::string job = submit_now();
  const std::string path = "/api/v1/jobs/" + job + "/cancel";
  EXPECT_EQ(send("POST", path, {}, {})->receive_until("\r\n").substr(9, 3), "403") << "without the header";
  for (const std::string origin : {"http://evil.example", "null", "https://evil.example:7480", "file://"})
    EXPECT_EQ(call("POST", path, {}, {{"Origin", origin}}).status, 403) << origin;
  EXPECT_EQ(coordinator_->jobs().get(job)->state(), v1::JOB_STATE_RUNNING);
  EXPECT_EQ(call("POST", path, {}, {{"Origin", own}}).status, 200);
  EXPECT_EQ(call("POST", "/api/v1/session", "{}", {{"Origin", "http://evil.example"}}).status, 403);
}

// A page of another site whose name was rebound to this machine.
TEST_F(HttpAccess, IsNotForOtherNamesOfAnOpenFarm) {
  start_page();
  for (const std::string path : {"/", "/api/v1/jobs", "/api/v1/session"}) {
    EXPECT_EQ(get(path, {{"Host", "evil.example:7480"}}).status, 403) << path;
    EXPECT_EQ(get(path, {{"Host", "localhost:7480"}}).status, 200) << path;
    EXPECT_EQ(get(path, {{"Host", "[::1]:7480"}}).status, 200) << path;
  }
}

TEST_F(HttpAccess, OfThePageNeedsNothing) {
  start_page_with_names();
  const Reply page = get("/");
  EXPECT_EQ(page.status, 200);
  EXPECT_THAT(page.header("Content-Security-Policy"), HasSubstr("default-src 'none'"));
  EXPECT_EQ(page.header("X-Content-Type-Options"), "nosniff");
  EXPECT_EQ(get("/healthz").status, 200);
  EXPECT_EQ(get("/readyz").status, 200);
  EXPECT_EQ(get("/nothing").status, 404);
  EXPECT_EQ(get("/api/v1/nothing").code(), "NOT_FOUND");
  const Reply wrong_verb = call("DELETE", "/api/v1/jobs");
  EXPECT_EQ(wrong_verb.status, 405);
  EXPECT_EQ(wrong_verb.header("Allow"), "GET, POST");
  EXPECT_EQ(get("/api/v1/jobs").header("X-Content-Type-Options"), "nosniff");
}

TEST(HttpOrigin, IsTheHostOfTheRequest) {
  const auto is_refused = [](Headers headers, bool is_secure) {
    http::Request request;
    request.headers = {headers.begin(), headers.end()};
    request.headers["x-tessera"] = "1";
    request.is_secure = is_secure;
    return !check_origin(request);
  };
  EXPECT_FALSE(is_refused({{"host", "farm.example"}, {"origin", "https://farm.example"}}, false))
      << "behind a proxy that ends TLS";
  EXPECT_FALSE(is_refused({{"host", "FARM.example:7480"}, {"origin", "https://farm.example:7480"}}, true));
  EXPECT_TRUE(is_refused({{"host", "farm.example"}, {"origin", "http://farm.example"}}, true));
  EXPECT_TRUE(is_refused({{"host", "farm.example"}, {"origin", "https://farm.example.evil"}}, true));
  EXPECT_TRUE(is_refused({{"host", ""}, {"origin", ""}}, false));
}

TEST(HttpSessions, AreBounded) {
  Sessions::Clock::time_point now{};
  Sessions sessions({}, [&] { return now; });
  const std::string first = sessions.open("ada");
  EXPECT_EQ(sessions.token_digest(first), "ada");
  for (std::size_t i = 0; i < Sessions::kMaxOfToken; ++i) sessions.open("ada");
  EXPECT_EQ(sessions.count(), Sessions::kMaxOfToken);
  EXPECT_EQ(sessions.token_digest(first), std::nullopt) << "the oldest gives way";
  EXPECT_EQ(sessions.token_digest(""), std::nullopt);
  now += Sessions::kLifetime;
  const std::string last = sessions.open("ben");
  EXPECT_EQ(sessions.count(), 1u);
  sessions.close(last);
  EXPECT_EQ(sessions.count(), 0u);
}

TEST(HttpSessions, OutliveARestart) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "sessions";
  Sessions::Clock::time_point now{std::chrono::hours(1)};
  const auto clock = [&] { return now; };
  std::string of_ada, of_ben;
  {
    Sessions sessions(file, clock);
    of_ada = sessions.open("ada");
    now += std::chrono::hours(1);
    of_ben = sessions.open("ben");
    sessions.close(sessions.open("cleo"));
  }
  const std::string bytes = core::read_file(file.string()).value();
  EXPECT_EQ(bytes.find(of_ada), std::string::npos);
  Sessions restarted(file, clock);
  EXPECT_EQ(restarted.count(), 2u);
  EXPECT_EQ(restarted.token_digest(of_ada), "ada");
  EXPECT_EQ(restarted.token_digest(of_ben), "ben");
  now += Sessions::kLifetime - std::chrono::minutes(30);
  EXPECT_EQ(restarted.token_digest(of_ada), std::nullopt);
  Sessions later(file, clock);
  EXPECT_EQ(later.count(), 1u);
}

TEST(HttpSessions, OfADamagedFileHaveEnded) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "sessions";
  ASSERT_TRUE(core::write_file_atomically(file.string(), "\xff nonsense 9223372036854775807\n a b c\n"));
  Sessions sessions(file);
  EXPECT_EQ(sessions.count(), 0u);
  EXPECT_EQ(sessions.token_digest(sessions.open("ada")), "ada");
}

TEST(HttpActivity, KeepsTheLastHours) {
  ActivityLog log;
  for (std::uint64_t i = 0; i < ActivityLog::kKept + 5; ++i) log.add({.busy_workers = i});
  const std::vector<ActivitySample> samples = log.samples();
  ASSERT_EQ(samples.size(), 1080u);
  EXPECT_EQ(samples.front().busy_workers, 5u);
  EXPECT_EQ(samples.back().busy_workers, ActivityLog::kKept + 4);
}

TEST(HttpActivity, CountsWorkersThatHoldLeasesAndJobsThatRun) {
  farm::Totals totals;
  totals.scheduler.samples_per_second = 3.5;
  totals.scheduler.workers[static_cast<std::size_t>(scheduler::WorkerActivity::kBusy)] = 2;
  totals.scheduler.workers[static_cast<std::size_t>(scheduler::WorkerActivity::kIdle)] = 4;
  totals.scheduler.jobs[static_cast<std::size_t>(scheduler::JobState::kRunning)] = 5;
  totals.scheduler.jobs[static_cast<std::size_t>(scheduler::JobState::kPaused)] = 6;
  EXPECT_EQ(activity_of(totals), (ActivitySample{3.5, 2, 5}));
}

}  // namespace
}  // namespace tessera::http_api
