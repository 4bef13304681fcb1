// The MCAP container: what is written is read, whatever happens to the file.
// tests/core/files/check_mcap.sh reads the same files with npm's @mcap/core.
#include <lz4frame.h>
#include <zstd.h>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/files/mcap/mcap_reader.h"
#include "core/files/mcap/mcap_writer.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr int kMcapMessages = 60;

// What a reader sees, and how it ends.
struct McapContent {
  std::vector<std::string> messages;
  std::vector<std::string> metadata;
  absl::Status status;
  bool complete = false;
  uint64_t complete_bytes = 0;
};

McapContent ReadMcap(const std::string& path) {
  McapContent content;
  const auto reader = McapReader::Open(path);
  content.status = reader.status();
  while (content.status.ok()) {
    const auto read = (*reader)->Next();
    content.status = read.status();
    if (!read.ok()) break;
    if (*read == McapRead::kEnd) {
      content.complete = (*reader)->complete();
      content.complete_bytes = (*reader)->complete_bytes();
      break;
    }
    if (*read == McapRead::kMetadata) {
      const McapMetadata& metadata = (*reader)->metadata();
      std::string text = metadata.name;
      for (const auto& [key, value] : metadata.values) {
        absl::StrAppend(&text, " ", key, "=", value);
      }
      content.metadata.push_back(text);
      continue;
    }
    const McapMessage& message = (*reader)->message();
    content.messages.push_back(
        absl::StrCat(message.channel->topic, " ", message.sequence, " ",
                     message.log_time, " ", std::string(message.data)));
  }
  return content;
}

// Two topics, two metadata records, chunks of ten messages.
std::string WriteMcap(const std::string& path, bool finish) {
  const auto writer = *McapWriter::Create(
      path, {.library = "test", .chunk_ns = 100, .sync = false});
  const uint16_t schema =
      writer->AddSchema({"Point", "jsonschema", R"({"type": "object"})"});
  const uint16_t a = writer->AddChannel({schema, "/a", "json", {{"k", "v"}}});
  const uint16_t b = writer->AddChannel({0, "/b", "json", {}});
  EXPECT_TRUE(writer->WriteMetadata({"trial", {{"label", "HU"}}}).ok());
  for (int i = 0; i < kMcapMessages; ++i) {
    const std::string text = absl::StrCat("{\"x\":", i, "}");
    EXPECT_TRUE(writer->Write(i % 3 == 0 ? b : a, 1000 + 10 * i, text).ok());
  }
  EXPECT_TRUE(writer->WriteMetadata({"end", {}}).ok());
  if (finish) {
    EXPECT_TRUE(writer->Finish().ok());
  }
  return ReadBytes(path);
}

// Where the chunks of a file begin and end.
std::vector<std::pair<size_t, size_t>> McapChunks(const std::string& bytes) {
  std::vector<std::pair<size_t, size_t>> chunks;
  size_t at = kMcapMagic.size();
  while (at + kMcapPrefixBytes < bytes.size()) {
    McapCursor cursor(absl::string_view(bytes).substr(at));
    const auto opcode = cursor.Number<uint8_t>();
    const auto end = at + kMcapPrefixBytes + cursor.Number<uint64_t>();
    if (opcode == 6) chunks.emplace_back(at, end);
    at = end;
  }
  return chunks;
}

TEST(McapTest, ReturnsWhatWasWritten) {
  const ScratchDir folder;
  WriteMcap(folder / "a.mcap", true);
  const McapContent content = ReadMcap(folder / "a.mcap");
  ASSERT_TRUE(content.status.ok()) << content.status;
  EXPECT_TRUE(content.complete);
  ASSERT_EQ(content.messages.size(), kMcapMessages);
  EXPECT_EQ(content.messages[0], "/b 0 1000 {\"x\":0}");
  EXPECT_EQ(content.messages[59], "/a 39 1590 {\"x\":59}");
  EXPECT_THAT(content.metadata, ElementsAre("trial label=HU", "end"));
}

TEST(McapTest, ClosesChunksByTimeBytesAndFlush) {
  const ScratchDir folder;
  EXPECT_EQ(McapChunks(WriteMcap(folder / "time", true)).size(), 6U);
  const auto writer = *McapWriter::Create(
      folder / "bytes", {.chunk_bytes = 200, .chunk_ns = 1000, .sync = true});
  const uint16_t topic = writer->AddChannel({0, "/a", "json", {}});
  const uint64_t before = writer->bytes();
  ASSERT_TRUE(writer->Write(topic, 1, std::string(100, 'x')).ok());
  EXPECT_EQ(writer->bytes(), before);
  ASSERT_TRUE(writer->Flush().ok());
  EXPECT_GT(writer->bytes(), before + 100);
  for (int i = 0; i < 4; ++i) {
    ASSERT_TRUE(writer->Write(topic, 1, std::string(100, 'x')).ok());
  }
  ASSERT_TRUE(writer->Finish().ok());
  EXPECT_EQ(McapChunks(ReadBytes(folder / "bytes")).size(), 3U);
  EXPECT_FALSE(writer->Write(topic, 1, "x").ok());
}

TEST(McapTest, NeverOverwritesAFile) {
  const ScratchDir folder;
  WriteBytes(folder / "a", "precious");
  const auto writer = McapWriter::Create(folder / "a", {});
  EXPECT_EQ(ReasonOf(writer.status()), "IO");
  EXPECT_THAT(std::string(writer.status().message()), HasSubstr("exists"));
  EXPECT_EQ(ReadBytes(folder / "a"), "precious");
}

TEST(McapTest, WithoutFinishAllClosedChunksAreRead) {
  const ScratchDir folder;
  WriteMcap(folder / "a", false);
  const McapContent content = ReadMcap(folder / "a");
  EXPECT_TRUE(content.status.ok()) << content.status;
  EXPECT_FALSE(content.complete);
  EXPECT_EQ(content.messages.size(), kMcapMessages);
}

// The last chunk is cut at each of its bytes, and the whole file too: what is
// left is a prefix of the messages, whole chunks, and no error.
TEST(McapTest, OpensUpToTheLastCompleteChunk) {
  const ScratchDir folder;
  const std::string bytes = WriteMcap(folder / "a", true);
  const McapContent whole = ReadMcap(folder / "a");
  const auto chunks = McapChunks(bytes);
  for (size_t size = 0; size < bytes.size(); ++size) {
    WriteBytes(folder / "cut", bytes.substr(0, size));
    const McapContent cut = ReadMcap(folder / "cut");
    ASSERT_TRUE(cut.status.ok()) << size << ": " << cut.status;
    ASSERT_FALSE(cut.complete) << size;
    ASSERT_LE(cut.complete_bytes, size);
    const auto in_file = [size](const auto& chunk) {
      return chunk.second <= size;
    };
    const auto complete = std::count_if(chunks.begin(), chunks.end(), in_file);
    ASSERT_EQ(cut.messages.size(), complete * 10) << size;
    ASSERT_TRUE(std::equal(cut.messages.begin(), cut.messages.end(),
                           whole.messages.begin()));
  }
}

TEST(McapTest, ADamagedSummaryKeepsNoMessageBack) {
  const ScratchDir folder;
  const auto writer = *McapWriter::Create(folder / "a", {.sync = false});
  const uint16_t schema =
      writer->AddSchema({"Point", "jsonschema", std::string(2000, ' ')});
  const uint16_t topic = writer->AddChannel({schema, "/a", "json", {}});
  ASSERT_TRUE(writer->Write(topic, 1, "{}").ok());
  ASSERT_TRUE(writer->Finish().ok());
  std::string bytes = ReadBytes(folder / "a");
  // The schema becomes a footer that is too long.
  const size_t schema_at = bytes.rfind("Point") - 2 - 4 - kMcapPrefixBytes;
  ASSERT_EQ(bytes[schema_at], 3);
  bytes[schema_at] = 2;
  WriteBytes(folder / "b", bytes);
  const McapContent content = ReadMcap(folder / "b");
  EXPECT_TRUE(content.status.ok()) << content.status;
  EXPECT_EQ(content.messages.size(), 1U);
  EXPECT_FALSE(content.complete);
  EXPECT_EQ(content.complete_bytes, schema_at);
}

TEST(McapTest, TakesZerosForTheEnd) {
  const ScratchDir folder;
  const std::string bytes = WriteMcap(folder / "a", true);
  const size_t end = McapChunks(bytes)[3].second;
  WriteBytes(folder / "b", bytes.substr(0, end) + std::string(4096, '\0'));
  const McapContent content = ReadMcap(folder / "b");
  EXPECT_TRUE(content.status.ok()) << content.status;
  EXPECT_FALSE(content.complete);
  EXPECT_EQ(content.complete_bytes, end);
  EXPECT_EQ(content.messages.size(), 40U);
}

// Each byte of the file is changed. Lengths that reach beyond the file, and a
// damaged summary, look as if the file had been cut off.
TEST(McapTest, FindsEveryChangedByte) {
  const ScratchDir folder;
  const std::string bytes = WriteMcap(folder / "a", true);
  const McapContent whole = ReadMcap(folder / "a");
  const auto chunks = McapChunks(bytes);
  // The end of the data, a record of 13 bytes, is followed by the first schema
  // once more.
  const size_t data_end = bytes.rfind("Point") - 2 - 4 - kMcapPrefixBytes;
  Random random(1);
  int checksums = 0;
  for (size_t at = kMcapMagic.size(); at < bytes.size(); ++at) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ (1 << random.Index(8)));
    WriteBytes(folder / "b", changed);
    const McapContent content = ReadMcap(folder / "b");
    EXPECT_TRUE(!content.status.ok() || !content.complete) << at;
    // The summary is not needed.
    if (at >= data_end) {
      EXPECT_EQ(content.messages, whole.messages) << at << content.status;
      EXPECT_EQ(content.complete_bytes, data_end);
    }
    checksums += ReasonOf(content.status) == "DATA_LOST";
    // Nothing of a damaged chunk is returned. The chunk's times, which nothing
    // depends on, are part of the checksum of the data only.
    for (const auto& [begin, end] : chunks) {
      if (at < begin + kMcapPrefixBytes + 16 || at >= end) continue;
      EXPECT_THAT(std::string(content.status.message()),
                  HasSubstr(absl::StrCat("byte ", begin)))
          << at;
      EXPECT_TRUE(std::equal(content.messages.begin(), content.messages.end(),
                             whole.messages.begin()));
    }
  }
  EXPECT_GT(checksums, 1000);
}

std::string McapChunk(absl::string_view compression, uint64_t size,
                      absl::string_view records) {
  std::string content;
  PutMcapNumber(uint64_t{0}, &content);
  PutMcapNumber(uint64_t{0}, &content);
  PutMcapNumber(size, &content);
  PutMcapNumber(uint32_t{0}, &content);
  PutMcapText(compression, &content);
  PutMcapNumber(static_cast<uint64_t>(records.size()), &content);
  return absl::StrCat(content, records);
}

std::string McapRecord(McapOpcode opcode, absl::string_view content) {
  std::string record;
  PutMcapNumber(static_cast<uint8_t>(opcode), &record);
  PutMcapNumber(static_cast<uint64_t>(content.size()), &record);
  return absl::StrCat(record, content);
}

// Frames of the compressors themselves; a chunk that states another size than
// they hold is refused, and so is one that is cut.
TEST(McapTest, ReadsCompressedChunks) {
  const ScratchDir folder;
  std::string channel;
  PutMcapNumber(uint16_t{1}, &channel);
  PutMcapNumber(uint16_t{0}, &channel);
  for (const char* text : {"/a", "cdr", ""}) PutMcapText(text, &channel);
  std::string message;
  PutMcapNumber(uint16_t{1}, &message);
  PutMcapNumber(uint32_t{3}, &message);
  PutMcapNumber(uint64_t{40}, &message);
  PutMcapNumber(uint64_t{40}, &message);
  message += std::string(5000, 'x');
  const std::string records = McapRecord(McapOpcode::kChannel, channel) +
                              McapRecord(McapOpcode::kMessage, message);
  std::string zstd(ZSTD_compressBound(records.size()), '\0');
  zstd.resize(ZSTD_compress(zstd.data(), zstd.size(), records.data(),
                            records.size(), 1));
  std::string lz4(LZ4F_compressFrameBound(records.size(), nullptr), '\0');
  lz4.resize(LZ4F_compressFrame(lz4.data(), lz4.size(), records.data(),
                                records.size(), nullptr));
  std::string header;
  PutMcapText("ros2", &header);
  PutMcapText("", &header);
  const std::string begin =
      std::string(kMcapMagic) + McapRecord(McapOpcode::kHeader, header);
  for (const bool is_zstd : {true, false}) {
    const std::string name = is_zstd ? "zstd" : "lz4";
    const std::string& bytes = is_zstd ? zstd : lz4;
    ASSERT_LT(bytes.size(), 1000U);
    const auto file = [&](uint64_t size, const std::string& packed) {
      WriteBytes(folder / "a",
                 begin + McapRecord(McapOpcode::kChunk,
                                    McapChunk(name, size, packed)));
      return ReadMcap(folder / "a");
    };
    const McapContent content = file(records.size(), bytes);
    EXPECT_TRUE(content.status.ok()) << content.status;
    EXPECT_THAT(content.messages,
                ElementsAre("/a 3 40 " + std::string(5000, 'x')));
    EXPECT_FALSE(file(records.size() - 1, bytes).status.ok());
    EXPECT_FALSE(file(records.size() + 1, bytes).status.ok());
    for (size_t size = 0; size < bytes.size(); ++size) {
      EXPECT_EQ(ReasonOf(file(records.size(), bytes.substr(0, size)).status),
                "TRIAL_FILE_INVALID")
          << name << " " << size;
    }
  }
  const auto reader = *McapReader::Open(folder / "a");
  EXPECT_FALSE(reader->Next().ok());
  EXPECT_EQ(reader->profile(), "ros2");
}

TEST(McapTest, NamesEveryMistake) {
  const ScratchDir folder;
  std::string header;
  PutMcapText("", &header);
  PutMcapText("", &header);
  const std::string begin =
      std::string(kMcapMagic) + McapRecord(McapOpcode::kHeader, header);
  const std::string at = absl::StrCat("byte ", begin.size(), " ");
  std::string message(22, '\1');
  std::string channel(12, '\1');
  std::string long_chunk = McapRecord(McapOpcode::kMessage, message);
  long_chunk[1] = 100;
  const std::pair<std::string, std::string> cases[] = {
      {"PK\3\4", "is not an MCAP file"},
      {std::string(kMcapMagic) + McapRecord(McapOpcode::kMessage, message),
       "must be a header"},
      {begin + McapRecord(McapOpcode::kChunk, McapChunk("zstd", 5, "abcde")),
       at + "is a chunk that is compressed with zstd, and it is damaged or "
            "not the stated 5 bytes"},
      {begin + McapRecord(McapOpcode::kChunk, McapChunk("brotli", 5, "abcde")),
       at + "is a chunk that is compressed with \"brotli\"; zstd and lz4 are "
            "read"},
      {begin + McapRecord(McapOpcode::kChunk,
                          McapChunk("lz4", uint64_t{1} << 40, "abcde")),
       at + "is a chunk of 1099511627776 bytes; the limit is 67108864"},
      {begin + McapRecord(McapOpcode::kChunk, McapChunk("", 6, "abcde")),
       at + "is a chunk that states 6 bytes of records but has 5"},
      {begin + McapRecord(McapOpcode::kChunk, "abc"),
       at + "is a chunk that ends too early"},
      {begin + McapRecord(McapOpcode::kChunk,
                          McapChunk("", long_chunk.size(), long_chunk)),
       at + "is a chunk whose last record is too long"},
      {begin + McapRecord(McapOpcode::kMessage, message),
       at + "is a message of the unknown channel 257"},
      {begin + McapRecord(McapOpcode::kMessage, "abc"),
       at + "is a message that ends too early"},
      {begin + McapRecord(McapOpcode::kSchema, "abc"),
       at + "is a schema without its parts"},
      {begin + McapRecord(McapOpcode::kChannel, channel),
       at + "is a channel without its parts"},
      {begin + McapRecord(McapOpcode::kMetadata, "abc"),
       at + "is metadata without its parts"},
      {begin + McapRecord(McapOpcode::kFooter, std::string(20, '\0')),
       at + "must not be a footer"},
      {begin + McapRecord(McapOpcode::kDataEnd, "abc"),
       at + "is an end of data without its parts"},
      {begin + McapRecord(McapOpcode::kMetadata, std::string(2 << 20, 'x')),
       at + "has 2097152 bytes; the limit is 1048576"},
  };
  for (const auto& [bytes, text] : cases) {
    WriteBytes(folder / "a", bytes);
    const McapContent content = ReadMcap(folder / "a");
    EXPECT_EQ(ReasonOf(content.status), "TRIAL_FILE_INVALID") << text;
    EXPECT_THAT(std::string(content.status.message()), HasSubstr(text));
  }
}

TEST(McapTest, ChannelsAndSchemasMayBeRepeatedButNotChanged) {
  const ScratchDir folder;
  const std::string bytes = WriteMcap(folder / "a", false);
  // The first schema and channel once more, with another name.
  const size_t schema = bytes.find("Point") - 2 - 4 - kMcapPrefixBytes;
  const size_t second = bytes.find("/b") - 4 - 4 - kMcapPrefixBytes;
  const std::string repeated = bytes.substr(schema, second - schema);
  WriteBytes(folder / "b", bytes + repeated);
  EXPECT_TRUE(ReadMcap(folder / "b").status.ok());
  for (const char* name : {"Point", "/a"}) {
    std::string changed = repeated;
    ++changed[changed.find(name)];
    WriteBytes(folder / "b", bytes + changed);
    const McapContent content = ReadMcap(folder / "b");
    EXPECT_THAT(std::string(content.status.message()), HasSubstr("changes "));
  }
}

}  // namespace
}  // namespace tactus::internal
