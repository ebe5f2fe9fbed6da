// SPDX-License-Identifier: Apache-2.0
// A coordinator with its HTTP API on a free port, and a client of that.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "server/http/api.hpp"
#include "tests/unit/http/raw_client.hpp"
#include "tests/unit/server/limited_service.hpp"

namespace tessera::http_api {

struct Reply {
  int status = 0;
  std::string head, body;

  nlohmann::json json() const { return nlohmann::json::parse(body, nullptr, false); }
  // The code of an error; empty if it is none.
  std::string code() const;
  std::string message() const;
  // Empty if there is none.
  std::string header(const std::string& name) const;
};

using Headers = std::map<std::string, std::string>;

class HttpService : public rpc::LimitedService {
 protected:
  ~HttpService() override { page_.reset(); }

  void start_page(const server::Limits& limits = {}) {
    start(limits);
    open_page();
  }
  void open_page() {
    auto page = Api::start(server_->services(), {.address = "127.0.0.1:0"});
    ASSERT_TRUE(page) << page.error().message;
    page_ = std::move(*page);
  }
  // With tokens for ada and ben, who submit, for work, and for root, who administrates. A token is 16 times
  // the first letter of its name.
  void start_page_with_names();

  // Reads the whole response. Changes have the header that they need.
  Reply call(const std::string& verb, const std::string& path, const std::string& body = {},
             Headers headers = {});
  Reply get(const std::string& path, const Headers& headers = {}) { return call("GET", path, {}, headers); }
  // The same as somebody.
  Reply call_as(const std::string& name, const std::string& verb, const std::string& path,
                const std::string& body = {}) {
    return call(verb, path, body, {{"Authorization", "Bearer " + token_of(name)}});
  }
  // Sends a request and returns the connection.
  std::unique_ptr<http::RawClient> send(const std::string& verb, const std::string& path,
                                        const std::string& body, const Headers& headers);
  static std::string token_of(const std::string& name) { return std::string(16, name[0]); }

  // Delivers one lease as a worker of the network does. Returns false if there is none.
  bool work_once();
  // A lease that is not delivered.
  v1::Lease take_lease();

  std::unique_ptr<Api> page_;
};

}  // namespace tessera::http_api
