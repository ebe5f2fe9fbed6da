// SPDX-License-Identifier: Apache-2.0
#include "server/http/watch_quota.hpp"

namespace tessera::http_api {

core::Result<base::FairShare::Held> take_watch(const Call& call) {
  rpc::StreamLimits& streams = call.services().streams;
  const std::string& caller = call.caller().key;
  if (auto place = streams.watches.take(caller)) return *std::move(place);
  return core::fail(
      server::temporary(server::over_share(streams.watches.held_by(caller), "jobs", "are being watched",
                                           streams.limits.watches, "--max-watches"),
                        auth::kTryAgainAfter));
}

}  // namespace tessera::http_api
