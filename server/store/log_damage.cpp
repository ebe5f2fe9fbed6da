// SPDX-License-Identifier: Apache-2.0
// The layout is that of SQLite Consortium 2022, section 4.
#include "server/store/log_damage.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "server/base/file.hpp"

namespace tessera::store {

namespace {

constexpr std::size_t kHeaderBytes = 32, kFrameHeaderBytes = 24;
// The bytes of the header and of a frame's header that the checksums cover.
constexpr std::size_t kSummedOfHeader = 24, kSummedOfFrame = 8, kSumsOfFrame = 16;
constexpr std::uint32_t kMagic = 0x377f0682;  // its last bit selects checksums of big-endian words
constexpr std::uint32_t kMinPage = 512, kMaxPage = 65536;

std::uint32_t big_endian(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

std::uint32_t little_endian(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i > 0; --i) value = value << 8 | static_cast<unsigned char>(bytes[at + i - 1]);
  return value;
}

// Two 32-bit sums, each updated with the other.
struct Sums {
  std::uint32_t first = 0, second = 0;

  void add(std::string_view bytes, bool words_are_big_endian) {
    const auto word = words_are_big_endian ? big_endian : little_endian;
    for (std::size_t at = 0; at + 8 <= bytes.size(); at += 8) {
      first += word(bytes, at) + second;
      second += word(bytes, at + 4) + first;
    }
  }
  bool operator==(const Sums&) const = default;
};

Sums stored_sums(std::string_view bytes, std::size_t at) {
  return {big_endian(bytes, at), big_endian(bytes, at + 4)};
}

struct Header {
  bool whole = false, words_are_big_endian = false;
  std::uint32_t page_bytes = 0;
  std::string salts;
  Sums sums;
};

Header read_header(std::string_view bytes) {
  Header header;
  const std::uint32_t magic = big_endian(bytes, 0);
  header.words_are_big_endian = (magic & 1) != 0;
  header.page_bytes = big_endian(bytes, 8);
  header.salts = bytes.substr(16, 8);
  header.sums.add(bytes.substr(0, kSummedOfHeader), header.words_are_big_endian);
  header.whole = (magic & ~1u) == kMagic && header.sums == stored_sums(bytes, kSummedOfHeader) &&
                 header.page_bytes >= kMinPage && header.page_bytes <= kMaxPage;
  return header;
}

// Finds the first frame with a wrong checksum, and counts the committed transactions after it.
class Walk {
 public:
  explicit Walk(const Header& header) : header_(header), last_sums_(header.sums) {}

  void take(std::string_view frame) {
    const bool has_salts = frame.substr(8, 8) == header_.salts;
    const bool follows = follows_the_last(frame);
    const bool commits = big_endian(frame, 4) != 0;
    broken_ |= !has_salts || !follows;
    if (broken_) return take_behind_the_break(has_salts, follows, commits);
    ++whole_frames_;
    within_transaction_ = !commits;
  }
  // Takes the number of bytes after the last whole frame.
  void end(std::streamsize bytes) { within_transaction_ |= !broken_ && bytes > 0; }

  std::uint64_t whole_frames() const { return whole_frames_; }
  // Each transaction is written after the one before was synced, so a crash damages at most one.
  bool damaged() const { return unreadable_commits_ > 1; }
  bool torn() const { return within_transaction_; }
  // The frame that ends the transaction is present. An interrupted write lacks it, unless the whole machine
  // crashed.
  bool torn_before_its_end() const { return unreadable_commits_ > 0; }

 private:
  // Compares checksums, which do not cover the salts.
  bool follows_the_last(std::string_view frame) {
    Sums sums = std::exchange(last_sums_, stored_sums(frame, kSumsOfFrame));
    sums.add(frame.substr(0, kSummedOfFrame), header_.words_are_big_endian);
    sums.add(frame.substr(kFrameHeaderBytes), header_.words_are_big_endian);
    return sums == last_sums_;
  }
  // A frame with other salts is from before the log was restarted, unless it follows a frame of this log, or
  // a frame of this log follows it.
  void take_behind_the_break(bool has_salts, bool follows, bool commits) {
    if (!follows) doubtful_commits_ = 0;
    doubtful_commits_ += commits ? 1 : 0;
    last_is_of_this_log_ = has_salts || (follows && last_is_of_this_log_);
    if (!last_is_of_this_log_) return;
    within_transaction_ = true;
    unreadable_commits_ += std::exchange(doubtful_commits_, 0);
  }

  const Header& header_;
  Sums last_sums_;  // those stored in the last frame
  bool broken_ = false, within_transaction_ = false, last_is_of_this_log_ = true;
  std::uint64_t whole_frames_ = 0, unreadable_commits_ = 0;
  std::uint64_t doubtful_commits_ = 0;  // in consecutive frames that may belong to this log
};

std::string torn_end(const std::filesystem::path& log, const Walk& walk, std::uint64_t end) {
  const std::string text = fmt::format(
      "what was last written to {} is not all there, as a crash may leave it", log.filename().string());
  if (!walk.torn_before_its_end()) return text;
  return text + fmt::format(
                    ", or a damaged disk: it does not check from byte {} on, though its end is there. Unless "
                    "the whole "
                    "machine crashed, what was accepted last is lost: samples are rendered again, but a job "
                    "that was "
                    "submitted, changed or deleted then is as it was before",
                    end);
}

}  // namespace

std::filesystem::path log_of(const std::filesystem::path& database) {
  return database.string() + "-wal";
}

core::Result<LogFindings> look_at_log(const std::filesystem::path& log) {
  std::error_code missing;
  const auto size = std::filesystem::file_size(log, missing);
  if (missing || size <= kHeaderBytes) return LogFindings{};
  std::ifstream file(log, std::ios::binary);
  std::string bytes(kHeaderBytes, '\0');
  if (!file.read(bytes.data(), kHeaderBytes)) return core::fail(base::errno_error("reading", log));
  const Header header = read_header(bytes);
  if (!header.whole)
    return LogFindings{.damage = fmt::format("{} is damaged at its beginning", log.string()),
                       .torn_end = std::nullopt};
  Walk walk(header);
  const std::size_t frame_bytes = kFrameHeaderBytes + header.page_bytes;
  bytes.resize(frame_bytes);
  while (file.read(bytes.data(), static_cast<std::streamsize>(frame_bytes))) walk.take(bytes);
  walk.end(file.gcount());
  const std::uint64_t end = kHeaderBytes + walk.whole_frames() * frame_bytes;
  if (walk.damaged())
    return LogFindings{.damage = fmt::format("{} is damaged at byte {}", log.string(), end),
                       .torn_end = std::nullopt};
  return walk.torn() ? LogFindings{.damage = std::nullopt, .torn_end = torn_end(log, walk, end)}
                     : LogFindings{};
}

}  // namespace tessera::store
