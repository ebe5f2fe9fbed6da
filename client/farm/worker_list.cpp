// SPDX-License-Identifier: Apache-2.0
#include "client/farm/worker_list.hpp"

#include <utility>

namespace tessera::client {

core::Result<v1::ListWorkersResponse> list_workers(Farm& farm, v1::ListWorkersRequest request) {
  v1::ListWorkersResponse all;
  do {
    auto page = farm.call(&Farm::Stub::ListWorkers, request);
    if (!page) return core::fail(page.error());
    request.set_page_token(page->next_page_token());
    for (v1::Worker& worker : *page->mutable_workers()) *all.add_workers() = std::move(worker);
  } while (!request.page_token().empty());
  return all;
}

}  // namespace tessera::client
