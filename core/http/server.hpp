// SPDX-License-Identifier: Apache-2.0
// A small HTTP server on libmicrohttpd. Handlers run on the server's threads; bodies that are produced over
// time sleep without a thread. Knows nothing of scenes and of RPC. Thread-safe.
#pragma once

#include <sys/socket.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::http {

struct Request {
  std::string method;                          // "GET", also for HEAD, whose response is sent without body
  std::string path;                            // decoded, without the query
  std::map<std::string, std::string> query;    // decoded
  std::map<std::string, std::string> headers;  // names in lower case
  std::string body;                            // of a request without sink
  sockaddr_storage peer{};
  bool is_secure = false;  // over TLS
  // The common name of the verified client certificate; empty without one.
  std::string client_name;

  // Empty if there is none.
  std::string header(std::string_view name) const;
  std::string cookie(std::string_view name) const;
  std::optional<std::string> parameter(std::string_view name) const;
};

// Resumes a body that waits. Can be called at any time, also after the end of the body.
using Wake = std::function<void()>;

// A body that is produced while it is sent. The server calls read() on one thread at a time, whenever the
// client has taken what was sent before, so a slow client is asked less often.
class BodySource {
 public:
  virtual ~BodySource() = default;
  enum class State {
    kMore,    // there is more, or something was appended
    kWait,    // nothing now: call again after wake(), or after longest_wait()
    kEnd,     // what was appended is the last
    kFailed,  // the rest cannot be produced: the connection ends, so that the client notices
  };
  // Called once, before the first read().
  virtual void start(Wake wake) { (void)wake; }
  // Appends at most about `max_bytes` to `out`.
  virtual State read(std::string& out, std::size_t max_bytes) = 0;
  // Asked after kWait. Sources that write keep-alives leave it at 15 seconds or less.
  virtual std::chrono::milliseconds longest_wait() const { return std::chrono::seconds(15); }
};

struct Response;
// Takes a response, once, on any thread. The connection may have ended by then.
using Respond = std::function<void(Response)>;

struct Response {
  int status = 200;
  std::vector<std::pair<std::string, std::string>> headers{};
  std::string body{};
  std::unique_ptr<BodySource> source{};       // instead of body
  std::optional<std::uint64_t> size_bytes{};  // of the source, if it is known
  // Instead of all others: the response is made later. Called once, and must return soon. The connection
  // sleeps without a thread until there is a response, which may be another one of this kind.
  std::function<void(Respond)> later{};
};

// Takes a body piece by piece instead of Request::body, for large uploads.
class BodySink {
 public:
  virtual ~BodySink() = default;
  // After an error, the rest of the body is read and dropped.
  virtual core::Status write(std::string_view bytes) = 0;
  // Called at the end of the body, with the first error. Not called if the client disconnects before.
  virtual Response finish(const core::Status& status) = 0;
};

// What to do with a request once its header is received.
struct Reception {
  // Present: answer at once, and ignore the body.
  std::optional<Response> reject{};
  // Present: takes the body.
  std::unique_ptr<BodySink> sink{};
  // Of the body without sink. A longer one gets 413, and one without Content-Length 411.
  std::size_t max_body_bytes = 1 << 20;
};

// Called by several threads at once. What these functions take, other connections of the same thread wait.
class Handler {
 public:
  virtual ~Handler() = default;
  // The header is received.
  virtual Reception receive(const Request& request) = 0;
  // The body is received (not called after a rejection or with a sink).
  virtual Response handle(const Request& request) = 0;
};

struct TlsOptions {
  std::string certificate_pem{}, key_pem{};  // both empty: without TLS
  std::string client_ca_pem{};               // empty: clients need no certificate; else 403 without one
};

struct ServerOptions {
  std::string address;  // HOST:PORT; port 0 picks a free one
  // One that listens at the address; taken over. Copies of it listen on when the server ends. -1: a new one.
  int socket = -1;
  TlsOptions tls{};
  int threads = 2;
  int max_connections = 1024;
  int max_connections_per_machine = 512;
  // The time for a request's header, and for its body besides what it takes at 16 KiB/s. A connection without
  // any traffic, except for a body that waits, ends after this time, too.
  std::chrono::milliseconds receive_timeout = std::chrono::seconds(30);
};

class Server {
 public:
  // The handler must outlive the server. Errors name the address.
  static core::Result<std::unique_ptr<Server>> start(const ServerOptions& options, Handler& handler);
  // Ends all connections.
  ~Server();

  // HOST:PORT with the actual port.
  const std::string& address() const { return address_; }

  // Connections that begin later use other certificates; others go on. Of a server that was started with TLS,
  // and with client CAs if these have some. After an error, nothing has changed.
  core::Status replace_certificates(const TlsOptions& tls);

 private:
  struct Daemon;
  Server(std::unique_ptr<Daemon> daemon, std::string address);

  std::unique_ptr<Daemon> daemon_;
  const std::string address_;
};

}  // namespace tessera::http
