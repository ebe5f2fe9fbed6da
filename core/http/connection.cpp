// SPDX-License-Identifier: Apache-2.0
#include "core/http/connection.hpp"

#include <netinet/in.h>
#include <sys/socket.h>

#include <charconv>
#include <cstring>
#include <exception>
#include <utility>

#include "core/http/request_target.hpp"
#include "core/http/streamed_body.hpp"

namespace tessera::http {
namespace {

// Clients that send more slowly are disconnected.
constexpr std::uint64_t kMinBytesPerMs = 16;
// How often a connection that waits for its response is looked at.
constexpr std::chrono::seconds kLookAgain{60};

Response plain(int status, std::string text) {
  return {
      .status = status, .headers = {{"Content-Type", "text/plain; charset=utf-8"}}, .body = std::move(text)};
}

MHD_Result add_header(void* request, MHD_ValueKind, const char* name, const char* value) {
  std::string lower(name);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  const auto [header, is_new] =
      static_cast<Request*>(request)->headers.emplace(lower, value == nullptr ? "" : value);
  if (!is_new) header->second.append(lower == "cookie" ? "; " : ", ").append(value == nullptr ? "" : value);
  return MHD_YES;
}

sockaddr_storage peer_of(MHD_Connection* connection) {
  sockaddr_storage peer{};
  const auto* const info = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CLIENT_ADDRESS);
  if (info == nullptr || info->client_addr == nullptr) return peer;
  const bool is_ipv6 = info->client_addr->sa_family == AF_INET6;
  std::memcpy(&peer, info->client_addr, is_ipv6 ? sizeof(sockaddr_in6) : sizeof(sockaddr_in));
  return peer;
}

std::optional<std::uint64_t> parse_length(const std::string& text) {
  std::uint64_t length = 0;
  const auto [end, wrong] = std::from_chars(text.data(), text.data() + text.size(), length);
  if (text.empty() || wrong != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return length;
}

// Calls the handler or what it has returned; exceptions become a response.
template <typename Call>
std::optional<Response> guarded(Call call) {
  try {
    call();
    return std::nullopt;
  } catch (const std::bad_alloc&) {
    return plain(503, "out of memory; try again later\n");
  } catch (const std::exception&) {
    return plain(500, "the request failed because of an error in the server\n");
  }
}

}  // namespace

gnutls_session_t tls_session_of(MHD_Connection* connection) {
  const auto* const info = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_GNUTLS_SESSION);
  return static_cast<gnutls_session_t>(info->tls_session);
}

void Connection::set_deadline(std::chrono::milliseconds delay) {
  deadline_ = Timers::Clock::now() + delay;
  settings_.timers.set(this, deadline_, [weak = weak_from_this()] {
    if (const auto connection = weak.lock()) connection->expire();
  });
}

void Connection::expire() {
  const std::lock_guard lock(mutex_);
  if (Timers::Clock::now() < deadline_) return;  // set again meanwhile
  if (phase_ == Phase::kReceiving) ::shutdown(socket_, SHUT_RDWR);
  if (phase_ == Phase::kSuspended) resume();
}

void Connection::resume() {
  phase_ = Phase::kAnswering;
  MHD_resume_connection(connection_);
}

void Connection::await_request() {
  const std::lock_guard lock(mutex_);
  phase_ = Phase::kReceiving;
  has_request_ = is_streaming_ = false;
  set_deadline(settings_.receive_timeout);
}

void Connection::begin_request(const char* target) {
  exchange_ = {.target = target};
  const std::lock_guard lock(mutex_);
  ++request_number_;
}

MHD_Result Connection::proceed(const char* method, const char* bytes, std::size_t size) {
  if (!exchange_.has_header) return receive_header(method);
  if (size == 0) return answer_when_ready();
  if (!exchange_.response) receive_body({bytes, size});
  return MHD_YES;
}

MHD_Result Connection::receive_header(const char* method) {
  exchange_.has_header = true;
  {
    const std::lock_guard lock(mutex_);
    has_request_ = true;
  }
  exchange_.response = read_header(method);
  if (!exchange_.response) consult_handler();
  if (exchange_.body_bytes == 0) return MHD_YES;  // the response follows at once, and the connection goes on
  if (exchange_.response && !exchange_.response->later) return answer(std::move(*exchange_.response));
  const std::lock_guard lock(mutex_);
  set_deadline(settings_.receive_timeout + std::chrono::milliseconds(exchange_.body_bytes / kMinBytesPerMs));
  return MHD_YES;
}

std::optional<Response> Connection::read_header(const char* method) {
  Request& request = exchange_.request;
  request.method = std::string_view(method) == "HEAD" ? "GET" : method;
  MHD_get_connection_values(connection_, MHD_HEADER_KIND, &add_header, &request);
  const std::string length = request.header("content-length");
  const bool has_encoding = request.headers.contains("transfer-encoding");
  // Anything but 0: what the body has is not to be taken for another request.
  exchange_.body_bytes = has_encoding ? 1 : 0;
  if (has_encoding) return plain(411, "a body needs the header Content-Length\n");
  if (request.headers.contains("content-length")) {
    const auto bytes = parse_length(length);
    exchange_.body_bytes = bytes.value_or(1);
    if (!bytes) return plain(400, "the header Content-Length must be one number\n");
  }
  auto target = parse_target(exchange_.target);
  if (!target) return plain(400, "the target of the request is malformed\n");
  request.path = std::move(target->path);
  request.query = std::move(target->query);
  request.peer = peer_of(connection_);
  request.is_secure = identity_ != nullptr;
  if (!identity_ || !identity_->needs_client_certificate()) return std::nullopt;
  auto name = identity_->verified_client_name(tls_session_of(connection_));
  if (!name) return plain(403, "a client certificate of a CA that the server trusts is needed\n");
  request.client_name = std::move(*name);
  return std::nullopt;
}

void Connection::consult_handler() {
  Reception reception;
  auto failure = guarded([&] { reception = settings_.handler.receive(exchange_.request); });
  if (failure) {
    exchange_.response = std::move(failure);
  } else if (reception.reject) {
    exchange_.response = std::move(reception.reject);
  } else if (reception.sink) {
    exchange_.sink = std::move(reception.sink);
  } else if (exchange_.body_bytes > reception.max_body_bytes) {
    exchange_.response = plain(413, "the body is too large\n");
  }
}

void Connection::receive_body(std::string_view bytes) {
  auto failure = guarded([&] {
    if (!exchange_.sink) {
      exchange_.request.body.append(bytes);
    } else if (exchange_.sink_status) {
      exchange_.sink_status = exchange_.sink->write(bytes);
    }
  });
  if (failure) exchange_.response = std::move(failure);
}

Response Connection::make_response() {
  if (exchange_.response) return std::move(*exchange_.response);
  Response response;
  auto failure = guarded([&] {
    response = exchange_.sink ? exchange_.sink->finish(exchange_.sink_status)
                              : settings_.handler.handle(exchange_.request);
  });
  return failure ? std::move(*failure) : std::move(response);
}

// MHD calls again without bytes when the connection is resumed, for whatever reason.
MHD_Result Connection::answer_when_ready() {
  std::optional<Response> response;
  if (exchange_.is_awaited) {
    response = take_late_response();
    if (!response && is_stopping()) response = plain(503, "the server is stopping\n");
  } else {
    response = make_response();
  }
  if (response && !response->later) return answer(std::move(*response));
  if (response) return await(response->later);
  sleep_until_response();
  return MHD_YES;
}

MHD_Result Connection::await(const std::function<void(Respond)>& later) {
  exchange_.is_awaited = true;
  sleep_until_response();
  std::uint64_t number = 0;
  {
    const std::lock_guard lock(mutex_);
    number = request_number_;
  }
  auto failure = guarded([&] {
    later([weak = weak_from_this(), number](Response response) {
      if (const auto waiting = weak.lock()) waiting->respond(number, std::move(response));
    });
  });
  if (failure) respond(number, std::move(*failure));
  return MHD_YES;
}

void Connection::sleep_until_response() {
  const std::lock_guard lock(mutex_);
  if (late_response_ || is_stopping_) return;  // MHD calls again
  phase_ = Phase::kSuspended;
  MHD_suspend_connection(connection_);
  set_deadline(kLookAgain);
}

void Connection::respond(std::uint64_t request_number, Response response) {
  const std::lock_guard lock(mutex_);
  if (request_number != request_number_ || phase_ == Phase::kClosed || late_response_) return;
  late_response_ = std::move(response);
  if (phase_ == Phase::kSuspended) resume();
}

std::optional<Response> Connection::take_late_response() {
  const std::lock_guard lock(mutex_);
  return std::exchange(late_response_, std::nullopt);
}

MHD_Result Connection::answer(Response response) {
  {
    const std::lock_guard lock(mutex_);
    phase_ = Phase::kAnswering;
    is_streaming_ = response.source != nullptr;
    settings_.timers.clear(this);
  }
  const int status = response.status;
  const auto headers = std::move(response.headers);
  MHD_Response* const made = make_mhd_response(std::move(response), shared_from_this());
  if (made == nullptr) return MHD_NO;
  for (const auto& [name, value] : headers) MHD_add_response_header(made, name.c_str(), value.c_str());
  const MHD_Result queued = MHD_queue_response(connection_, static_cast<unsigned>(status), made);
  MHD_destroy_response(made);
  return queued;
}

void Connection::end_request() {
  exchange_ = {};
  static_cast<void>(take_late_response());  // destroyed without the lock
  await_request();
}

void Connection::close() {
  static_cast<void>(take_late_response());
  const std::lock_guard lock(mutex_);
  phase_ = Phase::kClosed;
  has_request_ = false;
  settings_.timers.clear(this);
}

void Connection::begin_read() {
  const std::lock_guard lock(mutex_);
  has_woken_ = false;
}

bool Connection::suspend(std::chrono::milliseconds longest) {
  const std::lock_guard lock(mutex_);
  if (has_woken_ || is_stopping_) return false;
  phase_ = Phase::kSuspended;
  MHD_suspend_connection(connection_);
  set_deadline(longest);
  return true;
}

void Connection::wake() {
  const std::lock_guard lock(mutex_);
  has_woken_ = true;
  if (phase_ == Phase::kSuspended) resume();
}

void Connection::stop() {
  const std::lock_guard lock(mutex_);
  is_stopping_ = true;
  if (phase_ == Phase::kSuspended) resume();
}

void Connection::disconnect() {
  const std::lock_guard lock(mutex_);
  if (phase_ != Phase::kClosed) ::shutdown(socket_, SHUT_RDWR);
  if (phase_ == Phase::kSuspended) resume();
}

bool Connection::is_stopping() const {
  const std::lock_guard lock(mutex_);
  return is_stopping_;
}

bool Connection::is_answering() const {
  const std::lock_guard lock(mutex_);
  return has_request_ && !is_streaming_;
}

}  // namespace tessera::http
