// File: foxglove_schema.h
//
// Schemas of Foxglove (docs.foxglove.dev, "Message schemas") as protobuf, and
// their messages, without classes that are generated for them.
//
//   const McapSchema schema = FoxgloveSchema(
//       "foxglove.Point2",
//       "message Point2 { double x = 1; double y = 2; }");
//   ProtoFields point;
//   point.AddDouble(1, 2.5);
//   const std::string bytes = point.bytes();
//
// Thread-safe: a free function without state, and objects of one thread.
#pragma once

#include <cstdint>
#include <string>

#include "absl/strings/string_view.h"
#include "core/files/mcap/mcap_records.h"

namespace tactus::internal {

// The schema of the message `name` of the package foxglove. `messages`: it and
// those that it needs in the language of .proto files, version 3, without the
// lines above the first message. google.protobuf.Timestamp is known there.
McapSchema FoxgloveSchema(const std::string& name, const std::string& messages);

// Writes the fields of one message, in the order of the calls. Default values
// are written, too, as the language allows.
class ProtoFields {
 public:
  // Also text.
  void AddBytes(int field, absl::string_view bytes);
  void AddMessage(int field, const ProtoFields& message) {
    AddBytes(field, message.bytes_);
  }
  // A google.protobuf.Timestamp. Times before 1970 are below 0.
  void AddTime(int field, int64_t time_ns);
  // A fixed32.
  void AddFixed(int field, uint32_t value);
  void AddDouble(int field, double value);
  // Also bool and unsigned integers.
  void AddEnum(int field, uint32_t value);

  const std::string& bytes() const { return bytes_; }

 private:
  void AddVarint(uint64_t value);
  void AddTag(int field, uint32_t wire_type);

  std::string bytes_;
};

}  // namespace tactus::internal
