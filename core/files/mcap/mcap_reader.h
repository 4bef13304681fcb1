// File: mcap_reader.h
//
// McapReader: reads an MCAP file (mcap.dev/spec) from its beginning to its end:
// messages and metadata in the order of the file. It does not use the index, so
// it also reads a file that was cut off anywhere: everything up to the last
// complete record. Of a chunk that was cut off it takes nothing, because the
// chunk's checksum covers all of it.
//
//   TACTUS_ASSIGN_OR_RETURN(const auto reader, McapReader::Open("run.mcap"));
//   while (true) {
//     TACTUS_ASSIGN_OR_RETURN(const McapRead read, reader->Next());
//     if (read == McapRead::kEnd) break;
//     if (read == McapRead::kMessage) Use(reader->message());
//   }
//   reader->complete();  // false if the file was cut off
//
// Checksums of chunks and of the data are compared where the file has them. A
// damaged summary, which is not needed, counts as cut off. Chunks may be
// compressed with zstd or LZ4. Owns the file. Not thread-safe.
#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/files/mcap/mcap_records.h"

namespace tactus::internal {

enum class McapRead { kMessage, kMetadata, kEnd };

struct McapMessage {
  // Null if the channel has no schema.
  const McapSchema* schema = nullptr;
  const McapChannel* channel = nullptr;
  uint32_t sequence = 0;
  uint64_t log_time = 0;
  uint64_t publish_time = 0;
  absl::string_view data;
};

class McapReader {
 public:
  // IO if the file cannot be read; TRIAL_FILE_INVALID if it is no MCAP file.
  static absl::StatusOr<std::unique_ptr<McapReader>> Open(
      const std::string& path);

  McapReader(const McapReader&) = delete;
  McapReader& operator=(const McapReader&) = delete;

  // DATA_LOST if a checksum is wrong, else TRIAL_FILE_INVALID; both name the
  // byte of the file at which the record begins. After an error or the end
  // every further call returns the same.
  absl::StatusOr<McapRead> Next();

  // After kMessage or kMetadata; valid until the next call of Next.
  const McapMessage& message() const { return message_; }
  const McapMetadata& metadata() const { return metadata_; }

  // What the file has named so far. The profile is that of its header: "ros2"
  // for bags of ROS 2.
  const std::string& profile() const { return profile_; }
  const std::map<uint16_t, McapSchema>& schemas() const { return schemas_; }
  const std::map<uint16_t, McapChannel>& channels() const { return channels_; }
  // What the chunks so far were compressed with.
  const std::set<std::string>& compressions() const { return compressions_; }

  // After kEnd: whether the file ends as it should, with a summary whose
  // checksum is right. If not, what is before `complete_bytes` was read.
  bool complete() const { return complete_; }
  uint64_t complete_bytes() const { return good_bytes_; }
  uint64_t file_bytes() const { return size_; }

 private:
  explicit McapReader(std::string path) : path_(std::move(path)) {}

  absl::StatusOr<McapRead> Read();
  // Reads a record of the file; *found is whether it is one for the caller.
  absl::StatusOr<McapRead> ReadRecord(bool* found);
  // Reads one record of the chunk.
  absl::StatusOr<McapRead> ReadFromChunk(bool* found);
  absl::Status ReadBytes(uint64_t count, std::string* out);
  absl::Status ReadContent(McapOpcode opcode, uint64_t length);
  absl::Status SkipContent(uint64_t length);
  absl::Status TakeHeader();
  absl::Status OpenChunk();
  absl::Status TakeSchema(absl::string_view content);
  absl::Status TakeChannel(absl::string_view content);
  absl::Status TakeMessage(absl::string_view content);
  absl::Status TakeMetadata();
  absl::Status TakeDataEnd();
  absl::Status TakeFooter();
  absl::Status Invalid(absl::string_view message) const;
  absl::Status WrongChecksum(absl::string_view what, uint32_t found,
                             uint32_t stated) const;
  bool Remains(uint64_t bytes) const { return bytes <= size_ - offset_; }

  const std::string path_;
  std::ifstream file_;
  uint64_t size_ = 0;
  // Where the next record begins, and where the last one began.
  uint64_t offset_ = 0;
  uint64_t record_offset_ = 0;
  // The end of the last whole record of the data; of the file, if complete.
  uint64_t good_bytes_ = 0;
  bool has_header_ = false;
  // The end of the data was read; the summary follows.
  bool in_summary_ = false;
  bool complete_ = false;
  // What Next returns from now on.
  bool ended_ = false;
  absl::Status status_;
  // Checksum of the data, then of the summary.
  uint32_t crc_ = 0;

  std::string prefix_;
  std::string content_;
  std::string profile_;
  // What is left of the chunk in `content_`, or decompressed in `records_`.
  absl::string_view chunk_;
  std::string records_;
  std::set<std::string> compressions_;
  std::map<uint16_t, McapSchema> schemas_;
  std::map<uint16_t, McapChannel> channels_;
  size_t schema_bytes_ = 0;
  McapMessage message_;
  McapMetadata metadata_;
};

}  // namespace tactus::internal
