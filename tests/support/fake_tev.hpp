// SPDX-License-Identifier: Apache-2.0
// Stands in for tev: accepts connections on a free loopback port and decodes the packets of its protocol
// strictly, into images.
#pragma once

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <map>
#include <mutex>
#include <semaphore>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "core/image/image.hpp"

namespace tessera::test {

class FakeTev {
 public:
  // Port 0: a free one.
  explicit FakeTev(std::uint16_t port = 0) {
    listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const int yes = 1;
    ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(port);
    socklen_t size = sizeof address;
    auto* const generic = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(::bind(listener_, generic, size), 0);
    EXPECT_EQ(::listen(listener_, 8), 0);
    EXPECT_EQ(::getsockname(listener_, generic, &size), 0);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { serve(); });
  }
  ~FakeTev() { stop(); }

  std::uint16_t port() const { return port_; }
  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }

  // Ends the connections, as a viewer that is closed.
  void stop() {
    if (!thread_.joinable()) return;
    ends_ = true;
    ::shutdown(listener_, SHUT_RDWR);
    if (const int open = connection_; open >= 0) ::shutdown(open, SHUT_RDWR);
    thread_.join();
    ::close(listener_);
  }

  // Blocks until a first connection has ended by itself.
  void wait_for_end() { ended_.acquire(); }

  struct Shown {
    int width = 0, height = 0;
    std::vector<std::string> channels;
    std::vector<float> values;  // of each pixel, row by row, those of its channels
  };
  std::map<std::string, Shown> all() const {
    const std::lock_guard lock(mutex_);
    return images_;
  }
  // The first three channels of each, which must be R, G and B.
  std::map<std::string, core::Image> images() const {
    std::map<std::string, core::Image> colours;
    for (const auto& [name, shown] : all()) {
      EXPECT_GE(shown.channels.size(), 3u);
      const std::size_t channels = shown.channels.size();
      core::Image image(shown.width, shown.height);
      for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const float* const pixel = shown.values.data() + i * channels;
        image.pixels[i] = {pixel[0], pixel[1], pixel[2]};
      }
      colours.emplace(name, std::move(image));
    }
    return colours;
  }
  int packets() const {
    const std::lock_guard lock(mutex_);
    return packets_;
  }

 private:
  // Reads the values of one packet; what is wrong with it fails the test.
  class Reader {
   public:
    explicit Reader(std::string_view bytes) : rest_(bytes) {}

    template <typename T>
    T number() {
      T value{};
      EXPECT_GE(rest_.size(), sizeof value);
      if (rest_.size() < sizeof value) return value;
      std::memcpy(&value, rest_.data(), sizeof value);
      rest_.remove_prefix(sizeof value);
      return value;
    }
    std::string text() {
      const std::size_t end = rest_.find('\0');
      EXPECT_NE(end, std::string_view::npos);
      std::string value(rest_.substr(0, end));
      rest_.remove_prefix(std::min(end + 1, rest_.size()));
      return value;
    }
    std::string_view rest() const { return rest_; }

   private:
    std::string_view rest_;
  };

  static bool receive(int socket, void* to, std::size_t size) {
    return ::recv(socket, to, size, MSG_WAITALL) == static_cast<ssize_t>(size);
  }

  void serve() {
    while (!ends_) {
      const int connection = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
      if (connection < 0) continue;
      connection_ = connection;
      std::uint32_t size = 0;
      while (!ends_ && receive(connection, &size, sizeof size)) {
        EXPECT_GT(size, sizeof size);
        std::string packet(size - sizeof size, '\0');
        if (!receive(connection, packet.data(), packet.size())) break;
        take(Reader(packet));
      }
      connection_ = -1;
      ::close(connection);
      ended_.release();
    }
  }

  void take(Reader packet) {
    const std::lock_guard lock(mutex_);
    ++packets_;
    const auto operation = packet.number<std::uint8_t>();
    EXPECT_EQ(packet.number<std::uint8_t>(), 0) << "takes the focus";
    const std::string name = packet.text();
    if (operation == 4) return create(name, packet);
    EXPECT_EQ(operation, 6);
    update(name, packet);
  }

  static std::vector<std::string> channels_of(Reader& packet) {
    std::vector<std::string> channels(static_cast<std::size_t>(packet.number<std::int32_t>()));
    for (std::string& channel : channels) channel = packet.text();
    return channels;
  }

  void create(const std::string& name, Reader& packet) {
    Shown image{packet.number<std::int32_t>(), packet.number<std::int32_t>(), {}, {}};
    image.channels = channels_of(packet);
    EXPECT_TRUE(packet.rest().empty());
    image.values.resize(image.channels.size() * static_cast<std::size_t>(image.width) *
                        static_cast<std::size_t>(image.height));
    images_[name] = std::move(image);
  }

  void update(const std::string& name, Reader& packet) {
    const std::vector<std::string> channels = channels_of(packet);
    const auto x = packet.number<std::int32_t>(), y = packet.number<std::int32_t>();
    const auto width = packet.number<std::int32_t>(), height = packet.number<std::int32_t>();
    std::vector<std::int64_t> offsets(channels.size()), strides(channels.size());
    for (std::int64_t& offset : offsets) offset = packet.number<std::int64_t>();
    for (std::int64_t& stride : strides) stride = packet.number<std::int64_t>();
    std::vector<float> data(packet.rest().size() / sizeof(float));
    std::memcpy(data.data(), packet.rest().data(), data.size() * sizeof(float));
    ASSERT_TRUE(images_.contains(name)) << "updated before it was created";
    Shown& image = images_.at(name);
    ASSERT_EQ(channels, image.channels);
    ASSERT_TRUE(x >= 0 && y >= 0 && x + width <= image.width && y + height <= image.height);
    const std::int64_t pixels = std::int64_t{width} * height;
    for (std::int64_t i = 0; i < pixels; ++i) {
      const std::int64_t to = (y + i / width) * image.width + x + i % width;
      for (std::size_t c = 0; c < channels.size(); ++c)
        image.values[static_cast<std::size_t>(to) * channels.size() + c] =
            data.at(static_cast<std::size_t>(offsets[c] + i * strides[c]));
    }
  }

  int listener_ = -1;
  std::uint16_t port_ = 0;
  std::atomic<bool> ends_{false};
  std::atomic<int> connection_{-1};
  std::counting_semaphore<> ended_{0};
  mutable std::mutex mutex_;
  // Guarded by mutex_.
  std::map<std::string, Shown> images_;
  int packets_ = 0;
  std::thread thread_;
};

}  // namespace tessera::test
