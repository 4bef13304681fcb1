#include "core/data/recording/foxglove_schema.h"

#include <bit>
#include <cstdlib>

#include "core/data/recording/message_schema.h"
#include "google/protobuf/compiler/parser.h"
#include "google/protobuf/descriptor.pb.h"
#include "google/protobuf/io/tokenizer.h"
#include "google/protobuf/io/zero_copy_stream_impl_lite.h"
#include "google/protobuf/timestamp.pb.h"

namespace tactus::internal {
namespace {

namespace pb = google::protobuf;

constexpr int64_t kNsPerSecond = 1'000'000'000;
constexpr char kHead[] =
    "syntax = \"proto3\"; package foxglove; "
    "import \"google/protobuf/timestamp.proto\"; ";

// A schema is part of the program: one that cannot be read is a mistake in it.
class Errors final : public pb::io::ErrorCollector {
 public:
  void AddError(int, int, const std::string&) override { std::abort(); }
};

// Wire types.
constexpr uint32_t kVarint = 0;
constexpr uint32_t kEightBytes = 1;
constexpr uint32_t kLength = 2;
constexpr uint32_t kFourBytes = 5;

}  // namespace

McapSchema FoxgloveSchema(const std::string& name,
                          const std::string& messages) {
  const std::string text = kHead + messages;
  pb::io::ArrayInputStream stream(text.data(), static_cast<int>(text.size()));
  Errors errors;
  pb::io::Tokenizer tokens(&stream, &errors);
  pb::compiler::Parser parser;
  parser.RecordErrorsTo(&errors);
  pb::FileDescriptorProto file;
  parser.Parse(&tokens, &file);
  std::string path = name + ".proto";
  path[path.find('.')] = '/';
  file.set_name(path);
  pb::FileDescriptorProto timestamp;
  pb::Timestamp::descriptor()->file()->CopyTo(&timestamp);
  // Builds the file, because that completes the names of types.
  pb::DescriptorPool pool;
  pool.BuildFile(timestamp);
  pool.BuildFile(file);
  return MessageSchema(*pool.FindMessageTypeByName(name));
}

void ProtoFields::AddVarint(uint64_t value) {
  for (; value >= 0x80; value >>= 7) {
    bytes_ += static_cast<char>((value & 0x7f) | 0x80);
  }
  bytes_ += static_cast<char>(value);
}

void ProtoFields::AddTag(int field, uint32_t wire_type) {
  AddVarint(static_cast<uint32_t>(field) << 3 | wire_type);
}

void ProtoFields::AddBytes(int field, absl::string_view bytes) {
  AddTag(field, kLength);
  AddVarint(bytes.size());
  bytes_.append(bytes.data(), bytes.size());
}

void ProtoFields::AddTime(int field, int64_t time_ns) {
  int64_t seconds = time_ns / kNsPerSecond;
  int64_t ns = time_ns % kNsPerSecond;
  if (ns < 0) {
    ns += kNsPerSecond;
    --seconds;
  }
  pb::Timestamp time;
  time.set_seconds(seconds);
  time.set_nanos(static_cast<int32_t>(ns));
  AddBytes(field, time.SerializeAsString());
}

void ProtoFields::AddFixed(int field, uint32_t value) {
  AddTag(field, kFourBytes);
  PutMcapNumber(value, &bytes_);
}

void ProtoFields::AddDouble(int field, double value) {
  AddTag(field, kEightBytes);
  PutMcapNumber(std::bit_cast<uint64_t>(value), &bytes_);
}

void ProtoFields::AddEnum(int field, uint32_t value) {
  AddTag(field, kVarint);
  AddVarint(value);
}

}  // namespace tactus::internal
