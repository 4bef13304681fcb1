#include "core/base/wire_check.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "google/protobuf/io/coded_stream.h"
#include "google/protobuf/io/zero_copy_stream_impl_lite.h"
#include "google/protobuf/wire_format_lite.h"

namespace tactus::internal {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::internal::WireFormatLite;
using google::protobuf::io::CodedInputStream;

constexpr char kWrongEncoding[] = "its encoding is wrong";
// Memory of a string beside its bytes, of a message beside its fields, and of a
// number in a list, with the overhead of allocator and growing list.
constexpr int64_t kStringBytes = 64;
constexpr int64_t kMessageBytes = 64;
constexpr int64_t kFieldBytes = 32;
constexpr int64_t kElementBytes = 16;
// An element of a packed list takes at most 8 bytes. A list doubles when it is
// full, and lives twice while it moves.
constexpr int64_t kPackedElementBytes = 24;

WireFormatLite::WireType OwnWireType(const FieldDescriptor& field) {
  return WireFormatLite::WireTypeForFieldType(
      static_cast<WireFormatLite::FieldType>(field.type()));
}

class Walk {
 public:
  explicit Walk(CodedInputStream* in) : in_(*in) {}

  bool Message(const Descriptor& type) {
    check_.parsed_bytes += kMessageBytes + kFieldBytes * type.field_count();
    for (uint32_t tag = in_.ReadTag(); tag != 0; tag = in_.ReadTag()) {
      const int number = WireFormatLite::GetTagFieldNumber(tag);
      const FieldDescriptor* field = type.FindFieldByNumber(number);
      if (field == nullptr) return Unknown(type, number);
      const auto wire_type = WireFormatLite::GetTagWireType(tag);
      if (wire_type == OwnWireType(*field)) {
        if (!Field(*field, tag)) return Wrong();
      } else if (wire_type == WireFormatLite::WIRETYPE_LENGTH_DELIMITED &&
                 field->is_packable()) {
        if (!Packed(*field)) return Wrong();
      } else {
        // The parser would keep it as a field that it does not know.
        return Unknown(type, number);
      }
    }
    return in_.ConsumedEntireMessage() || Wrong();
  }

  WireCheck Take() { return std::move(check_); }

 private:
  // The first fault stays, as that of the innermost message.
  bool Wrong() {
    if (check_.fault.empty()) check_.fault = kWrongEncoding;
    return false;
  }
  bool Unknown(const Descriptor& type, int number) {
    check_.fault =
        absl::StrCat("it has a field ", number, " that ", type.full_name(),
                     " does not have; a newer program may have written it");
    return false;
  }

  bool Field(const FieldDescriptor& field, uint32_t tag) {
    if (field.type() == FieldDescriptor::TYPE_MESSAGE) {
      uint32_t size = 0;
      if (!in_.ReadVarint32(&size)) return false;
      const auto [outer, depth] =
          in_.IncrementRecursionDepthAndPushLimit(static_cast<int>(size));
      // A message may also seem to end where the bytes end.
      return depth >= 0 && Message(*field.message_type()) &&
             in_.BytesUntilLimit() == 0 &&
             in_.DecrementRecursionDepthAndPopLimit(outer);
    }
    if (WireFormatLite::GetTagWireType(tag) ==
        WireFormatLite::WIRETYPE_LENGTH_DELIMITED) {
      uint32_t size = 0;
      if (!in_.ReadVarint32(&size)) return false;
      check_.parsed_bytes += kStringBytes + size;
      return in_.Skip(static_cast<int>(size));
    }
    if (field.is_repeated()) check_.parsed_bytes += kElementBytes;
    return WireFormatLite::SkipField(&in_, tag);
  }

  bool Packed(const FieldDescriptor& field) {
    uint32_t size = 0;
    if (!in_.ReadVarint32(&size)) return false;
    if (OwnWireType(field) != WireFormatLite::WIRETYPE_VARINT) {
      check_.parsed_bytes += size;
      return in_.Skip(static_cast<int>(size));
    }
    // A number ends with a byte below 0x80.
    while (size > 0) {
      const void* data = nullptr;
      int available = 0;
      if (!in_.GetDirectBufferPointer(&data, &available)) return false;
      const int part = std::min(available, static_cast<int>(size));
      const auto* bytes = static_cast<const uint8_t*>(data);
      check_.parsed_bytes +=
          kPackedElementBytes *
          std::count_if(bytes, bytes + part,
                        [](uint8_t byte) { return byte < 0x80; });
      if (!in_.Skip(part)) return false;
      size -= static_cast<uint32_t>(part);
    }
    return true;
  }

  CodedInputStream& in_;
  WireCheck check_;
};

}  // namespace

WireCheck CheckWire(const Descriptor& type, absl::string_view bytes) {
  google::protobuf::io::ArrayInputStream stream(bytes.data(),
                                                static_cast<int>(bytes.size()));
  return CheckWire(type, &stream);
}

WireCheck CheckWire(const Descriptor& type,
                    google::protobuf::io::ZeroCopyInputStream* bytes) {
  CodedInputStream in(bytes);
  Walk walk(&in);
  walk.Message(type);
  return walk.Take();
}

}  // namespace tactus::internal
