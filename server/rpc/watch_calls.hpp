// SPDX-License-Identifier: Apache-2.0
// The calls of WatchJob, WatchFarm and WatchTiles.
#pragma once

#include <string>

#include "server/rpc/watch_stream.hpp"
#include "tessera/v1/render_service.pb.h"

namespace tessera::rpc {

class WatchJobCall final : public WatchStream {
 public:
  using WatchStream::WatchStream;

 private:
  google::protobuf::Message& message() override { return request_; }
  const std::string& job_id() const override { return request_.job_id(); }
  core::Result<Step> next() override;

  v1::WatchJobRequest request_;
  v1::WatchJobResponse response_;
  std::string last_sent_;  // the last job sent, serialised
};

class WatchFarmCall final : public WatchStream {
 public:
  using WatchStream::WatchStream;

 private:
  google::protobuf::Message& message() override { return request_; }
  const std::string& job_id() const override { return everything_; }
  core::Result<Step> next() override;

  const std::string everything_;
  v1::WatchFarmRequest request_;
  std::shared_ptr<const watch::FarmUpdate> update_;  // the last one sent
};

class WatchTilesCall final : public WatchStream {
 public:
  using WatchStream::WatchStream;

 private:
  google::protobuf::Message& message() override { return request_; }
  const std::string& job_id() const override { return request_.job_id(); }
  core::Result<Step> next() override;
  Clock::duration pause_after(std::size_t bytes) const;

  v1::WatchTilesRequest request_;
  v1::WatchTilesResponse response_;
  bool has_sent_ = false;
  v1::JobState last_state_ = v1::JOB_STATE_UNSPECIFIED;
  events::Revision since_ = 0;
};

}  // namespace tessera::rpc
