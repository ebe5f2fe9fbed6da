// The layout is that of SQLite Consortium 2022, section 4.
#include "server/store/log_damage.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <fstream>
#include <string_view>
#include <system_error>

#include "server/store/file.hpp"

namespace tessera::store {

namespace {

constexpr std::size_t kHeaderBytes = 32, kFrameHeaderBytes = 24;
// Of the header and of a frame's, what the sums stand behind.
constexpr std::size_t kSummedOfHeader = 24, kSummedOfFrame = 8;
constexpr std::uint32_t kMagic = 0x377f0682;  // its last bit: sums are over big-endian words
constexpr std::uint32_t kLeastPage = 512, kMostPage = 65536;

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

// Two 32-bit sums, each fed by the other.
struct Sums {
  std::uint32_t first = 0, second = 0;

  void add(std::string_view bytes, bool words_are_big_endian) {
    const auto word = words_are_big_endian ? big_endian : little_endian;
    for (std::size_t at = 0; at + 8 <= bytes.size(); at += 8) {
      first += word(bytes, at) + second;
      second += word(bytes, at + 4) + first;
    }
  }
  bool stand_in(std::string_view bytes, std::size_t at) const {
    return big_endian(bytes, at) == first && big_endian(bytes, at + 4) == second;
  }
};

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
  header.whole = (magic & ~1u) == kMagic && header.sums.stand_in(bytes, kSummedOfHeader) &&
                 header.page_bytes >= kLeastPage && header.page_bytes <= kMostPage;
  return header;
}

// Finds the first frame that does not check, and counts the transactions that were committed behind it.
class Walk {
 public:
  explicit Walk(const Header& header) : header_(header), sums_(header.sums) {}

  void take(std::string_view frame) {
    const bool of_this_log = frame.substr(8, 8) == header_.salts;  // or left from before it was begun anew
    const bool commits = big_endian(frame, 4) != 0;
    if (!broken_ && of_this_log && continues(frame)) {
      ++whole_frames_;
      within_transaction_ = !commits;
      return;
    }
    broken_ = true;
    if (!of_this_log) return;
    within_transaction_ = true;
    if (commits) ++unreadable_commits_;
  }
  // What is left behind the last frame.
  void end(std::streamsize bytes) { within_transaction_ |= !broken_ && bytes > 0; }

  std::uint64_t whole_frames() const { return whole_frames_; }
  // Each was written only when the one before was safe on disk: a crash tears one at most.
  bool damaged() const { return unreadable_commits_ > 1; }
  bool torn() const { return within_transaction_; }

 private:
  bool continues(std::string_view frame) {
    sums_.add(frame.substr(0, kSummedOfFrame), header_.words_are_big_endian);
    sums_.add(frame.substr(kFrameHeaderBytes), header_.words_are_big_endian);
    return sums_.stand_in(frame, 16);
  }

  const Header& header_;
  Sums sums_;
  bool broken_ = false, within_transaction_ = false;
  std::uint64_t whole_frames_ = 0, unreadable_commits_ = 0;
};

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
  if (!file.read(bytes.data(), kHeaderBytes)) return core::fail(errno_error("reading", log));
  const Header header = read_header(bytes);
  if (!header.whole)
    return LogFindings{.damage = fmt::format("{} is damaged at its beginning", log.string())};
  Walk walk(header);
  const std::size_t frame_bytes = kFrameHeaderBytes + header.page_bytes;
  bytes.resize(frame_bytes);
  while (file.read(bytes.data(), static_cast<std::streamsize>(frame_bytes))) walk.take(bytes);
  walk.end(file.gcount());
  if (!walk.damaged()) return LogFindings{.damage = std::nullopt, .torn_end = walk.torn()};
  return LogFindings{.damage = fmt::format("{} is damaged at byte {}", log.string(),
                                           kHeaderBytes + walk.whole_frames() * frame_bytes)};
}

}  // namespace tessera::store
