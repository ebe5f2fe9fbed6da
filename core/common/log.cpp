// SPDX-License-Identifier: Apache-2.0
#include "core/common/log.hpp"

#include <signal.h>
#include <spdlog/async.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/sink.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <list>
#include <memory>
#include <nlohmann/json.hpp>
#include <semaphore>
#include <string_view>
#include <utility>

#include "core/base/printable.hpp"
#include "core/common/journal.hpp"

namespace tessera::common {
namespace {

constexpr std::size_t kMaxWaitingLines = 8192;
constexpr auto kMaxFlush = std::chrono::seconds(1);

// Lines with fields come from a logger of this name. Their payload is the message and the fields, each as its
// key, kEquals and its value, with kSeparator between; none of them contains either, since they are
// printable.
constexpr std::string_view kWithFields = "with fields";
constexpr char kSeparator = '\x1e', kEquals = '\x1f';

std::string encode(std::string_view message, const LogFields& fields) {
  std::string payload = core::printable(message);
  const auto add = [&](std::string_view key, const std::string& value) {
    if (value.empty()) return;
    payload += kSeparator;
    payload += key;
    payload += kEquals;
    payload += core::printable(value);
  };
  add("job", fields.job);
  add("worker", fields.worker);
  add("principal", fields.principal);
  add("peer", fields.peer);
  return payload;
}

// The text up to the next separator, which is removed.
std::string_view take_part(std::string_view& payload) {
  const std::string_view part = payload.substr(0, payload.find(kSeparator));
  payload.remove_prefix(std::min(part.size() + 1, payload.size()));
  return part;
}

std::pair<std::string_view, std::string_view> key_and_value(std::string_view field) {
  const std::size_t end = field.find(kEquals);
  return {field.substr(0, end), field.substr(end + 1)};
}

std::string as_text(std::string_view payload) {
  const std::string_view message = take_part(payload);
  std::string text(message), more;
  while (!payload.empty()) {
    const auto [key, value] = key_and_value(take_part(payload));
    if (message.find(value) == std::string_view::npos)
      more += fmt::format("{}{} {}", more.empty() ? "" : ", ", key, value);
  }
  return more.empty() ? text : fmt::format("{} [{}]", text, more);
}

std::string as_json(std::string_view payload) {
  std::string members = nlohmann::json(take_part(payload)).dump();
  while (!payload.empty()) {
    const auto [key, value] = key_and_value(take_part(payload));
    members += fmt::format(",\"{}\":{}", key, nlohmann::json(value).dump());
  }
  return members;
}

// Replaces %v: the message in printable characters, with its fields; quoted for JSON if wanted.
class PrintableMessage final : public spdlog::custom_flag_formatter {
 public:
  explicit PrintableMessage(LogFormat format) : format_(format) {}
  void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& line) override {
    std::string payload(message.payload.data(), message.payload.size());
    if (std::string_view(message.logger_name.data(), message.logger_name.size()) != kWithFields)
      payload = core::printable(payload);
    const std::string shown = format_ == LogFormat::kJson ? as_json(payload) : as_text(payload);
    line.append(shown.data(), shown.data() + shown.size());
  }
  std::unique_ptr<spdlog::custom_flag_formatter> clone() const override {
    return std::make_unique<PrintableMessage>(format_);
  }

 private:
  const LogFormat format_;
};

// The journal has time, priority and program of a line itself.
std::string pattern_of(const std::string& program, LogFormat format, bool is_for_journal) {
  if (format == LogFormat::kJson)
    return R"({"time":"%Y-%m-%dT%H:%M:%S.%eZ","level":"%l","program":")" + program + R"(","message":%*})";
  return is_for_journal ? "%*" : "%Y-%m-%dT%H:%M:%S.%eZ %^%l%$ " + program + ": %*";
}

std::unique_ptr<spdlog::formatter> make_formatter(const std::string& program, LogFormat format,
                                                  bool is_for_journal) {
  auto formatter = std::make_unique<spdlog::pattern_formatter>(spdlog::pattern_time_type::utc);
  formatter->add_flag<PrintableMessage>('*', format).set_pattern(pattern_of(program, format, is_for_journal));
  return formatter;
}

constexpr std::string_view kPlain = "\033[0m";
std::string_view colour_of(spdlog::level::level_enum level) {
  return level >= spdlog::level::err    ? "\033[31m"
         : level == spdlog::level::warn ? "\033[33m"
         : level == spdlog::level::info ? "\033[32m"
                                        : "\033[36m";
}

// Whether an environment variable has a value.
bool is_set(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr && *value != '\0';
}

// Write errors are ignored, since there is nowhere to report them.
void write_all(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(STDERR_FILENO, bytes.data(), bytes.size());
    if (count < 0 && errno != EINTR) return;
    if (count > 0) bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

// Writes to the descriptor of stderr, without the stream, whose lock would keep the process from ending while
// a write blocks. Says how many lines were dropped, and when a flush is done. For the log's thread.
class Sink final : public spdlog::sinks::sink {
 public:
  explicit Sink(spdlog::details::thread_pool& queue) : queue_(queue) {}

  void log(const spdlog::details::log_msg& message) override {
    const std::size_t dropped = queue_.overrun_counter();
    if (dropped > dropped_) {
      const std::string line = fmt::format("{} lines of this log were dropped", dropped - dropped_);
      dropped_ = dropped;
      write({message.logger_name, spdlog::level::warn, line});
    }
    write(message);
  }
  void flush() override { flushed_.release(); }
  void set_pattern(const std::string&) override {}
  void set_formatter(std::unique_ptr<spdlog::formatter> formatter) override {
    formatter_ = std::move(formatter);
  }
  // Forgets flushes that nobody waited for to their end.
  void expect_flush() {
    while (flushed_.try_acquire()) {
    }
  }
  bool is_for_journal() const { return is_for_journal_; }
  void wait_for_flush() { static_cast<void>(flushed_.try_acquire_for(kMaxFlush)); }

 private:
  void write(const spdlog::details::log_msg& message) {
    spdlog::memory_buf_t buffer;
    formatter_->format(message, buffer);
    std::string line(buffer.data(), buffer.size());
    if (is_colored_ && message.color_range_end > message.color_range_start) {
      line.insert(message.color_range_end, kPlain);
      line.insert(message.color_range_start, colour_of(message.level));
    }
    if (is_for_journal_) line.insert(0, journal_prefix(message.level));
    write_all(line);
  }

  spdlog::details::thread_pool& queue_;
  const bool is_for_journal_ = stderr_is_journal();
  const bool is_colored_ = ::isatty(STDERR_FILENO) == 1 && !is_set("NO_COLOR");
  std::unique_ptr<spdlog::formatter> formatter_;
  std::size_t dropped_ = 0;
  std::counting_semaphore<> flushed_{0};
};

// Signals are for other threads.
std::shared_ptr<spdlog::details::thread_pool> start_thread() {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  auto queue = std::make_shared<spdlog::details::thread_pool>(kMaxWaitingLines, 1);
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return queue;
}

struct Log {
  std::shared_ptr<spdlog::details::thread_pool> queue = start_thread();
  std::shared_ptr<Sink> sink = std::make_shared<Sink>(*queue);
  std::shared_ptr<spdlog::async_logger> logger, with_fields;
};

// The last one is in use. Never destroyed: a thread may be blocked at stderr when the process ends.
std::list<Log>& logs() {
  static auto* const all = new std::list<Log>;
  return *all;
}

}  // namespace

void log_to_stderr(const std::string& program, const LogOptions& options) {
  const bool is_first = logs().empty();
  Log* const log = &logs().emplace_back();
  const auto make_logger = [&](const std::string& name) {
    auto logger = std::make_shared<spdlog::async_logger>(name, log->sink, log->queue,
                                                         spdlog::async_overflow_policy::overrun_oldest);
    logger->set_formatter(make_formatter(program, options.format, log->sink->is_for_journal()));
    logger->set_level(options.level);
    // By default, spdlog would report errors on stderr itself.
    logger->set_error_handler([](const std::string&) {});
    return logger;
  };
  log->logger = make_logger(program);
  log->with_fields = make_logger(std::string(kWithFields));
  if (is_first) std::atexit(flush_log);
  spdlog::set_default_logger(log->logger);
}

void log(spdlog::level::level_enum level, std::string_view message, const LogFields& fields) {
  if (logs().empty()) return spdlog::log(level, "{}", message);
  logs().back().with_fields->log(level, "{}", encode(message, fields));
}

void flush_log() {
  if (logs().empty()) return;
  const Log& log = logs().back();
  log.sink->expect_flush();
  log.logger->flush();
  log.sink->wait_for_flush();
}

void abort_with(const std::string& defect) {
  spdlog::critical("a defect, please report it with this line: {}", defect);
  flush_log();
  std::abort();
}

}  // namespace tessera::common
