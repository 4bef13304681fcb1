// File: mcap_records.h
//
// What the MCAP writer and reader share: the container's constants, its records
// as plain data, and numbers as they lie in a file. The format is version 0 of
// the open specification (mcap.dev/spec).
//
//   std::string content;
//   PutMcapNumber<uint16_t>(7, &content);
//   PutMcapText("topic", &content);
//   McapCursor cursor(content);
//   cursor.Number<uint16_t>();  // 7
//
// Plain data; thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "absl/strings/string_view.h"

namespace tactus::internal {

inline constexpr absl::string_view kMcapMagic("\x89MCAP0\r\n", 8);
// Opcode and length of a record.
inline constexpr size_t kMcapPrefixBytes = 9;

enum class McapOpcode : uint8_t {
  kHeader = 1,
  kFooter = 2,
  kSchema = 3,
  kChannel = 4,
  kMessage = 5,
  kChunk = 6,
  kMessageIndex = 7,
  kChunkIndex = 8,
  kAttachment = 9,
  kAttachmentIndex = 10,
  kStatistics = 11,
  kMetadata = 12,
  kMetadataIndex = 13,
  kSummaryOffset = 14,
  kDataEnd = 15,
};

// How the messages of a channel are encoded, e.g. "protobuf" with a serialised
// FileDescriptorSet as `data`.
struct McapSchema {
  std::string name;
  std::string encoding;
  std::string data;

  bool operator==(const McapSchema&) const = default;
};

struct McapChannel {
  // 0: none.
  uint16_t schema = 0;
  std::string topic;
  std::string message_encoding;
  std::map<std::string, std::string> metadata;

  bool operator==(const McapChannel&) const = default;
};

struct McapMetadata {
  std::string name;
  std::map<std::string, std::string> values;
};

// The CRC-32 of some bytes followed by `bytes`, where `crc` is that of the
// former; 0 for none.
uint32_t McapCrc(uint32_t crc, absl::string_view bytes);

// Little-endian, whatever the machine.
template <typename Value>
void PutMcapNumber(Value value, std::string* out) {
  for (size_t i = 0; i < sizeof(Value); ++i) {
    out->push_back(static_cast<char>(static_cast<uint64_t>(value) >> (8 * i)));
  }
}

// With its length before it, in 32 bits.
inline void PutMcapText(absl::string_view text, std::string* out) {
  PutMcapNumber(static_cast<uint32_t>(text.size()), out);
  out->append(text.data(), text.size());
}

// Reads what the functions above wrote. What is beyond the end reads as 0 or
// empty text, and good() is false from then on.
class McapCursor {
 public:
  explicit McapCursor(absl::string_view bytes) : rest_(bytes) {}

  bool good() const { return good_; }
  absl::string_view rest() const { return rest_; }

  template <typename Value>
  Value Number() {
    const absl::string_view bytes = Take(sizeof(Value));
    uint64_t value = 0;
    for (size_t i = 0; i < bytes.size(); ++i) {
      value |= static_cast<uint64_t>(static_cast<uint8_t>(bytes[i])) << (8 * i);
    }
    return static_cast<Value>(value);
  }
  absl::string_view Take(uint64_t count) {
    if (count > rest_.size()) {
      good_ = false;
      rest_ = {};
      return {};
    }
    const absl::string_view taken = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return taken;
  }
  absl::string_view Text() { return Take(Number<uint32_t>()); }
  std::map<std::string, std::string> TextMap() {
    McapCursor entries(Text());
    std::map<std::string, std::string> map;
    while (good_ && !entries.rest_.empty()) {
      const absl::string_view key = entries.Text();
      map[std::string(key)] = std::string(entries.Text());
      good_ = entries.good_;
    }
    return map;
  }

 private:
  absl::string_view rest_;
  bool good_ = true;
};

}  // namespace tactus::internal
