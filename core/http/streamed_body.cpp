// SPDX-License-Identifier: Apache-2.0
#include "core/http/streamed_body.hpp"

#include <algorithm>
#include <cstring>
#include <exception>
#include <string>
#include <utility>

namespace tessera::http {
namespace {

// Of bodies whose size is known; others use the connection's memory.
constexpr std::size_t kBlockBytes = 64 << 10;

// What a source has produced, until it is sent.
class StreamedBody {
 public:
  StreamedBody(std::unique_ptr<BodySource> source, std::shared_ptr<Connection> connection)
      : source_(std::move(source)), connection_(std::move(connection)) {
    source_->start([weak = std::weak_ptr(connection_)] {
      if (const auto woken = weak.lock()) woken->wake();
    });
  }

  // Bytes for MHD, 0 to be called again, or one of MHD's two ends.
  ssize_t read(char* buffer, std::size_t max_bytes) {
    for (;;) {
      if (sent_ < produced_.size()) return take(buffer, max_bytes);
      if (state_ == BodySource::State::kEnd) return MHD_CONTENT_READER_END_OF_STREAM;
      if (state_ == BodySource::State::kFailed || connection_->is_stopping())
        return MHD_CONTENT_READER_END_WITH_ERROR;
      connection_->begin_read();
      produce(max_bytes);
      if (!produced_.empty()) continue;
      if (state_ == BodySource::State::kMore) return 0;
      if (state_ == BodySource::State::kWait && connection_->suspend(source_->longest_wait())) return 0;
    }
  }

 private:
  void produce(std::size_t max_bytes) {
    produced_.clear();
    sent_ = 0;
    try {
      state_ = source_->read(produced_, max_bytes);
    } catch (const std::exception&) {
      state_ = BodySource::State::kFailed;
    }
  }

  ssize_t take(char* buffer, std::size_t max_bytes) {
    const std::size_t count = std::min(max_bytes, produced_.size() - sent_);
    std::memcpy(buffer, produced_.data() + sent_, count);
    sent_ += count;
    return static_cast<ssize_t>(count);
  }

  const std::unique_ptr<BodySource> source_;
  const std::shared_ptr<Connection> connection_;
  BodySource::State state_ = BodySource::State::kMore;
  std::string produced_;
  std::size_t sent_ = 0;
};

ssize_t read_streamed(void* body, std::uint64_t, char* buffer, std::size_t max_bytes) {
  return static_cast<StreamedBody*>(body)->read(buffer, max_bytes);
}

void delete_streamed(void* body) {
  delete static_cast<StreamedBody*>(body);
}

void delete_text(void* text) {
  delete static_cast<std::string*>(text);
}

}  // namespace

MHD_Response* make_mhd_response(Response response, std::shared_ptr<Connection> connection) {
  if (response.source) {
    auto body = std::make_unique<StreamedBody>(std::move(response.source), std::move(connection));
    MHD_Response* const made =
        MHD_create_response_from_callback(response.size_bytes.value_or(MHD_SIZE_UNKNOWN), kBlockBytes,
                                          &read_streamed, body.get(), &delete_streamed);
    if (made != nullptr) (void)body.release();
    return made;
  }
  auto text = std::make_unique<std::string>(std::move(response.body));
  MHD_Response* const made = MHD_create_response_from_buffer_with_free_callback_cls(
      text->size(), text->data(), &delete_text, text.get());
  if (made != nullptr) (void)text.release();
  return made;
}

}  // namespace tessera::http
