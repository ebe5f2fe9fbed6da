// SPDX-License-Identifier: Apache-2.0
#include "server/auth/message_shape.hpp"

#include <fmt/format.h>
#include <google/protobuf/io/coded_stream.h>
#include <grpcpp/support/proto_buffer_reader.h>

#include <algorithm>
#include <limits>
#include <map>
#include <string>

#include "server/limits.hpp"

namespace tessera::auth {

namespace {

using core::ErrorCode;
using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::io::CodedInputStream;

// The protocol's messages nest at most four levels deep.
constexpr int kMaxDepth = 16;

// Protocol Buffers, "Encoding": the lowest three bits of a tag.
enum class WireType : std::uint32_t { kVarint = 0, kFixed64 = 1, kBytes = 2, kFixed32 = 5 };

core::Status malformed() {
  return core::fail(ErrorCode::kInvalidArgument,
                    "the message is not one of this method: its encoding is damaged or of another contract");
}

// The shortest encoding of one element of a packed field.
int packed_bytes(const FieldDescriptor& field) {
  switch (field.type()) {
    case FieldDescriptor::TYPE_DOUBLE:
    case FieldDescriptor::TYPE_FIXED64:
    case FieldDescriptor::TYPE_SFIXED64:
      return 8;
    case FieldDescriptor::TYPE_FLOAT:
    case FieldDescriptor::TYPE_FIXED32:
    case FieldDescriptor::TYPE_SFIXED32:
      return 4;
    default:
      return 1;
  }
}

class Walk {
 public:
  Walk(CodedInputStream& in, const ShapeLimits& limits) : in_(in), limits_(limits) {}

  // Checks up to the end of the stream, or to its innermost limit.
  core::Status message(const Descriptor& type, int depth);

 private:
  using Counts = std::map<const FieldDescriptor*, std::uint64_t>;

  core::Status value(const FieldDescriptor* field, WireType wire_type, int depth, Counts& counts);
  core::Status sized_value(const FieldDescriptor* field, int depth, Counts& counts);
  core::Status count(const FieldDescriptor* field, std::uint64_t elements, Counts& counts);

  CodedInputStream& in_;
  const ShapeLimits& limits_;
  std::uint64_t fields_ = 0;
};

core::Status Walk::message(const Descriptor& type, int depth) {
  if (depth > kMaxDepth)
    return core::fail(ErrorCode::kInvalidArgument,
                      fmt::format("the message nests more than {} deep", kMaxDepth));
  Counts counts;
  while (const std::uint32_t tag = in_.ReadTag()) {
    const FieldDescriptor* const field = type.FindFieldByNumber(static_cast<int>(tag >> 3));
    if (auto fits = value(field, static_cast<WireType>(tag & 7), depth, counts); !fits) return fits;
  }
  return in_.ConsumedEntireMessage() ? core::Status() : malformed();
}

core::Status Walk::value(const FieldDescriptor* field, WireType wire_type, int depth, Counts& counts) {
  if (wire_type == WireType::kBytes) return sized_value(field, depth, counts);
  if (auto fits = count(field, 1, counts); !fits) return fits;
  std::uint64_t ignored = 0;
  switch (wire_type) {
    case WireType::kVarint:
      return in_.ReadVarint64(&ignored) ? core::Status() : malformed();
    case WireType::kFixed64:
      return in_.Skip(8) ? core::Status() : malformed();
    case WireType::kFixed32:
      return in_.Skip(4) ? core::Status() : malformed();
    default:
      return malformed();  // groups, which proto3 does not have
  }
}

core::Status Walk::sized_value(const FieldDescriptor* field, int depth, Counts& counts) {
  int size = 0;
  if (!in_.ReadVarintSizeAsInt(&size)) return malformed();
  const bool packed = field != nullptr && field->is_packable();
  const int elements = packed ? size / packed_bytes(*field) : 1;
  if (auto fits = count(field, static_cast<std::uint64_t>(elements), counts); !fits) return fits;
  if (field == nullptr || field->message_type() == nullptr)
    return in_.Skip(size) ? core::Status() : malformed();
  const CodedInputStream::Limit outer = in_.PushLimit(size);
  if (auto fits = message(*field->message_type(), depth + 1); !fits) return fits;
  // Also if the stream ended earlier.
  if (in_.BytesUntilLimit() != 0) return malformed();
  in_.PopLimit(outer);
  return {};
}

core::Status Walk::count(const FieldDescriptor* field, std::uint64_t elements, Counts& counts) {
  fields_ += elements;
  if (fields_ > limits_.max_fields)
    return core::fail(ErrorCode::kInvalidArgument,
                      fmt::format("the message has more than {} fields, and this method takes no more",
                                  limits_.max_fields));
  if (field == nullptr || !field->is_repeated()) return {};
  const auto limit = std::find_if(limits_.fields.begin(), limits_.fields.end(),
                                  [&](const FieldLimit& each) { return each.field == field->full_name(); });
  if (limit == limits_.fields.end()) return {};
  std::uint64_t& of_field = counts[field];
  of_field += elements;
  if (of_field <= limit->max_elements) return {};
  const std::string found = fmt::format("{}: there are more than {}", field->name(), limit->max_elements);
  if (!limit->option.empty())
    return core::fail(server::over_limit(found, std::to_string(limit->max_elements), limit->option));
  return core::fail(ErrorCode::kInvalidArgument, found);
}

}  // namespace

core::Status check_shape(grpc::ByteBuffer& message, const Descriptor& type, const ShapeLimits& limits) {
  grpc::ProtoBufferReader reader(&message);
  CodedInputStream in(&reader);
  in.SetTotalBytesLimit(std::numeric_limits<int>::max());
  return Walk(in, limits).message(type, 1);
}

}  // namespace tessera::auth
