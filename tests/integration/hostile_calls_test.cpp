// SPDX-License-Identifier: Apache-2.0
// Hostile calls, also without credentials, neither end a coordinator nor exhaust its memory, and it serves
// others meanwhile.
#include <gmock/gmock.h>
#include <grpcpp/client_context.h>
#include <sys/stat.h>

#include <cstdio>
#include <fstream>
#include <memory>
#include <vector>

#include "proto/blob.hpp"
#include "proto/channel.hpp"
#include "tests/integration/farm_processes.hpp"
#include "tests/integration/http2_connection.hpp"
#include "tests/integration/raw_call.hpp"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kGetJob = "/tessera.v1.RenderService/GetJob";

// A message that parses into one object for every two bytes: empty messages in field 1.
std::string empty_messages(std::size_t bytes) {
  std::string message;
  while (message.size() < bytes) message += std::string("\x0a\0", 2);
  return message;
}

class HostileCallsTest : public FarmTest {
 protected:
  void start(const std::vector<std::string>& options = {}) {
    coordinator_options_ = options;
    start_coordinator();
    EXPECT_TRUE(jobs().empty());  // the first call allocates memory of its own
  }
  void start_with_tokens(std::vector<std::string> options = {}) {
    write_file(folder_ / "tokens", "admin root root-0123456789abcdef\n");
    write_file(folder_ / "root", "root-0123456789abcdef\n");
    security_.token = folder_ / "root";
    options.insert(options.end(), {"--tokens", folder_ / "tokens"});
    start(options);
  }
  // The coordinator's peak resident memory.
  std::uint64_t peak_mib() {
    std::ifstream status("/proc/" + std::to_string(coordinator().pid()) + "/status");
    for (std::string line; std::getline(status, line);)
      if (line.starts_with("VmHWM:")) return std::stoull(line.substr(6)) / 1024;
    return 0;
  }
  // A job whose description has about a megabyte: one file with many names.
  std::string submit_with_many_names() {
    const std::string scene = R"({
      "camera": {"position": [0, 0, 4], "look_at": [0, 0, 0]},
      "materials": {"wall": {"type": "lambert", "albedo": [0.5, 0.5, 0.5]}},
      "shapes": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "wall"}]
    })";
    const auto digest = proto::to_proto(proto::digest_of(scene));
    grpc::ClientContext uploading;
    v1::UploadBlobResponse uploaded;
    const auto stream = api().UploadBlob(&uploading, &uploaded);
    v1::UploadBlobRequest chunk;
    *chunk.mutable_chunk()->mutable_digest() = digest;
    chunk.mutable_chunk()->set_data(scene);
    stream->Write(chunk);
    stream->WritesDone();
    EXPECT_TRUE(stream->Finish().ok());
    v1::SubmitJobRequest request;
    request.mutable_bundle()->set_scene_path("0");
    for (int i = 0; i < 5000; ++i) {
      v1::Bundle::Asset& asset = *request.mutable_bundle()->add_assets();
      asset.set_path(std::to_string(i) + (i == 0 ? "" : std::string(200, 'x')));
      *asset.mutable_digest() = digest;
    }
    std::string id;
    const grpc::Status status = submit_and_validate(request, &id);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return id;
  }
  void expect_well(std::uint64_t before_mib, std::uint64_t more_mib) {
    EXPECT_LE(peak_mib(), before_mib + more_mib);
    EXPECT_FALSE(coordinator().wait(0ms).has_value()) << "it has ended";
    submit({"--size", "16x16", "--spp", "1"});
  }
};

TEST_F(HostileCallsTest, StreamsWithoutAMessageAreLimitedAndEnded) {
  start({"--stall-seconds", "1"});
  const std::uint64_t before = peak_mib();
  Http2Connection connection(address(), 1 << 20);
  connection.drain(1000);
  EXPECT_EQ(connection.max_concurrent_streams(), 100u);
  for (int i = 0; i < 20'000 && connection.call(kGetJob); ++i)
    if (i % 500 == 0) connection.drain(0);
  expect_well(before, 64);

  Http2Connection modest(address(), 1 << 20);
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(modest.call(kGetJob));
  EXPECT_TRUE(poll_until(30s, [&] {
    modest.drain(100);
    return modest.ended_streams() == 50;
  })) << modest.ended_streams();
}

TEST_F(HostileCallsTest, UnauthenticatedCallsAreRejectedBeforeTheirMessageIsRead) {
  start_with_tokens();
  const std::uint64_t before = peak_mib();
  Http2Connection connection(address(), 1 << 20);
  ASSERT_TRUE(connection.call(kGetJob)) << "a call whose message never comes";
  EXPECT_TRUE(poll_until(10s, [&] {
    connection.drain(100);
    return connection.ended_streams() == 1;
  }));
  const std::string swelling = empty_messages(16 << 20);
  for (const char* const method : {"RenderService/FindMissingBlobs", "RenderService/SubmitJob",
                                   "WorkerService/Synchronize", "WorkerService/SubmitResult"}) {
    const auto answer = raw_call(address(), std::string("/tessera.v1.") + method, swelling);
    ASSERT_FALSE(answer);
  }
  expect_well(before, 64);
}

TEST_F(HostileCallsTest, MessagesThatExpandAreRejectedBeforeTheyAreParsed) {
  start();
  const std::uint64_t before = peak_mib();
  const std::string digests = empty_messages(16 << 20);
  std::string held;
  while (held.size() < 16 << 20) held += std::string("\x32\0", 2);
  std::string bundle;
  while (bundle.size() < 16 << 20) bundle += std::string("\x12\0", 2);
  const std::uint32_t size = static_cast<std::uint32_t>(bundle.size());
  std::string submission = "\x1a";  // field 3, with this length
  for (std::uint32_t left = size; left > 0; left >>= 7)
    submission.push_back(static_cast<char>((left & 127) | (left > 127 ? 128 : 0)));
  submission += bundle;
  const struct {
    std::string method, message, sentence;
  } cases[] = {
      {"RenderService/FindMissingBlobs", digests, "(tessera-coordinator --max-bundle-files)"},
      {"RenderService/SubmitJob", submission, "(tessera-coordinator --max-bundle-files)"},
      {"RenderService/GetJob", digests, "GetJob takes at most 4096"},
      {"WorkerService/Synchronize", held, "Synchronize takes at most"},
      {"WorkerService/SubmitResult", digests, "more than"},
  };
  for (const auto& each : cases) {
    const auto answer = raw_call(address(), "/tessera.v1." + each.method, each.message);
    ASSERT_FALSE(answer) << each.method;
    EXPECT_THAT(answer.error().message, HasSubstr(each.sentence)) << each.method;
  }
  expect_well(before, 150);
}

TEST_F(HostileCallsTest, CompressedMessagesAreRefused) {
  start();
  const std::uint64_t before = peak_mib();
  const auto stub = v1::RenderService::NewStub(*proto::open_channel(address()));
  v1::SubmitJobRequest request;
  request.set_name(std::string(60 << 20, '\0'));
  for (const auto algorithm : {GRPC_COMPRESS_GZIP, GRPC_COMPRESS_DEFLATE}) {
    grpc::ClientContext context;
    context.set_compression_algorithm(algorithm);
    v1::SubmitJobResponse response;
    EXPECT_EQ(stub->SubmitJob(&context, request, &response).error_code(), grpc::StatusCode::UNIMPLEMENTED);
  }
  expect_well(before, 32);
}

TEST_F(HostileCallsTest, UnreadAnswersAreBounded) {
  start({"--max-answer-mib", "8", "--max-calls-per-second", "100000"});
  const std::string message = "\x0a " + submit_with_many_names();  // GetJobRequest{job_id}
  const std::uint64_t before = peak_mib();
  std::vector<std::unique_ptr<Http2Connection>> connections;
  for (int i = 0; i < 10; ++i) {
    connections.push_back(std::make_unique<Http2Connection>(address(), 0));
    for (int j = 0; j < 90; ++j) ASSERT_TRUE(connections.back()->call(kGetJob, &message));
    connections.back()->drain(500);
  }
  expect_well(before, 100);
}

TEST_F(HostileCallsTest, UnreadableMessagesAreExplained) {
  start();
  const auto not_utf8 = raw_call(address(), kGetJob, "\x0a\x01\xff");
  ASSERT_FALSE(not_utf8);
  EXPECT_EQ(not_utf8.error().code, core::ErrorCode::kInvalidArgument);
  EXPECT_THAT(not_utf8.error().message, HasSubstr("UTF-8"));
}

TEST_F(HostileCallsTest, GuessedTokensAreLoggedRarelyAndAnsweredSlowly) {
  start_with_tokens();
  write_file(folder_ / "guess", "0123456789abcdef0123456789abcdef\n");
  proto::ClientSecurity guess;
  guess.token = folder_ / "guess";
  const auto guesser = v1::RenderService::NewStub(*proto::open_channel(address(), guess));
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < 40; ++i) {
    grpc::ClientContext context;
    v1::ListJobsResponse response;
    EXPECT_EQ(guesser->ListJobs(&context, {}, &response).error_code(), grpc::StatusCode::UNAUTHENTICATED);
  }
  EXPECT_GE(std::chrono::steady_clock::now() - begin, 3s);
  EXPECT_THAT(coordinator().err(), HasSubstr("rejected /tessera.v1.RenderService/ListJobs of ipv4:127.0.0.1: "
                                             "this farm does not know the token"));
  std::size_t lines = 0;
  const std::string log = coordinator().err();
  for (std::size_t at = log.find("rejected"); at != std::string::npos; at = log.find("rejected", at + 1))
    ++lines;
  EXPECT_LE(lines, 5u);
  EXPECT_TRUE(jobs().empty()) << "who has a token is served at once";
}

TEST_F(HostileCallsTest, TokenSchemesAreCaseInsensitive) {
  start_with_tokens();
  const auto stub = v1::RenderService::NewStub(*proto::open_channel(address()));
  grpc::ClientContext context;
  context.AddMetadata("authorization", "bearer root-0123456789abcdef");
  v1::ListJobsResponse response;
  EXPECT_TRUE(stub->ListJobs(&context, {}, &response).ok());
}

// Reflection would be parsed before a token is checked.
TEST_F(HostileCallsTest, ReflectionIsForFarmsWithoutTokens) {
  start_with_tokens();
  EXPECT_FALSE(
      raw_call(address(), "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo", "\x3a\x01*"));
}

TEST_F(HostileCallsTest, SecretsAndStateAreForTheOwnerAlone) {
  write_file(folder_ / "tokens", "admin root root-0123456789abcdef\n");
  std::filesystem::permissions(folder_ / "tokens", static_cast<std::filesystem::perms>(0644));
  start_with_tokens();
  EXPECT_THAT(coordinator().err(), HasSubstr("every user of this machine can read the secret in"));
  for (const char* const file : {"tessera.db", "tessera.db-wal"}) {
    struct ::stat status {};
    ASSERT_EQ(::stat((state_ / file).c_str(), &status), 0) << file;
    EXPECT_EQ(status.st_mode & 0777, 0600u) << file;
  }
}

// 1,040 stacks of 8 MiB.
TEST_F(HostileCallsTest, TooManyThreadsAreReportedAtTheStart) {
  ProcessOptions options;
  options.arguments = {"/bin/sh", "-c",
                       "ulimit -s 8192; ulimit -v 1500000; exec " TESSERA_WORKER
                       " --coordinator 127.0.0.1:1 --threads 1024 --cache " +
                           (folder_ / "cache").string()};
  options.out = folder_ / "out";
  options.err = folder_ / "err";
  Process process(options);
  EXPECT_EQ(process.wait(20s), 1);
  EXPECT_THAT(process.err(), HasSubstr("a worker with --threads 1024 needs 1040 threads"));
}

TEST_F(HostileCallsTest, ATooSmallAddressSpaceIsReportedAtTheStart) {
  const std::string coordinator =
      TESSERA_COORDINATOR_PROGRAM " --listen 127.0.0.1:0 --state " + (folder_ / "state").string();
  const std::string worker =
      TESSERA_WORKER " --coordinator 127.0.0.1:1 --threads 1 --cache " + (folder_ / "cache").string();
  for (const std::string& program : {coordinator, worker})
    for (const char* const kib : {"900000", "400000", "150000"}) {
      ProcessOptions options;
      options.arguments = {"/bin/sh", "-c", std::string("ulimit -v ") + kib + "; exec " + program};
      options.out = folder_ / "out";
      options.err = folder_ / "err";
      Process process(options);
      EXPECT_EQ(process.wait(20s), 1);
      EXPECT_THAT(process.err(), AllOf(HasSubstr("MiB of addresses"), HasSubstr("ulimit -v")));
    }
}

}  // namespace
}  // namespace tessera::test
