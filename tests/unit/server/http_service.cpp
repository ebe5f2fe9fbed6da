// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/server/http_service.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace tessera::http_api {

namespace {

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

}  // namespace

std::string Reply::code() const {
  const nlohmann::json value = json();
  return value.contains("error") ? value["error"]["code"].get<std::string>() : "";
}

std::string Reply::message() const {
  const nlohmann::json value = json();
  return value.contains("error") ? value["error"]["message"].get<std::string>() : "";
}

std::string Reply::header(const std::string& name) const {
  const std::size_t found = lower_case(head).find("\r\n" + lower_case(name) + ": ");
  if (found == std::string::npos) return {};
  const std::size_t begin = found + name.size() + 4;
  return head.substr(begin, head.find("\r\n", begin) - begin);
}

void HttpService::start_page_with_names() {
  std::string lines;
  for (const auto& [name, role] : std::map<std::string, std::string>{
           {"ada", "submit"}, {"ben", "submit"}, {"work", "work"}, {"root", "admin"}})
    lines += fmt::format("{} {} {}\n", role, name, token_of(name));
  write_file(folder_.path() / "tokens", lines);
  access_ = *auth::Access::read(folder_.path() / "tokens");
  start_page();
}

std::unique_ptr<http::RawClient> HttpService::send(const std::string& verb, const std::string& path,
                                                   const std::string& body, const Headers& headers) {
  auto client = std::make_unique<http::RawClient>(page_->address());
  std::string request = fmt::format("{} {} HTTP/1.1\r\nConnection: close\r\n", verb, path);
  if (!headers.contains("Host")) request += fmt::format("Host: {}\r\n", page_->address());
  for (const auto& [name, value] : headers) request += fmt::format("{}: {}\r\n", name, value);
  if (verb != "GET") request += fmt::format("Content-Length: {}\r\n", body.size());
  EXPECT_TRUE(client->send(request + "\r\n" + body));
  return client;
}

Reply HttpService::call(const std::string& verb, const std::string& path, const std::string& body,
                        Headers headers) {
  if (verb != "GET") headers.try_emplace("X-Tessera", "1");
  const std::string response = send(verb, path, body, headers)->receive_all();
  const std::size_t end = response.find("\r\n\r\n");
  if (response.size() < 12 || end == std::string::npos) return {};
  Reply reply{std::stoi(response.substr(9, 3)), response.substr(0, end + 2), response.substr(end + 4)};
  if (lower_case(reply.head).find("transfer-encoding: chunked") != std::string::npos)
    reply.body = http::unchunked(response);
  return reply;
}

v1::Lease HttpService::take_lease() {
  v1::SynchronizeResponse given;
  coordinator_->dispatcher().synchronize(rpc::greeting_with_key('a'), {.answer = [&](const auto& answer) {
                                           if (answer) given = *answer;
                                         }});
  const v1::Lease lease = given.leases().empty() ? v1::Lease() : given.leases(0);
  // The call may wait, and refers to what is gone with this function: it is answered here.
  coordinator_->dispatcher().synchronize(rpc::greeting_with_key('a'), {.answer = [](const auto&) {}});
  return lease;
}

bool HttpService::work_once() {
  v1::SynchronizeResponse given;
  bool is_answered = false;
  coordinator_->dispatcher().synchronize(rpc::greeting_with_key('a'), {.answer = [&](const auto& answer) {
                                           if (answer) given = *answer;
                                           is_answered = true;
                                         }});
  if (!is_answered || given.leases().empty()) {
    coordinator_->dispatcher().synchronize(rpc::greeting_with_key('a'), {.answer = [](const auto&) {}});
    return false;
  }
  for (const v1::Lease& lease : given.leases())
    EXPECT_TRUE(coordinator_->dispatcher().submit_result(server::delivery_with_key('a', lease)));
  return true;
}

}  // namespace tessera::http_api
