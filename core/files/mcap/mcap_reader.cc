#include "core/files/mcap/mcap_reader.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/files/mcap/compression.h"

namespace tactus::internal {
namespace {

constexpr uint64_t kBlockBytes = 64 * 1024;

// Records that are read as a whole, and how long they may be.
uint64_t MaxBytes(McapOpcode opcode) {
  switch (opcode) {
    case McapOpcode::kChunk:
    case McapOpcode::kMessage:
      return limits::kMaxMcapRecordBytes;
    case McapOpcode::kSchema:
    case McapOpcode::kChannel:
      return limits::kMaxMcapSchemaBytes;
    case McapOpcode::kMetadata:
    case McapOpcode::kHeader:
      return limits::kMaxMcapMetadataBytes;
    case McapOpcode::kDataEnd:
    case McapOpcode::kFooter:
      return 1024;
    default:
      return 0;
  }
}

}  // namespace

absl::StatusOr<std::unique_ptr<McapReader>> McapReader::Open(
    const std::string& path) {
  std::unique_ptr<McapReader> reader(new McapReader(path));
  std::error_code error;
  reader->size_ = std::filesystem::file_size(path, error);
  if (error) return IoError(path, error.message());
  reader->file_.open(path, std::ios::binary);
  if (!reader->file_) return IoError(path, "cannot be read");
  std::string magic;
  const uint64_t bytes = std::min<uint64_t>(reader->size_, kMcapMagic.size());
  TACTUS_RETURN_IF_ERROR(reader->ReadBytes(bytes, &magic));
  if (!absl::StartsWith(kMcapMagic, magic)) {
    return TrialFileInvalid(path, "is not an MCAP file");
  }
  reader->crc_ = McapCrc(0, magic);
  reader->offset_ = bytes;
  reader->good_bytes_ = bytes;
  return reader;
}

absl::StatusOr<McapRead> McapReader::Next() {
  if (!status_.ok()) return status_;
  if (ended_) return McapRead::kEnd;
  absl::StatusOr<McapRead> read = Read();
  status_ = read.status();
  ended_ = read.ok() && *read == McapRead::kEnd;
  return read;
}

absl::StatusOr<McapRead> McapReader::Read() {
  bool found = false;
  while (true) {
    TACTUS_ASSIGN_OR_RETURN(const McapRead read, chunk_.empty()
                                                     ? ReadRecord(&found)
                                                     : ReadFromChunk(&found));
    if (found) return read;
  }
}

absl::StatusOr<McapRead> McapReader::ReadRecord(bool* found) {
  *found = true;
  record_offset_ = offset_;
  if (!Remains(kMcapPrefixBytes)) return McapRead::kEnd;
  TACTUS_RETURN_IF_ERROR(ReadBytes(kMcapPrefixBytes, &prefix_));
  McapCursor cursor(prefix_);
  const auto opcode = static_cast<McapOpcode>(cursor.Number<uint8_t>());
  const auto length = cursor.Number<uint64_t>();
  // A file system may fill with zeros what a crash kept it from writing.
  if (opcode == McapOpcode{0} || length > size_ - offset_ - kMcapPrefixBytes) {
    return McapRead::kEnd;
  }
  // Only the data must be good.
  if (in_summary_ && opcode == McapOpcode::kFooter &&
      length > MaxBytes(opcode)) {
    return McapRead::kEnd;
  }
  if (!has_header_ && opcode != McapOpcode::kHeader) {
    return Invalid("must be a header");
  }
  has_header_ = true;
  if (opcode != McapOpcode::kDataEnd) crc_ = McapCrc(crc_, prefix_);
  if (MaxBytes(opcode) == 0 || (in_summary_ && opcode != McapOpcode::kFooter)) {
    TACTUS_RETURN_IF_ERROR(SkipContent(length));
  } else {
    TACTUS_RETURN_IF_ERROR(ReadContent(opcode, length));
  }
  McapRead read = McapRead::kEnd;
  *found = false;
  const bool in_data = !in_summary_;
  if (in_data) {
    switch (opcode) {
      case McapOpcode::kHeader:
        TACTUS_RETURN_IF_ERROR(TakeHeader());
        break;
      case McapOpcode::kSchema:
        TACTUS_RETURN_IF_ERROR(TakeSchema(content_));
        break;
      case McapOpcode::kChannel:
        TACTUS_RETURN_IF_ERROR(TakeChannel(content_));
        break;
      case McapOpcode::kMessage:
        TACTUS_RETURN_IF_ERROR(TakeMessage(content_));
        read = McapRead::kMessage;
        *found = true;
        break;
      case McapOpcode::kMetadata:
        TACTUS_RETURN_IF_ERROR(TakeMetadata());
        read = McapRead::kMetadata;
        *found = true;
        break;
      case McapOpcode::kChunk:
        TACTUS_RETURN_IF_ERROR(OpenChunk());
        break;
      case McapOpcode::kDataEnd:
        TACTUS_RETURN_IF_ERROR(TakeDataEnd());
        break;
      case McapOpcode::kFooter:
        return Invalid("must not be a footer: the data has no end");
      default:
        break;
    }
  } else if (opcode == McapOpcode::kFooter) {
    TACTUS_RETURN_IF_ERROR(TakeFooter());
    *found = true;
  }
  offset_ += kMcapPrefixBytes + length;
  if (in_data) good_bytes_ = offset_;
  if (complete_) good_bytes_ = size_;
  return read;
}

absl::StatusOr<McapRead> McapReader::ReadFromChunk(bool* found) {
  McapCursor cursor(chunk_);
  const auto opcode = static_cast<McapOpcode>(cursor.Number<uint8_t>());
  const auto length = cursor.Number<uint64_t>();
  const absl::string_view content = cursor.Take(length);
  if (!cursor.good())
    return Invalid("is a chunk whose last record is too long");
  chunk_ = cursor.rest();
  *found = opcode == McapOpcode::kMessage;
  if (opcode == McapOpcode::kSchema) {
    TACTUS_RETURN_IF_ERROR(TakeSchema(content));
  } else if (opcode == McapOpcode::kChannel) {
    TACTUS_RETURN_IF_ERROR(TakeChannel(content));
  } else if (opcode == McapOpcode::kMessage) {
    TACTUS_RETURN_IF_ERROR(TakeMessage(content));
  }
  return McapRead::kMessage;
}

absl::Status McapReader::ReadBytes(uint64_t count, std::string* out) {
  out->resize(count);
  if (!file_.read(out->data(), static_cast<std::streamsize>(count))) {
    return IoError(path_, "cannot be read");
  }
  return absl::OkStatus();
}

absl::Status McapReader::ReadContent(McapOpcode opcode, uint64_t length) {
  if (length > MaxBytes(opcode)) {
    return Invalid(absl::StrCat("has ", length, " bytes; the limit is ",
                                MaxBytes(opcode)));
  }
  TACTUS_RETURN_IF_ERROR(ReadBytes(length, &content_));
  if (opcode != McapOpcode::kDataEnd && opcode != McapOpcode::kFooter) {
    crc_ = McapCrc(crc_, content_);
  }
  return absl::OkStatus();
}

absl::Status McapReader::SkipContent(uint64_t length) {
  while (length > 0) {
    const uint64_t count = std::min(length, kBlockBytes);
    TACTUS_RETURN_IF_ERROR(ReadBytes(count, &content_));
    crc_ = McapCrc(crc_, content_);
    length -= count;
  }
  return absl::OkStatus();
}

absl::Status McapReader::TakeHeader() {
  McapCursor cursor(content_);
  profile_ = std::string(cursor.Text());
  return cursor.good() ? absl::OkStatus()
                       : Invalid("is a header without its parts");
}

absl::Status McapReader::OpenChunk() {
  McapCursor cursor(content_);
  cursor.Take(2 * sizeof(uint64_t));
  const auto size = cursor.Number<uint64_t>();
  const auto crc = cursor.Number<uint32_t>();
  const absl::string_view compression = cursor.Text();
  absl::string_view records = cursor.Take(cursor.Number<uint64_t>());
  if (!cursor.good()) return Invalid("is a chunk that ends too early");
  if (compression.empty() && size != records.size()) {
    return Invalid(absl::StrCat("is a chunk that states ", size,
                                " bytes of records but has ", records.size()));
  }
  if (!compression.empty()) {
    if (size > limits::kMaxMcapRecordBytes) {
      return Invalid(absl::StrCat("is a chunk of ", size,
                                  " bytes; the limit is ",
                                  limits::kMaxMcapRecordBytes));
    }
    const std::string fault = Decompress(compression, records, size, &records_);
    if (!fault.empty()) return Invalid(absl::StrCat("is a chunk that ", fault));
    compressions_.insert(std::string(compression));
    records = records_;
  }
  if (crc != 0 && McapCrc(0, records) != crc) {
    return WrongChecksum("the chunk at", McapCrc(0, records), crc);
  }
  chunk_ = records;
  return absl::OkStatus();
}

absl::Status McapReader::TakeSchema(absl::string_view content) {
  McapCursor cursor(content);
  const auto id = cursor.Number<uint16_t>();
  McapSchema schema;
  schema.name = std::string(cursor.Text());
  schema.encoding = std::string(cursor.Text());
  schema.data = std::string(cursor.Text());
  if (!cursor.good() || id == 0)
    return Invalid("is a schema without its parts");
  const auto known = schemas_.find(id);
  if (known != schemas_.end()) {
    if (known->second == schema) return absl::OkStatus();
    return Invalid(absl::StrCat("changes schema ", id));
  }
  schema_bytes_ += content.size() + sizeof(McapSchema);
  if (schema_bytes_ > limits::kMaxMcapSchemaBytes) {
    return Invalid(absl::StrCat("is a schema too many; all may have ",
                                limits::kMaxMcapSchemaBytes, " bytes"));
  }
  schemas_[id] = std::move(schema);
  return absl::OkStatus();
}

absl::Status McapReader::TakeChannel(absl::string_view content) {
  if (content.size() > limits::kMaxMcapMetadataBytes) {
    return Invalid(absl::StrCat("is a channel of ", content.size(),
                                " bytes; the limit is ",
                                limits::kMaxMcapMetadataBytes));
  }
  McapCursor cursor(content);
  const auto id = cursor.Number<uint16_t>();
  McapChannel channel;
  channel.schema = cursor.Number<uint16_t>();
  channel.topic = std::string(cursor.Text());
  channel.message_encoding = std::string(cursor.Text());
  channel.metadata = cursor.TextMap();
  if (!cursor.good()) return Invalid("is a channel without its parts");
  if (channel.schema != 0 && !schemas_.contains(channel.schema)) {
    return Invalid(
        absl::StrCat("is a channel with the unknown schema ", channel.schema));
  }
  const auto known = channels_.find(id);
  if (known != channels_.end()) {
    if (known->second == channel) return absl::OkStatus();
    return Invalid(absl::StrCat("changes channel ", id));
  }
  // A map needs several times its bytes.
  schema_bytes_ += 16 * content.size() + sizeof(McapChannel);
  if (schema_bytes_ > limits::kMaxMcapSchemaBytes) {
    return Invalid(absl::StrCat("is a channel too many; all may have ",
                                limits::kMaxMcapSchemaBytes, " bytes"));
  }
  channels_[id] = std::move(channel);
  return absl::OkStatus();
}

absl::Status McapReader::TakeMessage(absl::string_view content) {
  McapCursor cursor(content);
  const auto id = cursor.Number<uint16_t>();
  message_.sequence = cursor.Number<uint32_t>();
  message_.log_time = cursor.Number<uint64_t>();
  message_.publish_time = cursor.Number<uint64_t>();
  message_.data = cursor.rest();
  if (!cursor.good()) return Invalid("is a message that ends too early");
  const auto channel = channels_.find(id);
  if (channel == channels_.end()) {
    return Invalid(absl::StrCat("is a message of the unknown channel ", id));
  }
  message_.channel = &channel->second;
  message_.schema =
      channel->second.schema == 0 ? nullptr : &schemas_[channel->second.schema];
  return absl::OkStatus();
}

absl::Status McapReader::TakeMetadata() {
  McapCursor cursor(content_);
  metadata_.name = std::string(cursor.Text());
  metadata_.values = cursor.TextMap();
  return cursor.good() ? absl::OkStatus()
                       : Invalid("is metadata without its parts");
}

absl::Status McapReader::TakeDataEnd() {
  McapCursor cursor(content_);
  const auto crc = cursor.Number<uint32_t>();
  if (!cursor.good()) return Invalid("is an end of data without its parts");
  if (crc != 0 && crc != crc_)
    return WrongChecksum("the data before", crc_, crc);
  in_summary_ = true;
  crc_ = 0;
  return absl::OkStatus();
}

absl::Status McapReader::TakeFooter() {
  McapCursor cursor(content_);
  crc_ = McapCrc(crc_, cursor.Take(2 * sizeof(uint64_t)));
  const auto crc = cursor.Number<uint32_t>();
  std::string magic;
  const uint64_t left = size_ - offset_ - kMcapPrefixBytes - content_.size();
  TACTUS_RETURN_IF_ERROR(
      ReadBytes(std::min<uint64_t>(left, kMcapMagic.size()), &magic));
  complete_ = cursor.good() && (crc == 0 || crc == crc_) &&
              left == kMcapMagic.size() && magic == kMcapMagic;
  return absl::OkStatus();
}

absl::Status McapReader::Invalid(absl::string_view message) const {
  return TrialFileInvalid(
      path_, absl::StrCat("the record at byte ", record_offset_, " ", message));
}

absl::Status McapReader::WrongChecksum(absl::string_view what, uint32_t found,
                                       uint32_t stated) const {
  return DataLost(path_, absl::StrFormat("%s byte %d is "
                                         "damaged: CRC-32 %08x, not %08x",
                                         what, record_offset_, found, stated));
}

}  // namespace tactus::internal
