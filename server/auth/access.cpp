// SPDX-License-Identifier: Apache-2.0
#include "server/auth/access.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <google/protobuf/timestamp.pb.h>
#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <string>
#include <utility>

#include "core/base/printable.hpp"
#include "core/image/file_io.hpp"
#include "proto/security.hpp"

namespace tessera::auth {
namespace {

using core::ErrorCode;
using google::protobuf::util::TimeUtil;
using grpc::StatusCode;

// Shorter tokens could be guessed. Names are public: with this limit, a token as the documentation makes them
// is never accepted as a name, and no token is taken for kCertificateWord.
constexpr std::size_t kMinTokenLength = 16, kMaxNameLength = 32;
constexpr std::string_view kCertificateWord = "certificate", kSharedWord = "shared",
                           kExpiresWord = "expires=";
constexpr std::size_t kDateLength = 10;  // of YYYY-MM-DD

constexpr std::array kRoles{Role::kWatch, Role::kSubmit, Role::kWork, Role::kAdmin};

core::Status refuse(std::string what) {
  return core::fail(ErrorCode::kInvalidArgument, std::move(what));
}

// The moment from which on credentials with this expiry are refused. Empty if the text is no time.
std::optional<Access::Time> parse_expiry(const std::string& text) {
  const bool is_date = text.size() == kDateLength;
  google::protobuf::Timestamp time;
  if (!TimeUtil::FromString(is_date ? text + "T00:00:00Z" : text, &time)) return std::nullopt;
  const Access::Time moment{std::chrono::seconds(TimeUtil::TimestampToSeconds(time))};
  return is_date ? moment + std::chrono::hours(24) : moment;
}

std::string text_of(Access::Time time) {
  return fmt::format("{:%FT%TZ}", fmt::gmtime(std::chrono::system_clock::to_time_t(time)));
}

}  // namespace

core::Result<Access> Access::read(const std::string& path) {
  const auto text = core::read_file(path);
  if (!text) return core::fail(text.error());
  Access access;
  access.open_ = false;
  std::istringstream lines(*text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (const core::Status added = access.add_line(line); !added)
      return core::fail(added.error().within(fmt::format("{}:{}", path, number)));
  }
  if (access.tokens_.empty() && access.certificates_.empty())
    return core::fail(ErrorCode::kInvalidArgument, fmt::format("{}: there is no token in it", path));
  return access;
}

// Errors do not quote the line, since any word of it may be a secret.
core::Status Access::add_line(std::string_view line) {
  std::istringstream words{std::string(line)};
  std::string role_text, token, more;
  Grant grant{.principal = {.individual = true}};
  std::string& name = grant.principal.name;
  if (!(words >> role_text) || role_text.front() == '#') return {};
  if (!(words >> name >> token)) return refuse("a line has three words: ROLE NAME TOKEN");
  const auto role =
      std::find_if(kRoles.begin(), kRoles.end(), [&](Role each) { return role_name(each) == role_text; });
  if (role == kRoles.end()) return refuse("the first word must be a role: watch, submit, work or admin");
  grant.principal.role = *role;
  if (name.size() > kMaxNameLength || !core::is_printable(name))
    return refuse(fmt::format("the second word is a name of at most {} printable characters, in UTF-8",
                              kMaxNameLength));
  while (words >> more) {
    if (more == kSharedWord) {
      grant.principal.individual = false;
    } else if (!more.starts_with(kExpiresWord)) {
      return refuse("a line has three words: ROLE NAME TOKEN; only shared and expires=TIME may follow");
    } else if (grant.expires = parse_expiry(more.substr(kExpiresWord.size())); !grant.expires) {
      return refuse("expires= needs a date such as 2027-01-31, or a time such as 2027-01-31T12:00:00Z");
    }
  }
  if (token != kCertificateWord) return add_token(token, std::move(grant));
  const std::string common_name = name;
  if (!certificates_.emplace(common_name, std::move(grant)).second)
    return refuse("this certificate has a line already");
  return {};
}

core::Status Access::add_token(const std::string& token, Grant grant) {
  if (token.size() < kMinTokenLength || !proto::is_token(token)) {
    return refuse(
        fmt::format("the third word is a token of at least {} letters, digits and -._~+/=, or the word {}",
                    kMinTokenLength, kCertificateWord));
  }
  if (!tokens_.emplace(digest_of_token(token), std::move(grant)).second)
    return refuse("this token was given to somebody already");
  return {};
}

const Access::Grant* Access::find(const Credentials& shown) const {
  const std::string digest = shown.token.empty() ? shown.token_digest : digest_of_token(shown.token);
  const auto& grants = digest.empty() ? certificates_ : tokens_;
  const auto found = grants.find(digest.empty() ? shown.certificate : digest);
  return found == grants.end() ? nullptr : &found->second;
}

grpc::Status Access::admit(const Credentials& shown, Role role, Time now, Principal& principal) const {
  principal = {};
  if (open_) {
    principal.name = shown.certificate;
    return grpc::Status::OK;
  }
  const Grant* const grant = find(shown);
  if (grant == nullptr && shown.token.empty())
    return {StatusCode::UNAUTHENTICATED,
            "this farm asks for a token: give --token-file, or name the file in TESSERA_TOKEN_FILE"};
  if (grant == nullptr)
    return {StatusCode::UNAUTHENTICATED,
            "this farm does not know the token that was shown: ask its administrator"};
  principal = grant->principal;
  if (grant->expires && *grant->expires <= now)
    return {StatusCode::UNAUTHENTICATED,
            fmt::format("the {} of {} has expired at {}: ask the farm's administrator for a new one",
                        shown.token.empty() ? "entry" : "token", principal.name, text_of(*grant->expires))};
  if (includes(principal.role, role)) return grpc::Status::OK;
  return {StatusCode::PERMISSION_DENIED,
          fmt::format("the token of {} is for '{}', and this needs one for '{}'", principal.name,
                      role_name(principal.role), role_name(role))};
}

}  // namespace tessera::auth
