#include "core/bundle/field_count.h"

#include <cstdint>

#include "google/protobuf/io/coded_stream.h"
#include "google/protobuf/wire_format_lite.h"

namespace tactus::internal {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::internal::WireFormatLite;
using google::protobuf::io::CodedInputStream;

// Subtracts the fields up to the stream's limit from `left`. Returns false once
// there are too many or the encoding is wrong.
bool CountFields(const Descriptor& type, CodedInputStream& in, int& left) {
  for (uint32_t tag = in.ReadTag(); tag != 0; tag = in.ReadTag()) {
    const auto wire_type = WireFormatLite::GetTagWireType(tag);
    // proto3 has no groups.
    if (--left < 0 || wire_type == WireFormatLite::WIRETYPE_START_GROUP ||
        wire_type == WireFormatLite::WIRETYPE_END_GROUP) {
      return false;
    }
    const FieldDescriptor* field =
        type.FindFieldByNumber(WireFormatLite::GetTagFieldNumber(tag));
    const bool nested = field != nullptr &&
                        field->type() == FieldDescriptor::TYPE_MESSAGE &&
                        wire_type == WireFormatLite::WIRETYPE_LENGTH_DELIMITED;
    if (!nested) {
      if (!WireFormatLite::SkipField(&in, tag)) return false;
      continue;
    }
    uint32_t size = 0;
    if (!in.ReadVarint32(&size)) return false;
    const auto [outer, depth] =
        in.IncrementRecursionDepthAndPushLimit(static_cast<int>(size));
    if (depth < 0 || !CountFields(*field->message_type(), in, left) ||
        !in.DecrementRecursionDepthAndPopLimit(outer)) {
      return false;
    }
  }
  return in.ConsumedEntireMessage();
}

}  // namespace

bool HasAtMostFields(const Descriptor& type, absl::string_view bytes,
                     int limit) {
  CodedInputStream in(reinterpret_cast<const uint8_t*>(bytes.data()),
                      static_cast<int>(bytes.size()));
  return CountFields(type, in, limit);
}

}  // namespace tactus::internal
