// File: mcap_writer.h
//
// McapWriter: writes an MCAP file (mcap.dev/spec) in chunks, so that a crash
// loses at most the chunk that is open: schemas, channels, messages and
// metadata, then an index, statistics and checksums.
//
//   TACTUS_ASSIGN_OR_RETURN(const auto writer,
//                           McapWriter::Create("run.mcap", {}));
//   const uint16_t schema = writer->AddSchema({"Point", "jsonschema", "{}"});
//   const uint16_t topic = writer->AddChannel({schema, "/point", "json", {}});
//   TACTUS_RETURN_IF_ERROR(writer->Write(topic, time_ns, R"({"x": 1})"));
//   TACTUS_RETURN_IF_ERROR(writer->Finish());
//
// Chunks are not compressed. A chunk is closed once it has `chunk_bytes`, or
// its first and last message are `chunk_ns` apart, or at Flush; it is written
// with one call, and with `sync` it is then on the disk (fdatasync). Metadata
// closes a chunk too. Times are the caller's.
//
// After an error every further call returns it. Owns the file; without Finish
// the file has no index, but all closed chunks. Not thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/files/mcap/mcap_records.h"

namespace tactus::internal {

struct McapWriterOptions {
  // Who wrote the file; a field of the header.
  std::string library = "tactus";
  size_t chunk_bytes = 1024 * 1024;
  uint64_t chunk_ns = 1'000'000'000;
  bool sync = true;
};

class McapWriter {
 public:
  // IO if the file cannot be created, or exists: a recording is never
  // overwritten.
  static absl::StatusOr<std::unique_ptr<McapWriter>> Create(
      const std::string& path, const McapWriterOptions& options);
  ~McapWriter();

  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  // Return the number of the schema or channel, from 1. An error is returned by
  // the next call that can.
  uint16_t AddSchema(const McapSchema& schema);
  uint16_t AddChannel(const McapChannel& channel);
  // `channel` is from AddChannel. INVALID_CONFIG for a message that is too
  // large; then nothing is written.
  absl::Status Write(uint16_t channel, uint64_t time_ns,
                     absl::string_view data);
  absl::Status WriteMetadata(const McapMetadata& metadata);
  // Closes the open chunk.
  absl::Status Flush();
  // Closes the open chunk, writes the summary and closes the file. Once.
  absl::Status Finish();

  // Bytes of the file so far, without the open chunk.
  uint64_t bytes() const { return position_; }

 private:
  struct ChunkIndex {
    uint64_t start_time = 0;
    uint64_t end_time = 0;
    uint64_t offset = 0;
    uint64_t length = 0;
    // Places of the message indexes, by channel.
    std::map<uint16_t, uint64_t> message_indexes = {};
    uint64_t message_index_bytes = 0;
    uint64_t records_bytes = 0;
  };
  struct MetadataIndex {
    uint64_t offset = 0;
    uint64_t length = 0;
    std::string name;
  };

  McapWriter(std::string path, int fd, McapWriterOptions options);

  // Appends to the file; part of the checksum of the data.
  absl::Status Append(absl::string_view bytes);
  absl::Status Sync();
  absl::Status CloseChunk();
  std::string Summary() const;
  std::string Statistics() const;

  const std::string path_;
  int fd_;
  const McapWriterOptions options_;
  absl::Status status_;
  uint64_t position_ = 0;
  uint32_t crc_ = 0;
  std::vector<McapSchema> schemas_;
  std::vector<McapChannel> channels_;
  // Messages of all channels, and of each.
  uint64_t messages_ = 0;
  std::vector<uint64_t> counts_;
  std::vector<ChunkIndex> chunks_;
  std::vector<MetadataIndex> metadata_;
  uint64_t start_time_ = 0;
  uint64_t end_time_ = 0;

  // The open chunk: its records, and where each channel's messages begin.
  std::string records_;
  uint64_t chunk_start_ = 0;
  uint64_t chunk_end_ = 0;
  std::map<uint16_t, std::vector<std::pair<uint64_t, uint64_t>>> index_;
};

}  // namespace tactus::internal
