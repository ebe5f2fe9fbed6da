// SPDX-License-Identifier: Apache-2.0
// A raw connection on which a test sends HTTP/2 frames (RFC 9113) that no library would send. Not
// thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <string>

namespace tessera::test {

class Http2Connection {
 public:
  // Connects to HOST:PORT on the loopback. The peer may send so many bytes on each stream.
  Http2Connection(const std::string& address, std::uint32_t stream_window_bytes);
  ~Http2Connection();
  Http2Connection(const Http2Connection&) = delete;
  Http2Connection& operator=(const Http2Connection&) = delete;

  // Starts a call of "/package.Service/Method", without a message if `message` is null. False if the peer has
  // closed the connection.
  bool call(const std::string& method, const std::string* message = nullptr);
  // Reads frames for at most so long, so that the peer can continue writing.
  void drain(int milliseconds);

  // The number of streams in the frames read so far that ended, by RST_STREAM, by HEADERS with END_STREAM, or
  // by both.
  std::size_t ended_streams() const { return ended_streams_.size(); }
  // The peer's SETTINGS_MAX_CONCURRENT_STREAMS; 0 before it was read.
  std::uint32_t max_concurrent_streams() const { return max_concurrent_streams_; }

 private:
  bool send(const std::string& bytes);
  void take_frames();
  void take_settings(const std::string& payload);

  const int socket_;
  std::string received_;
  std::uint32_t next_stream_ = 1;
  std::set<std::uint32_t> ended_streams_;
  std::uint32_t max_concurrent_streams_ = 0;
};

}  // namespace tessera::test
