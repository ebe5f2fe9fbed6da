// SPDX-License-Identifier: Apache-2.0
// A client that sends any bytes, and a handler made of functions.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "core/http/server.hpp"

namespace tessera::http {

// A connection to HOST:PORT. Nothing blocks for longer than 20 seconds.
class RawClient {
 public:
  // `receive_buffer_bytes`: of the socket; 0 leaves it as it is.
  explicit RawClient(const std::string& address, int receive_buffer_bytes = 0);
  ~RawClient();
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  bool send(const std::string& bytes);
  // Some bytes; empty at the end of the connection, or if there is nothing for too long.
  std::string receive();
  // All until the text appears, or the connection ends.
  std::string receive_until(const std::string& text);
  std::string receive_all() { return receive_until({}); }
  // Whether the server has ended the connection.
  bool is_ended() const { return is_ended_; }

 private:
  int socket_ = -1;
  bool is_ended_ = false;
};

// The whole response to one request; the connection is closed after it.
std::string get(const std::string& address, const std::string& path, const std::string& headers = {});

// The body of a response in the chunked encoding, as far as it was received.
std::string unchunked(const std::string& response);

class FunctionHandler final : public Handler {
 public:
  std::function<Reception(const Request&)> on_receive = [](const Request&) { return Reception{}; };
  std::function<Response(const Request&)> on_handle = [](const Request& request) {
    return Response{.body = "You asked for " + request.path};
  };

  Reception receive(const Request& request) override { return on_receive(request); }
  Response handle(const Request& request) override { return on_handle(request); }
};

// On a free port of this machine; ends the test if it does not start.
std::unique_ptr<Server> start_server(Handler& handler, ServerOptions options = {});

}  // namespace tessera::http
