#include "core/files/mcap/mcap_writer.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

void PutRecord(McapOpcode opcode, absl::string_view content, std::string* out) {
  PutMcapNumber(static_cast<uint8_t>(opcode), out);
  PutMcapNumber(static_cast<uint64_t>(content.size()), out);
  absl::StrAppend(out, content);
}

void PutMap(const std::map<std::string, std::string>& map, std::string* out) {
  std::string entries;
  for (const auto& [key, value] : map) {
    PutMcapText(key, &entries);
    PutMcapText(value, &entries);
  }
  PutMcapText(entries, out);
}

std::string SchemaRecord(uint16_t id, const McapSchema& schema) {
  std::string content;
  PutMcapNumber(id, &content);
  PutMcapText(schema.name, &content);
  PutMcapText(schema.encoding, &content);
  PutMcapText(schema.data, &content);
  std::string record;
  PutRecord(McapOpcode::kSchema, content, &record);
  return record;
}

std::string ChannelRecord(uint16_t id, const McapChannel& channel) {
  std::string content;
  PutMcapNumber(id, &content);
  PutMcapNumber(channel.schema, &content);
  PutMcapText(channel.topic, &content);
  PutMcapText(channel.message_encoding, &content);
  PutMap(channel.metadata, &content);
  std::string record;
  PutRecord(McapOpcode::kChannel, content, &record);
  return record;
}

// A group of one kind of records in the summary.
struct Group {
  McapOpcode opcode;
  std::string records;
};

}  // namespace

McapWriter::McapWriter(std::string path, int fd, McapWriterOptions options)
    : path_(std::move(path)), fd_(fd), options_(std::move(options)) {}

McapWriter::~McapWriter() {
  if (fd_ >= 0) close(fd_);
}

absl::StatusOr<std::unique_ptr<McapWriter>> McapWriter::Create(
    const std::string& path, const McapWriterOptions& options) {
  const int fd =
      open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (fd < 0) {
    return IoError(path, errno == EEXIST
                             ? "exists already; a recording needs a new name"
                             : std::strerror(errno));
  }
  std::unique_ptr<McapWriter> writer(new McapWriter(path, fd, options));
  std::string content;
  PutMcapText("", &content);
  PutMcapText(options.library, &content);
  std::string begin(kMcapMagic);
  PutRecord(McapOpcode::kHeader, content, &begin);
  TACTUS_RETURN_IF_ERROR(writer->Append(begin));
  return writer;
}

uint16_t McapWriter::AddSchema(const McapSchema& schema) {
  schemas_.push_back(schema);
  const auto id = static_cast<uint16_t>(schemas_.size());
  CloseChunk().IgnoreError();
  Append(SchemaRecord(id, schema)).IgnoreError();
  return id;
}

uint16_t McapWriter::AddChannel(const McapChannel& channel) {
  channels_.push_back(channel);
  counts_.push_back(0);
  const auto id = static_cast<uint16_t>(channels_.size());
  CloseChunk().IgnoreError();
  Append(ChannelRecord(id, channel)).IgnoreError();
  return id;
}

absl::Status McapWriter::Write(uint16_t channel, uint64_t time_ns,
                               absl::string_view data) {
  TACTUS_RETURN_IF_ERROR(status_);
  if (data.size() > limits::kMaxMcapRecordBytes / 2) {
    return InvalidConfig(
        "bytes of a message", data.size(),
        absl::StrCat("at most ", limits::kMaxMcapRecordBytes / 2));
  }
  const uint64_t first =
      records_.empty() ? time_ns : std::min(chunk_start_, time_ns);
  const uint64_t last =
      records_.empty() ? time_ns : std::max(chunk_end_, time_ns);
  if (!records_.empty() && (last - first >= options_.chunk_ns ||
                            records_.size() >= options_.chunk_bytes)) {
    TACTUS_RETURN_IF_ERROR(CloseChunk());
    return Write(channel, time_ns, data);
  }
  chunk_start_ = first;
  chunk_end_ = last;
  start_time_ = messages_ == 0 ? time_ns : std::min(start_time_, time_ns);
  end_time_ = std::max(end_time_, time_ns);
  ++messages_;
  index_[channel].emplace_back(time_ns, records_.size());
  std::string content;
  content.reserve(data.size() + 22);
  PutMcapNumber(channel, &content);
  PutMcapNumber(static_cast<uint32_t>(counts_[channel - 1]++), &content);
  PutMcapNumber(time_ns, &content);
  PutMcapNumber(time_ns, &content);
  absl::StrAppend(&content, data);
  PutRecord(McapOpcode::kMessage, content, &records_);
  return absl::OkStatus();
}

absl::Status McapWriter::WriteMetadata(const McapMetadata& metadata) {
  TACTUS_RETURN_IF_ERROR(CloseChunk());
  std::string content;
  PutMcapText(metadata.name, &content);
  PutMap(metadata.values, &content);
  std::string record;
  PutRecord(McapOpcode::kMetadata, content, &record);
  metadata_.push_back({position_, record.size(), metadata.name});
  return Append(record);
}

absl::Status McapWriter::Flush() { return CloseChunk(); }

absl::Status McapWriter::CloseChunk() {
  TACTUS_RETURN_IF_ERROR(status_);
  if (records_.empty()) return absl::OkStatus();
  ChunkIndex chunk = {.start_time = chunk_start_,
                      .end_time = chunk_end_,
                      .offset = position_,
                      .records_bytes = records_.size()};
  std::string content;
  content.reserve(records_.size() + 64);
  PutMcapNumber(chunk_start_, &content);
  PutMcapNumber(chunk_end_, &content);
  PutMcapNumber(static_cast<uint64_t>(records_.size()), &content);
  PutMcapNumber(McapCrc(0, records_), &content);
  PutMcapText("", &content);
  PutMcapNumber(static_cast<uint64_t>(records_.size()), &content);
  content.append(records_);
  std::string bytes;
  bytes.reserve(content.size() + 64);
  PutRecord(McapOpcode::kChunk, content, &bytes);
  chunk.length = bytes.size();
  for (const auto& [channel, messages] : index_) {
    chunk.message_indexes[channel] = position_ + bytes.size();
    std::string index;
    PutMcapNumber(channel, &index);
    PutMcapNumber(static_cast<uint32_t>(messages.size() * 16), &index);
    for (const auto& [time, offset] : messages) {
      PutMcapNumber(time, &index);
      PutMcapNumber(offset, &index);
    }
    PutRecord(McapOpcode::kMessageIndex, index, &bytes);
  }
  chunk.message_index_bytes = bytes.size() - chunk.length;
  records_.clear();
  index_.clear();
  TACTUS_RETURN_IF_ERROR(Append(bytes));
  chunks_.push_back(std::move(chunk));
  return options_.sync ? Sync() : absl::OkStatus();
}

absl::Status McapWriter::Finish() {
  TACTUS_RETURN_IF_ERROR(CloseChunk());
  std::string end;
  std::string content;
  PutMcapNumber(crc_, &content);
  PutRecord(McapOpcode::kDataEnd, content, &end);
  TACTUS_RETURN_IF_ERROR(Append(end));
  TACTUS_RETURN_IF_ERROR(Append(Summary()));
  if (options_.sync) TACTUS_RETURN_IF_ERROR(Sync());
  const int closed = close(std::exchange(fd_, -1));
  status_ = IoError(path_, "is finished");
  return closed == 0 ? absl::OkStatus() : IoError(path_, std::strerror(errno));
}

std::string McapWriter::Statistics() const {
  std::string content;
  PutMcapNumber(messages_, &content);
  PutMcapNumber(static_cast<uint16_t>(schemas_.size()), &content);
  PutMcapNumber(static_cast<uint32_t>(channels_.size()), &content);
  PutMcapNumber(uint32_t{0}, &content);
  PutMcapNumber(static_cast<uint32_t>(metadata_.size()), &content);
  PutMcapNumber(static_cast<uint32_t>(chunks_.size()), &content);
  PutMcapNumber(start_time_, &content);
  PutMcapNumber(end_time_, &content);
  PutMcapNumber(static_cast<uint32_t>(counts_.size() * 10), &content);
  for (size_t i = 0; i < counts_.size(); ++i) {
    PutMcapNumber(static_cast<uint16_t>(i + 1), &content);
    PutMcapNumber(counts_[i], &content);
  }
  std::string record;
  PutRecord(McapOpcode::kStatistics, content, &record);
  return record;
}

// The summary section, the footer and the last magic.
std::string McapWriter::Summary() const {
  std::vector<Group> groups = {{McapOpcode::kSchema, ""},
                               {McapOpcode::kChannel, ""},
                               {McapOpcode::kStatistics, Statistics()},
                               {McapOpcode::kMetadataIndex, ""},
                               {McapOpcode::kChunkIndex, ""}};
  for (size_t i = 0; i < schemas_.size(); ++i) {
    groups[0].records +=
        SchemaRecord(static_cast<uint16_t>(i + 1), schemas_[i]);
  }
  for (size_t i = 0; i < channels_.size(); ++i) {
    groups[1].records +=
        ChannelRecord(static_cast<uint16_t>(i + 1), channels_[i]);
  }
  for (const MetadataIndex& metadata : metadata_) {
    std::string content;
    PutMcapNumber(metadata.offset, &content);
    PutMcapNumber(metadata.length, &content);
    PutMcapText(metadata.name, &content);
    PutRecord(McapOpcode::kMetadataIndex, content, &groups[3].records);
  }
  for (const ChunkIndex& chunk : chunks_) {
    std::string content;
    PutMcapNumber(chunk.start_time, &content);
    PutMcapNumber(chunk.end_time, &content);
    PutMcapNumber(chunk.offset, &content);
    PutMcapNumber(chunk.length, &content);
    PutMcapNumber(static_cast<uint32_t>(chunk.message_indexes.size() * 10),
                  &content);
    for (const auto& [channel, offset] : chunk.message_indexes) {
      PutMcapNumber(channel, &content);
      PutMcapNumber(offset, &content);
    }
    PutMcapNumber(chunk.message_index_bytes, &content);
    PutMcapText("", &content);
    PutMcapNumber(chunk.records_bytes, &content);
    PutMcapNumber(chunk.records_bytes, &content);
    PutRecord(McapOpcode::kChunkIndex, content, &groups[4].records);
  }
  std::string summary;
  std::string offsets;
  for (const Group& group : groups) {
    if (group.records.empty()) continue;
    std::string content;
    PutMcapNumber(static_cast<uint8_t>(group.opcode), &content);
    PutMcapNumber(position_ + summary.size(), &content);
    PutMcapNumber(static_cast<uint64_t>(group.records.size()), &content);
    PutRecord(McapOpcode::kSummaryOffset, content, &offsets);
    summary += group.records;
  }
  const uint64_t offset_start = position_ + summary.size();
  summary += offsets;
  std::string footer;
  PutMcapNumber(position_, &footer);
  PutMcapNumber(offset_start, &footer);
  // The checksum covers the footer up to itself.
  PutRecord(McapOpcode::kFooter, absl::StrCat(footer, "crc."), &summary);
  summary.resize(summary.size() - 4);
  PutMcapNumber(McapCrc(0, summary), &summary);
  return absl::StrCat(summary, kMcapMagic);
}

absl::Status McapWriter::Append(absl::string_view bytes) {
  TACTUS_RETURN_IF_ERROR(status_);
  crc_ = McapCrc(crc_, bytes);
  while (!bytes.empty()) {
    const ssize_t written = write(fd_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      status_ = errno == ENOSPC ? StorageFull(path_, "the recording ends here")
                                : IoError(path_, std::strerror(errno));
      return status_;
    }
    position_ += static_cast<uint64_t>(written);
    bytes.remove_prefix(static_cast<size_t>(written));
  }
  return absl::OkStatus();
}

absl::Status McapWriter::Sync() {
  // Pipes and some file systems cannot be synchronised.
  if (fdatasync(fd_) == 0 || errno == EINVAL || errno == EROFS) {
    return absl::OkStatus();
  }
  status_ = IoError(path_, std::strerror(errno));
  return status_;
}

}  // namespace tactus::internal
