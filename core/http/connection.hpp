// SPDX-License-Identifier: Apache-2.0
// A connection of a client, and the request that it is about. MHD's thread calls it, and other threads wake
// it.
#pragma once

#include <microhttpd.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "core/http/server.hpp"
#include "core/http/timers.hpp"
#include "core/http/tls_identity.hpp"

namespace tessera::http {

// Of a connection with TLS, from its beginning.
gnutls_session_t tls_session_of(MHD_Connection* connection);

// What all connections of a server share.
struct ConnectionSettings {
  Handler& handler;
  Timers& timers;
  std::chrono::milliseconds receive_timeout{};
};

class Connection : public std::enable_shared_from_this<Connection> {
 public:
  // `identity`: null without TLS.
  Connection(MHD_Connection* connection, int socket, const ConnectionSettings& settings,
             std::shared_ptr<const TlsIdentity> identity)
      : connection_(connection), socket_(socket), settings_(settings), identity_(std::move(identity)) {}

  // ---- Called by MHD's thread ----
  // The time for the next request's header begins.
  void await_request();
  // The request line is received.
  void begin_request(const char* target);
  // The header is received, or a part of the body, or its end (with a size of 0).
  MHD_Result proceed(const char* method, const char* bytes, std::size_t size);
  // The response is sent.
  void end_request();
  // MHD closes the socket after this call.
  void close();

  // For the body that is sent. After begin_read(), suspend() does nothing if there was a wake since. Returns
  // whether the connection is suspended.
  void begin_read();
  bool suspend(std::chrono::milliseconds longest);

  // ---- Called by any thread ----
  void wake();
  // The response to the request of this number, if it still waits for one.
  void respond(std::uint64_t request_number, Response response);
  // Bodies that are produced over time end soon.
  void stop();
  // Whatever is under way.
  void disconnect();
  bool is_stopping() const;
  // Whether there is a request whose response will be sent soon: no body that is produced over time.
  bool is_answering() const;

 private:
  enum class Phase {
    kReceiving,  // a request, until the deadline
    kAnswering,
    kSuspended,  // until the deadline
    kClosed,
  };
  // The request, from its first line to its response.
  struct Exchange {
    std::string target;
    bool has_header = false;
    Request request{};
    std::uint64_t body_bytes = 0;  // as its header says
    std::unique_ptr<BodySink> sink{};
    core::Status sink_status{};
    // Once there is one, what else is received is dropped.
    std::optional<Response> response{};
    // Its response is made later.
    bool is_awaited = false;
  };

  MHD_Result receive_header(const char* method);
  // What is wrong with the request, before any handler sees it.
  std::optional<Response> read_header(const char* method);
  void consult_handler();
  void receive_body(std::string_view bytes);
  Response make_response();
  MHD_Result answer_when_ready();
  MHD_Result await(const std::function<void(Respond)>& later);
  void sleep_until_response();
  std::optional<Response> take_late_response();
  MHD_Result answer(Response response);
  void set_deadline(std::chrono::milliseconds delay);
  void expire();
  void resume();

  MHD_Connection* const connection_;
  const int socket_;
  const ConnectionSettings& settings_;
  const std::shared_ptr<const TlsIdentity> identity_;
  Exchange exchange_;  // of MHD's thread

  mutable std::mutex mutex_;
  // Guarded by mutex_:
  Phase phase_ = Phase::kReceiving;
  Timers::Clock::time_point deadline_{};
  bool has_woken_ = false;
  bool is_stopping_ = false;
  bool has_request_ = false;  // from its header to the end of its response
  bool is_streaming_ = false;
  std::uint64_t request_number_ = 0;
  std::optional<Response> late_response_;
};

}  // namespace tessera::http
