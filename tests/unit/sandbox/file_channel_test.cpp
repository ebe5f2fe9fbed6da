// SPDX-License-Identifier: Apache-2.0
#include "core/sandbox/file_channel.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/sandbox/confinement.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/sandbox/in_child.hpp"

namespace tessera::sandbox {
namespace {

using core::ErrorCode;

class Channel : public testing::Test {
 protected:
  // Answers the requests of a child that runs `what` with its end of the channel; returns its wait status.
  int serve(const std::function<int(int channel)>& what, const OpenNumbered& open) {
    auto channel = FileChannel::create().value();
    const pid_t pid = fork();
    if (pid == 0) {
      channel.parent = core::OpenFile();
      _exit(what(channel.child.get()));
    }
    channel.child = core::OpenFile();
    const auto counted = [&](std::uint32_t number) {
      ++requests_;
      return open(number);
    };
    while (waits_for(channel.parent) && answer_request(channel.parent, counted)) {
    }
    int status = 0;
    EXPECT_EQ(waitpid(pid, &status, 0), pid);
    return status;
  }

  // Blocks until there is a request. False if the child has ended.
  static bool waits_for(const core::OpenFile& channel) {
    char byte = 0;
    return recv(channel.get(), &byte, 1, MSG_PEEK) > 0;
  }

  OpenNumbered open_numbered() {
    return [this](std::uint32_t number) { return open_to_send(folder_.path() / std::to_string(number)); };
  }

  static std::string content(const core::OpenFile& file) {
    std::string bytes(100, '\0');
    bytes.resize(
        static_cast<std::size_t>(std::max<ssize_t>(0, read(file.get(), bytes.data(), bytes.size()))));
    return bytes;
  }

  TemporaryFolder folder_;
  int requests_ = 0;
};

TEST_F(Channel, GivesTheFilesByTheirNumbers) {
  write_file(folder_.path() / "0", "zero");
  write_file(folder_.path() / "7", "seven");
  EXPECT_EQ(serve(
                [](int channel) {
                  const auto seven = request_file(channel, 7, "s"), zero = request_file(channel, 0, "z");
                  return seven && zero && content(*seven) == "seven" && content(*zero) == "zero" ? 0 : 1;
                },
                open_numbered()),
            0);
  EXPECT_EQ(requests_, 2);
}

TEST_F(Channel, SaysWhatCannotBeOpened) {
  ASSERT_EQ(mkfifo((folder_.path() / "1").c_str(), 0600), 0);
  EXPECT_EQ(serve(
                [](int channel) {
                  const auto none = request_file(channel, 0, "'a'"), fifo = request_file(channel, 1, "'b'");
                  if (none || none.error().code != ErrorCode::kNotFound) return 1;
                  if (none.error().message != "'a' does not exist") return 2;
                  return fifo || fifo.error().message != "'b' cannot be opened" ? 3 : 0;
                },
                open_numbered()),
            0);
}

TEST_F(Channel, IsForReading) {
  write_file(folder_.path() / "0", "zero");
  serve(
      [](int channel) {
        const auto file = request_file(channel, 0, "");
        return file && write(file->get(), "x", 1) < 0 ? 0 : 1;
      },
      open_numbered());
  EXPECT_EQ(read_file(folder_.path() / "0"), "zero");
}

// A process that was taken over cannot make its parent block or fail.
TEST_F(Channel, EndsWhereAProcessDoesNotKeepToTheProtocol) {
  write_file(folder_.path() / "0", "zero");
  for (const std::string& request : {std::string("x"), std::string(5, 'x'), std::string(100'000, 'x')}) {
    auto channel = FileChannel::create().value();
    ASSERT_EQ(send(channel.child.get(), request.data(), request.size(), 0),
              static_cast<ssize_t>(request.size()));
    EXPECT_FALSE(answer_request(channel.parent, open_numbered())) << request.size();
  }
  auto channel = FileChannel::create().value();
  const std::uint32_t number = 0;
  int answered = 0;
  for (; answered < 100'000; ++answered) {
    if (send(channel.child.get(), &number, sizeof number, MSG_DONTWAIT) < 0) break;
    if (!answer_request(channel.parent, open_numbered())) break;
  }
  EXPECT_LT(answered, 100'000) << "a process that takes no answers gets no more";
}

TEST_F(Channel, ServesAConfinedProcess) {
  if (kIsSanitized) GTEST_SKIP() << "sanitizers need what confinement takes away";
  write_file(folder_.path() / "0", "zero");
  const auto ask = [](int channel) {
    if (dup2(channel, kFileChannel) < 0 || !confine({})) return 2;
    const auto file = request_file(kFileChannel, 0, "");
    return file && content(*file) == "zero" ? 0 : 1;
  };
  EXPECT_EQ(serve(ask, open_numbered()), 0) << "whatever user it has become";
  const auto keep_all = [](int channel) {
    if (dup2(channel, kFileChannel) < 0 || !confine({})) return 2;
    std::vector<core::OpenFile> files;
    for (int i = 0; i < 20; ++i) {
      auto file = request_file(kFileChannel, 0, "'a'");
      if (!file) return file.error().message == "'a' cannot be opened: too many files" ? 0 : 3;
      files.push_back(*std::move(file));
    }
    return 1;
  };
  EXPECT_EQ(serve(keep_all, open_numbered()), 0);
}

}  // namespace
}  // namespace tessera::sandbox
