// SPDX-License-Identifier: Apache-2.0
#include "server/auth/access.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <sstream>
#include <string>
#include <utility>

#include "core/base/printable.hpp"
#include "core/image/file_io.hpp"
#include "proto/blob.hpp"
#include "proto/security.hpp"

namespace tessera::auth {
namespace {

using core::ErrorCode;
using grpc::StatusCode;

// Shorter tokens could be guessed. Names are public: with this limit, a token as the documentation makes them
// is never accepted as a name.
constexpr std::size_t kMinTokenLength = 16, kMaxNameLength = 32;

constexpr std::array<std::pair<std::string_view, Role>, 3> kRoles{
    {{"submit", Role::kSubmit}, {"work", Role::kWork}, {"admin", Role::kAdmin}}};

std::string_view role_name(Role role) {
  for (const auto& [name, known] : kRoles)
    if (known == role) return name;
  return "";
}

std::string digest_of_token(std::string_view token) {
  return proto::digest_of(std::string(token)).hex();
}

// The token in a call's metadata; empty if there is none. The scheme is case-insensitive (RFC 7235, 2.1).
std::string_view shown_token(const grpc::CallbackServerContext& context) {
  const auto found = context.client_metadata().find(proto::kTokenKey);
  if (found == context.client_metadata().end()) return {};
  const std::string_view value(found->second.data(), found->second.size());
  const std::string_view prefix = proto::kTokenPrefix;
  const bool is_bearer = std::equal(
      prefix.begin(), prefix.end(), value.begin(), value.begin() + std::min(prefix.size(), value.size()),
      [](char a, char b) {
        return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
      });
  return is_bearer ? value.substr(prefix.size()) : std::string_view();
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
  if (access.callers_.empty())
    return core::fail(ErrorCode::kInvalidArgument, fmt::format("{}: there is no token in it", path));
  return access;
}

// Errors do not quote the line, since any word of it may be a secret.
core::Status Access::add_line(std::string_view line) {
  const auto refuse = [](const std::string& what) { return core::fail(ErrorCode::kInvalidArgument, what); };
  std::istringstream words{std::string(line)};
  std::string role_text, name, token, more;
  if (!(words >> role_text) || role_text.front() == '#') return {};
  if (!(words >> name >> token) || words >> more) return refuse("a line has three words: ROLE NAME TOKEN");
  const auto role =
      std::find_if(kRoles.begin(), kRoles.end(), [&](const auto& r) { return r.first == role_text; });
  if (role == kRoles.end()) return refuse("the first word must be a role: submit, work or admin");
  if (name.size() > kMaxNameLength || !core::is_printable(name))
    return refuse(fmt::format("the second word is a name of at most {} printable characters, in UTF-8",
                              kMaxNameLength));
  if (token.size() < kMinTokenLength || !proto::is_token(token)) {
    return refuse(
        fmt::format("the third word is a token of at least {} letters, digits and -._~+/=", kMinTokenLength));
  }
  if (!callers_.emplace(digest_of_token(token), Caller{name, role->second, {}}).second)
    return refuse("this token was given to somebody already");
  return {};
}

grpc::Status Access::admit(const grpc::CallbackServerContext& context, Role role, Caller& caller) const {
  caller = {};
  if (open_) return grpc::Status::OK;
  const std::string_view token = shown_token(context);
  if (token.empty())
    return {StatusCode::UNAUTHENTICATED,
            "this farm asks for a token: give --token-file, or name the file in TESSERA_TOKEN_FILE"};
  const auto known = callers_.find(digest_of_token(token));
  if (known == callers_.end())
    return {StatusCode::UNAUTHENTICATED,
            "this farm does not know the token that was shown: ask its administrator"};
  caller = known->second;
  if (caller.role == role || caller.role == Role::kAdmin) return grpc::Status::OK;
  return {StatusCode::PERMISSION_DENIED,
          fmt::format("the token of {} is for '{}', and this needs one for '{}'", caller.name,
                      role_name(caller.role), role_name(role))};
}

}  // namespace tessera::auth
