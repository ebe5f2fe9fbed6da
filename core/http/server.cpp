// SPDX-License-Identifier: Apache-2.0
#include "core/http/server.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <microhttpd.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdarg>
#include <cstdio>
#include <system_error>
#include <utility>

#include "core/base/mutex.hpp"
#include "core/http/connection.hpp"
#include "core/http/connections.hpp"
#include "core/http/listener.hpp"
#include "core/http/timers.hpp"
#include "core/http/tls_identity.hpp"

namespace tessera::http {
namespace {

// For a request's header, and for what is sent next.
constexpr std::size_t kConnectionBytes = 64 << 10;
// A peer that acknowledges nothing for so long is gone.
constexpr unsigned kPeerTimeoutMs = 60'000;
// For responses that are under way at the end.
constexpr std::chrono::seconds kEndSeconds{2};
constexpr const char* kTlsPriorities = "NORMAL:-VERS-ALL:+VERS-TLS1.3:+VERS-TLS1.2";

}  // namespace

struct Server::Daemon {
  Daemon(const ServerOptions& options, Handler& handler)
      : settings{handler, timers, options.receive_timeout},
        client_ca_pem(options.tls.client_ca_pem),
        max_connections(static_cast<std::size_t>(options.max_connections)) {}
  ~Daemon();

  core::Status start(const ServerOptions& options, const Listener& listener);
  // Sets `mhd`, or start_failure.
  void start_mhd(const ServerOptions& options, int socket, bool with_tls);
  core::Status replace_identity(const TlsOptions& tls);
  // Null without TLS.
  std::shared_ptr<const TlsIdentity> current_identity();
  // A connection that begins shows the current certificate. Returns its identity.
  std::shared_ptr<const TlsIdentity> identify(MHD_Connection* connection);

  // MHD's callbacks, whose first argument is the daemon:
  static MHD_Result accept(void* daemon, const sockaddr* address, socklen_t size);
  static void notify(void* daemon, MHD_Connection* connection, void** slot, MHD_ConnectionNotificationCode);
  static void* begin_request(void* daemon, const char* target, MHD_Connection* connection);
  static MHD_Result proceed(void* daemon, MHD_Connection* connection, const char* target, const char* method,
                            const char* version, const char* bytes, std::size_t* size, void** slot);
  static void complete(void* daemon, MHD_Connection* connection, void** slot, MHD_RequestTerminationCode);
  static void log(void* daemon, const char* format, va_list arguments);

  Timers timers;
  const ConnectionSettings settings;
  const std::string client_ca_pem;  // of the start: GnuTLS names these CAs to clients
  const std::size_t max_connections;
  Connections connections;
  MHD_Daemon* mhd = nullptr;
  int passed_socket = -1;  // a copy of ServerOptions::socket
  std::atomic<bool> is_started{false};
  std::string start_failure;  // as MHD says it
  core::Mutex identity_mutex;
  std::shared_ptr<const TlsIdentity> identity TESSERA_GUARDED_BY(identity_mutex);
};

namespace {

Connection& connection_of(MHD_Connection* connection) {
  const auto* const info = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_SOCKET_CONTEXT);
  return *static_cast<Connection*>(info->socket_context);
}

void end_with_peer(int socket) {
  const int on = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
  ::setsockopt(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, &kPeerTimeoutMs, sizeof kPeerTimeoutMs);
}

// A pointer in the form of MHD's lists of options.
MHD_OptionItem pointer_option(MHD_OPTION option, const std::string& text) {
  return {option, 0, const_cast<char*>(text.c_str())};
}

std::vector<MHD_OptionItem> tls_options(const ServerOptions& options) {
  std::vector<MHD_OptionItem> items;
  if (!options.tls.certificate_pem.empty()) {
    static const std::string priorities = kTlsPriorities;
    items.push_back({MHD_OPTION_HTTPS_CERT_CALLBACK, 0, reinterpret_cast<void*>(&TlsIdentity::retrieve)});
    items.push_back(pointer_option(MHD_OPTION_HTTPS_PRIORITIES, priorities));
    if (!options.tls.client_ca_pem.empty())
      items.push_back(pointer_option(MHD_OPTION_HTTPS_MEM_TRUST, options.tls.client_ca_pem));
  }
  items.push_back({MHD_OPTION_END, 0, nullptr});
  return items;
}

}  // namespace

core::Status Server::Daemon::replace_identity(const TlsOptions& tls) {
  auto made = TlsIdentity::make(tls);
  if (!made) return core::fail(made.error());
  const core::MutexLock lock(identity_mutex);
  identity = *std::move(made);
  return {};
}

std::shared_ptr<const TlsIdentity> Server::Daemon::current_identity() {
  const core::MutexLock lock(identity_mutex);
  return identity;
}

std::shared_ptr<const TlsIdentity> Server::Daemon::identify(MHD_Connection* connection) {
  auto current = current_identity();
  if (!current) return nullptr;
  const gnutls_session_t session = tls_session_of(connection);
  current->use(session);
  // A client that was told the names of other CAs would not offer its certificate.
  if (current->client_ca_pem() != client_ca_pem) gnutls_certificate_send_x509_rdn_sequence(session, 1);
  return current;
}

MHD_Result Server::Daemon::accept(void* daemon, const sockaddr*, socklen_t) {
  const auto& self = *static_cast<Daemon*>(daemon);
  return self.connections.accepts(self.max_connections) ? MHD_YES : MHD_NO;
}

void Server::Daemon::notify(void* daemon, MHD_Connection* connection, void** slot,
                            MHD_ConnectionNotificationCode code) {
  auto& self = *static_cast<Daemon*>(daemon);
  if (code == MHD_CONNECTION_NOTIFY_STARTED) {
    const int socket = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd;
    end_with_peer(socket);
    const auto added =
        std::make_shared<Connection>(connection, socket, self.settings, self.identify(connection));
    self.connections.add(added);
    added->await_request();
    *slot = added.get();
  } else if (*slot != nullptr) {
    const auto closed = static_cast<Connection*>(*slot)->shared_from_this();
    closed->close();
    self.connections.remove(closed);
    self.connections.note_change();
    *slot = nullptr;
  }
}

void* Server::Daemon::begin_request(void*, const char* target, MHD_Connection* connection) {
  connection_of(connection).begin_request(target);
  return nullptr;
}

MHD_Result Server::Daemon::proceed(void*, MHD_Connection* connection, const char*, const char* method,
                                   const char*, const char* bytes, std::size_t* size, void**) {
  const std::size_t received = std::exchange(*size, 0);
  return connection_of(connection).proceed(method, bytes, received);
}

void Server::Daemon::complete(void* daemon, MHD_Connection* connection, void**, MHD_RequestTerminationCode) {
  connection_of(connection).end_request();
  static_cast<Daemon*>(daemon)->connections.note_change();
}

void Server::Daemon::log(void* daemon, const char* format, va_list arguments) {
  auto& self = *static_cast<Daemon*>(daemon);
  if (self.is_started) return;  // about clients: nothing to mend here
  std::array<char, 512> text{};
  std::vsnprintf(text.data(), text.size(), format, arguments);
  self.start_failure += text.data();
}

core::Status Server::Daemon::start(const ServerOptions& options, const Listener& listener) {
  const bool with_tls = !options.tls.certificate_pem.empty();
  if (with_tls)
    if (const auto usable = replace_identity(options.tls); !usable) start_failure = usable.error().message;
  if (start_failure.empty()) start_mhd(options, listener.socket, with_tls);
  is_started = true;
  if (mhd != nullptr) return {};
  ::close(listener.socket);
  return core::fail(
      core::ErrorCode::kUnavailable,
      fmt::format("cannot serve HTTP{} on {}: {}", with_tls ? "S" : "", listener.address, start_failure));
}

void Server::Daemon::start_mhd(const ServerOptions& options, int socket, bool with_tls) {
  const unsigned flags = MHD_USE_EPOLL_INTERNAL_THREAD | MHD_USE_SUSPEND_RESUME | MHD_USE_ERROR_LOG |
                         (with_tls ? static_cast<unsigned>(MHD_USE_TLS) : 0U);
  const auto seconds = std::chrono::ceil<std::chrono::seconds>(options.receive_timeout).count();
  const auto threads = static_cast<unsigned>(std::max(options.threads, 2));
  // MHD divides its limit among the threads, of which one may get all connections; accept() has ours.
  const auto mhd_limit = threads * (static_cast<unsigned>(options.max_connections) + 1);
  std::vector<MHD_OptionItem> tls = tls_options(options);
  mhd = MHD_start_daemon(flags, 0, &accept, this, &proceed, this,  //
                         MHD_OPTION_EXTERNAL_LOGGER, &log, this,   // first
                         MHD_OPTION_LISTEN_SOCKET, socket,         //
                         MHD_OPTION_THREAD_POOL_SIZE, threads,     //
                         MHD_OPTION_CONNECTION_LIMIT, mhd_limit,   //
                         MHD_OPTION_PER_IP_CONNECTION_LIMIT,
                         static_cast<unsigned>(options.max_connections_per_machine),     //
                         MHD_OPTION_CONNECTION_MEMORY_LIMIT, kConnectionBytes,           //
                         MHD_OPTION_CONNECTION_TIMEOUT, static_cast<unsigned>(seconds),  //
                         MHD_OPTION_STRICT_FOR_CLIENT, 1,                                //
                         MHD_OPTION_NOTIFY_CONNECTION, &notify, this,                    //
                         MHD_OPTION_NOTIFY_COMPLETED, &complete, this,                   //
                         MHD_OPTION_URI_LOG_CALLBACK, &begin_request, this,              //
                         MHD_OPTION_ARRAY, tls.data(),                                   //
                         MHD_OPTION_END);
}

Server::Daemon::~Daemon() {
  if (mhd != nullptr) {
    // MHD_quiesce_daemon() races with MHD's threads that use epoll; accept() rejects new connections instead.
    connections.stop();
    connections.await_answers(kEndSeconds);
    // MHD 0.9.75 reads through a null pointer when it rejects a malformed request while it is being stopped.
    connections.disconnect(kEndSeconds);
    MHD_stop_daemon(mhd);
  }
  if (passed_socket < 0) return;
  // MHD shuts the socket down, also for the process that passed it on and keeps it for the next start.
  ::listen(passed_socket, SOMAXCONN);
  ::close(passed_socket);
}

core::Result<std::unique_ptr<Server>> Server::start(const ServerOptions& options, Handler& handler) {
  auto listener = options.socket < 0 ? listen_on(options.address)
                                     : core::Result<Listener>(Listener{options.socket, options.address});
  if (!listener) return core::fail(listener.error());
  std::unique_ptr<Daemon> daemon;
  try {
    daemon = std::make_unique<Daemon>(options, handler);
  } catch (const std::system_error& error) {
    ::close(listener->socket);
    return core::fail(core::ErrorCode::kResourceExhausted,
                      fmt::format("cannot start a thread for {}: {}", listener->address, error.what()));
  }
  if (options.socket >= 0) daemon->passed_socket = ::fcntl(options.socket, F_DUPFD_CLOEXEC, 0);
  if (auto started = daemon->start(options, *listener); !started) return core::fail(started.error());
  return std::unique_ptr<Server>(new Server(std::move(daemon), listener->address));
}

Server::Server(std::unique_ptr<Daemon> daemon, std::string address)
    : daemon_(std::move(daemon)), address_(std::move(address)) {}

Server::~Server() = default;

core::Status Server::replace_certificates(const TlsOptions& tls) {
  const auto replaced = daemon_->replace_identity(tls);
  return replaced ? replaced : core::fail(replaced.error().within("HTTPS on " + address_));
}

}  // namespace tessera::http
