// SPDX-License-Identifier: Apache-2.0
// Bodies that are produced while they are sent.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "tests/unit/http/raw_client.hpp"

namespace tessera::http {
namespace {

using std::chrono::milliseconds;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

// What is put here is sent.
class Mailbox {
 public:
  void put(std::string text, BodySource::State state = BodySource::State::kWait) {
    std::unique_lock lock(mutex_);
    text_ += text;
    state_ = state;
    has_started_.wait(lock, [this] { return wake_ != nullptr; });
    lock.unlock();
    wake_();
  }
  void start(Wake wake) {
    const std::lock_guard lock(mutex_);
    wake_ = std::move(wake);
    has_started_.notify_all();
  }
  BodySource::State read(std::string& out) {
    const std::lock_guard lock(mutex_);
    ++reads_;
    out += std::exchange(text_, {});
    return state_;
  }
  int reads() {
    const std::lock_guard lock(mutex_);
    return reads_;
  }
  std::atomic<bool> is_gone{false};

 private:
  std::mutex mutex_;
  std::condition_variable has_started_;
  std::string text_;
  BodySource::State state_ = BodySource::State::kWait;
  Wake wake_;
  int reads_ = 0;
};

class MailboxSource final : public BodySource {
 public:
  explicit MailboxSource(std::shared_ptr<Mailbox> box, milliseconds longest = std::chrono::seconds(15))
      : box_(std::move(box)), longest_(longest) {}
  ~MailboxSource() override { box_->is_gone = true; }
  void start(Wake wake) override { box_->start(std::move(wake)); }
  State read(std::string& out, std::size_t) override { return box_->read(out); }
  milliseconds longest_wait() const override { return longest_; }

 private:
  const std::shared_ptr<Mailbox> box_;
  const milliseconds longest_;
};

FunctionHandler mailbox_handler(const std::shared_ptr<Mailbox>& box,
                                milliseconds longest = std::chrono::seconds(15)) {
  FunctionHandler handler;
  handler.on_handle = [box, longest](const Request&) {
    Response response;
    response.source = std::make_unique<MailboxSource>(box, longest);
    return response;
  };
  return handler;
}

void request_stream(RawClient& client) {
  ASSERT_TRUE(client.send("GET /stream HTTP/1.1\r\nHost: test\r\n\r\n"));
}

TEST(HttpStream, IsSentAsItIsProduced) {
  const auto box = std::make_shared<Mailbox>();
  auto handler = mailbox_handler(box);
  const auto server = start_server(handler);
  RawClient client(server->address());
  request_stream(client);
  std::string all;
  for (const char* const text : {"first", "second", "third"}) {
    box->put(text);
    all += client.receive_until(text);
    EXPECT_THAT(all, HasSubstr(text));
  }
  box->put("last", BodySource::State::kEnd);
  all += client.receive_until("0\r\n\r\n");
  EXPECT_EQ(unchunked(all), "firstsecondthirdlast");
  // The connection goes on.
  request_stream(client);
  EXPECT_THAT(client.receive_until("0\r\n\r\n"), HasSubstr("200 OK"));
}

// Wakes that come while the source is read, before it waits, and after the end are not lost, and do no harm.
TEST(HttpStream, MissesNoNotification) {
  const auto box = std::make_shared<Mailbox>();
  auto handler = mailbox_handler(box);
  const auto server = start_server(handler);
  RawClient client(server->address());
  request_stream(client);
  std::string expected;
  std::thread writer([&] {
    for (int i = 0; i < 2000; ++i) box->put(std::to_string(i) + ",");
    for (int i = 0; i < 10; ++i) box->put(".", BodySource::State::kEnd);
  });
  for (int i = 0; i < 2000; ++i) expected += std::to_string(i) + ",";
  const std::string all = client.receive_until("0\r\n\r\n");
  writer.join();
  EXPECT_THAT(all, EndsWith("\r\n0\r\n\r\n"));
  EXPECT_THAT(unchunked(all), testing::StartsWith(expected + "."));
}

TEST(HttpStream, IsPolledAgainWithoutANotification) {
  const auto box = std::make_shared<Mailbox>();
  auto handler = mailbox_handler(box, milliseconds(20));
  const auto server = start_server(handler);
  RawClient client(server->address());
  request_stream(client);
  client.receive_until("\r\n\r\n");
  for (int i = 0; i < 2000 && box->reads() < 5; ++i) std::this_thread::sleep_for(milliseconds(5));
  EXPECT_GE(box->reads(), 5);
}

TEST(HttpStream, CutsTheConnectionIfTheSourceFails) {
  const auto box = std::make_shared<Mailbox>();
  auto handler = mailbox_handler(box);
  const auto server = start_server(handler);
  RawClient client(server->address());
  request_stream(client);
  box->put("half", BodySource::State::kFailed);
  const std::string all = client.receive_all();
  EXPECT_THAT(all, Not(EndsWith("0\r\n\r\n")));
  EXPECT_TRUE(client.is_ended());
}

TEST(HttpStream, OfKnownSizeHasALength) {
  FunctionHandler handler;
  handler.on_handle = [](const Request&) {
    const auto box = std::make_shared<Mailbox>();
    Response response;
    response.source = std::make_unique<MailboxSource>(box);
    response.size_bytes = 5;
    std::thread([box] { box->put("12345", BodySource::State::kEnd); }).detach();
    return response;
  };
  const auto server = start_server(handler);
  const std::string all = get(server->address(), "/");
  EXPECT_THAT(all, HasSubstr("Content-Length: 5\r\n"));
  EXPECT_THAT(all, EndsWith("\r\n\r\n12345"));
}

// Sends as much as is taken.
class Endless final : public BodySource {
 public:
  explicit Endless(std::atomic<std::size_t>& bytes, std::atomic<bool>& is_gone)
      : bytes_(bytes), is_gone_(is_gone) {}
  ~Endless() override { is_gone_ = true; }
  State read(std::string& out, std::size_t max_bytes) override {
    out.assign(max_bytes, 'x');
    bytes_ += max_bytes;
    return State::kMore;
  }

 private:
  std::atomic<std::size_t>& bytes_;
  std::atomic<bool>& is_gone_;
};

// It is asked for no more than the buffers hold, others are served meanwhile, and the connection ends.
TEST(HttpStream, ToASlowReaderStaysBounded) {
  std::atomic<std::size_t> bytes{0};
  std::atomic<bool> is_gone{false};
  FunctionHandler handler;
  handler.on_handle = [&](const Request& request) {
    Response response;
    if (request.path == "/stream") response.source = std::make_unique<Endless>(bytes, is_gone);
    return response;
  };
  auto server = start_server(handler, {.address = {}, .receive_timeout = milliseconds(1500)});
  RawClient client(server->address(), 4096);
  request_stream(client);
  client.receive_until("\r\n\r\n");
  EXPECT_THAT(get(server->address(), "/other"), HasSubstr("200 OK"));
  for (int i = 0; i < 2000 && !is_gone; ++i) std::this_thread::sleep_for(milliseconds(5));
  EXPECT_TRUE(is_gone);
  EXPECT_LT(bytes, 16u << 20);
  server.reset();
}

TEST(HttpStream, EndsWithTheServer) {
  const auto box = std::make_shared<Mailbox>();
  auto handler = mailbox_handler(box);
  auto server = start_server(handler);
  RawClient client(server->address());
  request_stream(client);
  box->put("text");
  EXPECT_THAT(client.receive_until("text"), HasSubstr("text"));
  server.reset();
  EXPECT_TRUE(box->is_gone);
  client.receive_all();
  EXPECT_TRUE(client.is_ended());
  box->put("after the end");
}

// A response under way is sent to its end.
TEST(HttpServer, EndsGracefully) {
  FunctionHandler handler;
  std::atomic<bool> is_handling{false};
  handler.on_handle = [&](const Request&) {
    is_handling = true;
    std::this_thread::sleep_for(milliseconds(100));
    return Response{.body = std::string(100'000, 'x') + "end"};
  };
  auto server = start_server(handler);
  RawClient client(server->address());
  request_stream(client);
  while (!is_handling) std::this_thread::sleep_for(milliseconds(1));
  std::thread stop([&] { server.reset(); });
  EXPECT_THAT(client.receive_all(), EndsWith("end"));
  stop.join();
}

}  // namespace
}  // namespace tessera::http
