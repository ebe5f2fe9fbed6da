// SPDX-License-Identifier: Apache-2.0
// Certificates and tokens between real processes: which callers are admitted, and what rejected ones are
// told.
#include <gmock/gmock.h>
#include <signal.h>

#include "tests/integration/farm_processes.hpp"

namespace tessera::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class SecurityTest : public FarmTest {
 protected:
  void SetUp() override { make_certificates("certificates"); }

  void make_certificates(const std::string& name) {
    ProcessOptions options;
    options.arguments = {TESSERA_SOURCE_DIR "/deploy/make_certificates.sh", folder_ / name, "localhost",
                         "127.0.0.1"};
    options.out = folder_ / (name + ".out");
    options.err = folder_ / (name + ".err");
    Process made(options);
    ASSERT_EQ(made.wait(std::chrono::seconds(30)), 0) << made.err();
  }
  std::string certificate(const std::string& file) { return folder_ / "certificates" / file; }

  void ask_for_tokens() {
    coordinator_options_.insert(coordinator_options_.end(), {"--tokens", certificate("tokens")});
  }
  void speak_tls() {
    coordinator_options_.insert(
        coordinator_options_.end(),
        {"--tls-certificate", certificate("coordinator.pem"), "--tls-key", certificate("coordinator.key")});
  }
  void ask_for_certificates() {
    coordinator_options_.insert(coordinator_options_.end(), {"--tls-client-ca", certificate("ca.pem")});
  }
  void be(const std::string& role) { security_.token = certificate(role + ".token"); }
  std::string refusal(const std::vector<std::string>& command) {
    const Outcome outcome = tessera(command);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
    return outcome.err;
  }
};

TEST_F(SecurityTest, AFarmWithTlsAndTokensRendersTheSameBytes) {
  speak_tls();
  ask_for_certificates();
  ask_for_tokens();
  security_ = {certificate("ca.pem"), certificate("worker.pem"), certificate("worker.key"),
               certificate("work.token"), false};
  start_coordinator();
  start_worker("worker", 2);
  security_ = {certificate("ca.pem"), certificate("client.pem"), certificate("client.key"),
               certificate("submit.token"), false};
  const std::vector<std::string> options{"--size", "96x64", "--spp", "4"};
  const std::string id = submit(options);
  const Outcome watched = tessera({"watch", id});
  EXPECT_EQ(watched.exit_code, 0) << watched.err;
  EXPECT_TRUE(image(id, ".exr") == render_here(options, ".exr"));
  EXPECT_THAT(tessera({"job", id}).out, HasSubstr("submit"));
}

TEST_F(SecurityTest, MissingCredentialsAreNamed) {
  speak_tls();
  ask_for_certificates();
  security_ = {certificate("ca.pem"), certificate("client.pem"), certificate("client.key"), "", false};
  start_coordinator();
  EXPECT_EQ(tessera({"jobs"}).exit_code, 0);

  security_ = {};
  EXPECT_THAT(refusal({"jobs"}), HasSubstr("--tls-ca"));
  security_.ca = certificate("ca.pem");
  EXPECT_THAT(refusal({"jobs"}), HasSubstr("--tls-certificate"));
  make_certificates("others");
  security_.ca = folder_ / "others" / "ca.pem";
  EXPECT_THAT(refusal({"jobs"}), HasSubstr("--tls-ca"));
  security_ = {certificate("ca.pem"), certificate("client.pem"), certificate("worker.key"), "", false};
  EXPECT_THAT(refusal({"jobs"}), HasSubstr("worker.key: this is not the key of"));
  security_ = {certificate("ca.pem"), folder_ / "others" / "client.pem", folder_ / "others" / "client.key",
               "", false};
  EXPECT_THAT(refusal({"jobs"}), HasSubstr("does not trust the authority of this --tls-certificate"));
}

// A worker retries for ever: its log gives the reason, and the new one when it changes.
TEST_F(SecurityTest, FailedConnectionsAreExplained) {
  listen_ = "127.0.0.2:0";  // not in the certificate
  speak_tls();
  start_coordinator();
  const auto says = [&](Process& worker, const char* words) {
    return poll_until(std::chrono::seconds(20),
                      [&] { return worker.err().find(words) != std::string::npos; });
  };
  EXPECT_TRUE(says(start_worker("plain", 1), "it speaks TLS and wants --tls-ca"));
  security_.ca = certificate("ca.pem");
  const char* const other_names = "its certificate is for other names";
  EXPECT_THAT(refusal({"jobs"}), HasSubstr(other_names));
  Process& misled = start_worker("misled", 1);
  EXPECT_TRUE(says(misled, other_names));
  make_certificates("others");
  security_.ca = folder_ / "others" / "ca.pem";
  EXPECT_TRUE(says(start_worker("stranger", 1), "is --tls-ca the authority of its certificate?"));
  kill_coordinator();
  EXPECT_TRUE(says(misled, "no coordinator answers at "));
}

TEST_F(SecurityTest, RolesDetermineTheAllowedCalls) {
  ask_for_tokens();
  start_coordinator();
  EXPECT_THAT(refusal({"jobs"}), HasSubstr("--token-file"));
  write_file(folder_ / "guess", "0123456789abcdef0123456789abcdef\n");
  security_.token = folder_ / "guess";
  EXPECT_THAT(refusal({"jobs"}), HasSubstr("does not know the token"));
  be("work");
  EXPECT_THAT(refusal({"jobs"}), AllOf(HasSubstr("'work'"), HasSubstr("'watch'")));
  EXPECT_THAT(refusal({"submit", kCornell}), HasSubstr("'submit'"));

  be("submit");
  Process& worker = start_worker("no worker", 1);
  EXPECT_TRUE(
      poll_until(std::chrono::seconds(20), [&] { return worker.err().find("'work'") != std::string::npos; }));
  EXPECT_EQ(worker.wait(std::chrono::seconds(0)), std::nullopt) << "it tries again";
  const std::string id = submit({"--size", "64x64", "--spp", "1"});
  be("work");
  start_worker("worker", 1);
  be("submit");
  EXPECT_EQ(tessera({"watch", id}).exit_code, 0);
  EXPECT_FALSE(image(id, ".png").empty());
  be("admin");
  EXPECT_EQ(tessera({"delete", id}).exit_code, 0);
}

TEST_F(SecurityTest, TokensAloneNeedAnOptionBeyondThisMachine) {
  listen_ = "0.0.0.0:0";
  speak_tls();
  ask_for_tokens();
  coordinator_options_.push_back("--allow-unauthenticated-connections");
  security_ = {certificate("ca.pem"), "", "", certificate("submit.token"), false};
  start_coordinator();
  EXPECT_THAT(coordinator().err(), HasSubstr("anybody who reaches 0.0.0.0:0 can use up the memory"));
}

TEST_F(SecurityTest, EachMachineAndPersonHasACertificateAndATokenOfTheirOwn) {
  const auto run = [&](const std::vector<std::string>& arguments) {
    ProcessOptions options;
    options.arguments = {TESSERA_SOURCE_DIR "/deploy/make_certificates.sh"};
    options.arguments.insert(options.arguments.end(), arguments.begin(), arguments.end());
    options.out = folder_ / "made.out";
    options.err = folder_ / "made.err";
    Process made(options);
    return made.wait(std::chrono::seconds(30));
  };
  const std::string farm = folder_ / "farm";
  EXPECT_EQ(run({farm, "localhost", "127.0.0.1", "--worker", "node1", "--user", "ada"}), 0);
  EXPECT_EQ(run({"--add", farm, "--user", "ben"}), 0);
  EXPECT_EQ(run({"--add", farm, "--user", "ben"}), 1);
  EXPECT_EQ(run({"--add", farm, "--user", "no name"}), 2);
  EXPECT_EQ(run({folder_ / "other", "--user", "ada"}), 2);
  coordinator_options_ = {
      "--tls-certificate", farm + "/coordinator.pem", "--tls-key", farm + "/coordinator.key",
      "--tls-client-ca",   farm + "/ca.pem",          "--tokens",  farm + "/tokens"};
  const auto be_named = [&](const std::string& name) {
    const std::string stem = farm + "/" + name;
    security_ = {farm + "/ca.pem", stem + ".pem", stem + ".key", stem + ".token", false};
  };
  be_named("ben");
  start_coordinator();
  const std::string id = submit({"--size", "64x64", "--spp", "1"});
  EXPECT_EQ(job(id).owner(), "ben");
  be_named("node1");
  start_worker("node1", 1);
  be_named("ada");
  EXPECT_EQ(tessera({"watch", id}).exit_code, 0);
}

TEST_F(SecurityTest, AWorkerWhoseTokenIsForgottenWaitsUntilItIsKnownAgain) {
  std::filesystem::copy_file(certificate("tokens"), folder_ / "tokens");
  coordinator_options_ = {"--tokens", folder_ / "tokens"};
  be("work");
  start_coordinator();
  Process& worker = start_worker("worker", 1);
  const auto says = [&](const char* words) {
    return poll_until(std::chrono::seconds(20),
                      [&] { return worker.err().find(words) != std::string::npos; });
  };
  ASSERT_TRUE(says("registered with the coordinator"));
  be("submit");
  const std::string id = submit({"--size", "64x64", "--spp", "40"});
  kill_coordinator();
  write_file(folder_ / "tokens", "submit submit " + read_file(certificate("submit.token")));
  restart_coordinator();
  EXPECT_TRUE(says("does not know the token"));
  kill_coordinator();
  std::filesystem::copy_file(certificate("tokens"), folder_ / "tokens",
                             std::filesystem::copy_options::overwrite_existing);
  restart_coordinator();
  EXPECT_EQ(tessera({"watch", id}).exit_code, 0);
}

// Tokens are replaced while a job is rendered and watched. A damaged file changes nothing.
TEST_F(SecurityTest, TokensAreReadAgainOnSighup) {
  const auto write_tokens = [&](const std::string& lines) { write_file(folder_ / "tokens", lines); };
  const auto token = [&](const std::string& role) {
    return role + " " + role + " " + read_file(certificate(role + ".token"));
  };
  const auto reload = [&](const std::string& words) {
    coordinator().signal(SIGHUP);
    return poll_until(std::chrono::seconds(20),
                      [&] { return coordinator().err().find(words) != std::string::npos; });
  };
  write_tokens(token("submit") + "\n");
  coordinator_options_ = {"--tokens", folder_ / "tokens"};
  be("submit");
  start_coordinator();
  const std::vector<std::string> options{"--size", "96x64", "--spp", "8"};
  const std::string id = submit(options);
  Process watching = start_tessera({"watch", id});
  be("work");
  Process& worker = start_worker("early", 1);
  EXPECT_TRUE(poll_until(std::chrono::seconds(20),
                         [&] { return worker.err().find("does not know the token") != std::string::npos; }));

  write_tokens("nonsense\n");
  ASSERT_TRUE(reload("tokens:1: a line has three words"));
  EXPECT_THAT(coordinator().err(), HasSubstr("the tokens stay as they were"));
  be("submit");
  EXPECT_EQ(tessera({"jobs"}).exit_code, 0);
  write_tokens(token("work") + "\n" + token("admin") + "\n");
  ASSERT_TRUE(reload("has read the tokens in "));
  EXPECT_THAT(refusal({"jobs"}), HasSubstr("does not know the token"));
  EXPECT_EQ(watching.wait(std::chrono::seconds(60)), 0) << watching.err();
  EXPECT_THAT(worker.err(), HasSubstr("registered with the coordinator"));
  be("admin");
  EXPECT_TRUE(image(id, ".exr") == render_here(options, ".exr"));
}

// The certificate is replaced by that of another authority while a job is rendered and watched.
TEST_F(SecurityTest, CertificatesAreReadAgainOnSighup) {
  make_certificates("others");
  const auto install = [&](const std::string& from, const std::string& file) {
    std::filesystem::copy_file(folder_ / from / file, folder_ / file,
                               std::filesystem::copy_options::overwrite_existing);
  };
  const auto reload = [&](const std::string& words) {
    coordinator().signal(SIGHUP);
    return poll_until(std::chrono::seconds(20),
                      [&] { return coordinator().err().find(words) != std::string::npos; });
  };
  install("certificates", "coordinator.pem"), install("certificates", "coordinator.key");
  coordinator_options_ = {"--tls-certificate", folder_ / "coordinator.pem", "--tls-key",
                          folder_ / "coordinator.key"};
  security_.ca = certificate("ca.pem");
  start_coordinator();
  const std::vector<std::string> options{"--size", "96x64", "--spp", "8"};
  const std::string id = submit(options);
  Process watching = start_tessera({"watch", id});
  Process& worker = start_worker("early", 1);
  EXPECT_TRUE(poll_until(std::chrono::seconds(20), [&] {
    return worker.err().find("registered with the coordinator") != std::string::npos;
  }));

  install("others", "coordinator.pem");
  ASSERT_TRUE(reload("coordinator.key: this is not the key of "));
  EXPECT_THAT(coordinator().err(), HasSubstr("the certificates stay as they were"));
  EXPECT_EQ(tessera({"jobs"}).exit_code, 0);

  install("others", "coordinator.key");
  ASSERT_TRUE(reload("has read the certificate in "));
  security_.ca = folder_ / "others" / "ca.pem";
  EXPECT_TRUE(poll_until(std::chrono::seconds(20), [&] { return tessera({"jobs"}).exit_code == 0; }));
  EXPECT_EQ(watching.wait(std::chrono::seconds(60)), 0) << watching.err();
  EXPECT_TRUE(image(id, ".exr") == render_here(options, ".exr"));
  security_.ca = certificate("ca.pem");
  EXPECT_THAT(refusal({"jobs"}), HasSubstr("--tls-ca"));
}

// The coordinator comes back with certificates of another authority and with other tokens, for which the
// worker has read its files again.
TEST_F(SecurityTest, AWorkerReadsItsCertificatesAndItsTokenAgainOnSighup) {
  make_certificates("others");
  std::filesystem::create_directory(folder_ / "files");
  const auto install = [&](const std::string& from, const std::vector<std::string>& files) {
    for (const std::string& file : files)
      std::filesystem::copy_file(folder_ / from / file, folder_ / "files" / file,
                                 std::filesystem::copy_options::overwrite_existing);
  };
  const auto own = [&](const std::string& file) { return folder_ / "files" / file; };
  const std::vector<std::string> of_coordinator{"coordinator.pem", "coordinator.key", "tokens"};
  const std::vector<std::string> of_worker{"ca.pem", "worker.pem", "worker.key", "work.token"};
  install("certificates", of_coordinator), install("certificates", of_worker);
  coordinator_options_ = {"--tls-certificate", own("coordinator.pem"), "--tls-key", own("coordinator.key"),
                          "--tls-client-ca",   own("ca.pem"),          "--tokens",  own("tokens")};
  security_ = {own("ca.pem"), own("worker.pem"), own("worker.key"), own("work.token"), false};
  start_coordinator();
  Process& worker = start_worker("worker", 1);
  const auto says = [&](const std::string& words) {
    return poll_until(std::chrono::seconds(60),
                      [&] { return worker.err().find(words) != std::string::npos; });
  };
  ASSERT_TRUE(says("registered with the coordinator"));

  install("others", {"worker.pem"});
  worker.signal(SIGHUP);
  ASSERT_TRUE(says("worker.key: this is not the key of "));
  EXPECT_THAT(worker.err(), HasSubstr("certificates and token stay as they were"));

  install("others", of_worker);
  worker.signal(SIGHUP);
  ASSERT_TRUE(says("has read certificates and token again"));
  kill_coordinator();
  install("others", of_coordinator);
  restart_coordinator();
  const std::string others = folder_ / "others";
  security_ = {others + "/ca.pem", others + "/client.pem", others + "/client.key", others + "/submit.token",
               false};
  const std::vector<std::string> options{"--size", "64x64", "--spp", "2"};
  const std::string id = submit(options);
  EXPECT_EQ(tessera({"watch", id}).exit_code, 0);
  EXPECT_TRUE(image(id, ".exr") == render_here(options, ".exr"));
}

// A client certificate with a line in the file of tokens needs no token.
TEST_F(SecurityTest, CertificatesHaveRolesToo) {
  write_file(folder_ / "tokens", "work worker certificate shared\nsubmit client certificate\n");
  speak_tls();
  ask_for_certificates();
  coordinator_options_.insert(coordinator_options_.end(), {"--tokens", folder_ / "tokens"});
  security_ = {certificate("ca.pem"), certificate("worker.pem"), certificate("worker.key"), "", false};
  start_coordinator();
  start_worker("worker", 1);
  EXPECT_THAT(refusal({"jobs"}), HasSubstr("'work'"));
  security_ = {certificate("ca.pem"), certificate("client.pem"), certificate("client.key"), "", false};
  EXPECT_THAT(tessera({"server"}).out, AllOf(HasSubstr("client"), HasSubstr("submit")));
  const std::string id = submit({"--size", "64x64", "--spp", "1"});
  EXPECT_THAT(tessera({"job", id, "--json"}).out, HasSubstr(R"("owner":"client")"));
  EXPECT_EQ(tessera({"watch", id}).exit_code, 0);
  EXPECT_THAT(tessera({"workers", "--json"}).out, HasSubstr(R"("principal":"worker")"));
  EXPECT_THAT(refusal({"quarantine"}), HasSubstr("'admin'"));
}

TEST_F(SecurityTest, OnlyOwnersAndAdministratorsChangeAJob) {
  write_file(folder_ / "tokens",
             "submit alice alice-0123456789abcdef\n# others\nsubmit bob bob-0123456789abcdef\n"
             "admin root root-0123456789abcdef\n");
  for (const char* name : {"alice", "bob", "root"})
    write_file(folder_ / name, std::string(name) + "-0123456789abcdef\n");
  coordinator_options_ = {"--tokens", folder_ / "tokens"};
  start_coordinator();
  security_.token = folder_ / "alice";
  const std::string id = submit({"--size", "64x64", "--spp", "1"});
  security_.token = folder_ / "bob";
  for (const char* change : {"pause", "cancel", "delete"})
    EXPECT_THAT(refusal({change, id}), HasSubstr("submitted by 'alice'")) << change;
  EXPECT_THAT(refusal({"update", id, "--priority", "9"}), HasSubstr("submitted by 'alice'"));
  EXPECT_EQ(tessera({"job", id}).exit_code, 0) << "everybody may look";
  security_.token = folder_ / "alice";
  EXPECT_EQ(tessera({"update", id, "--priority", "9"}).exit_code, 0);
  EXPECT_EQ(tessera({"pause", id}).exit_code, 0);
  security_.token = folder_ / "root";
  EXPECT_EQ(tessera({"delete", id}).exit_code, 0);
}

TEST_F(SecurityTest, AnUnsafeCoordinatorDoesNotStart) {
  const auto complaint = [&](const std::vector<std::string>& options, ExitCode exit_code) {
    ProcessOptions process;
    process.arguments = {TESSERA_COORDINATOR_PROGRAM, "--state", folder_ / "state"};
    process.arguments.insert(process.arguments.end(), options.begin(), options.end());
    process.out = folder_ / "out";
    process.err = folder_ / "err";
    Process coordinator(process);
    EXPECT_EQ(coordinator.wait(std::chrono::seconds(20)), exit_code);
    return coordinator.err();
  };
  EXPECT_THAT(complaint({"--listen", "0.0.0.0:0"}, 1), AllOf(HasSubstr("0.0.0.0"), HasSubstr("--insecure")));
  EXPECT_THAT(complaint({"--listen", "0.0.0.0:0", "--tls-certificate", certificate("coordinator.pem"),
                         "--tls-key", certificate("coordinator.key"), "--tokens", certificate("tokens")},
                        1),
              AllOf(HasSubstr("--tls-client-ca"), HasSubstr("--allow-unauthenticated-connections")));
  const std::pair<std::string, std::string> mistakes[] = {
      {"submit alice", "three words"},
      {"boss alice 0123456789abcdef", "a role"},
      {"submit alice short", "at least 16"},
      {"submit alice not#a#token#at#all", "at least 16"},
      {"submit 0123456789abcdef0123456789abcdef0123456789abcdef a-name-of-some-length", "a name"},
      {"submit alice 0123456789abcdef\nsubmit bob 0123456789abcdef", "somebody already"},
      {"# nobody", "no token"}};
  for (const auto& [text, complaint_about] : mistakes) {
    write_file(folder_ / "tokens", text + "\n");
    const std::string said = complaint({"--listen", "127.0.0.1:0", "--tokens", folder_ / "tokens"}, 1);
    EXPECT_THAT(said, AllOf(HasSubstr("/tokens:"), HasSubstr(complaint_about)));
    EXPECT_THAT(said, ::testing::Not(HasSubstr("0123456789"))) << "a secret in a log";
  }
  complaint({"--listen", "127.0.0.1:0", "--tokens", ""}, 2);
  EXPECT_THAT(complaint({"--listen", "7420"}, 1), HasSubstr("--listen: '7420' is not HOST:PORT"));
  EXPECT_THAT(complaint({"--listen", "127.0.0.1:0", "--validator", folder_ / "none"}, 1),
              HasSubstr("none: there is no such program: install tessera-validator there"));
  for (const char* option : {"--audit", "--lease-seconds", "--stall-seconds", "--max-calls-per-second"})
    EXPECT_THAT(complaint({option, "nan"}, 2), HasSubstr("got 'nan'")) << option;
}

}  // namespace
}  // namespace tessera::test
