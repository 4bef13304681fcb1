// Prints what our reader finds in an MCAP file as one JSON object, to be
// compared with what npm's @mcap/core finds (mcap_peer.mjs).
//
//   mcap_content FILE.mcap
//
// With --cut, prints the number of messages only; with --last-chunk, the first
// byte of the last chunk and the byte after it.
#include <cstdio>
#include <iostream>

#include "absl/strings/str_cat.h"
#include "core/files/file_bytes.h"
#include "core/files/mcap/mcap_reader.h"
#include "nlohmann/json.hpp"

namespace tactus::internal {
namespace {

void PrintLastChunk(const std::string& bytes) {
  size_t begin = 0;
  size_t end = 0;
  for (size_t at = kMcapMagic.size(); at + kMcapPrefixBytes < bytes.size();) {
    McapCursor cursor(absl::string_view(bytes).substr(at));
    const auto opcode = static_cast<McapOpcode>(cursor.Number<uint8_t>());
    const size_t next = at + kMcapPrefixBytes + cursor.Number<uint64_t>();
    if (opcode == McapOpcode::kChunk) {
      begin = at;
      end = next;
    }
    at = next;
  }
  std::cout << begin << " " << end << "\n";
}

int Main(const std::string& path, const std::string& mode) {
  if (mode == "--last-chunk") {
    PrintLastChunk(*ReadFileBytes(path, size_t{1} << 30));
    return 0;
  }
  const auto reader = McapReader::Open(path);
  absl::Status status = reader.status();
  nlohmann::json metadata = nlohmann::json::array();
  nlohmann::json topics = nlohmann::json::object();
  size_t messages = 0;
  while (status.ok()) {
    const auto read = (*reader)->Next();
    status = read.status();
    if (!read.ok() || *read == McapRead::kEnd) break;
    if (*read == McapRead::kMetadata) {
      metadata.push_back(
          {(*reader)->metadata().name, (*reader)->metadata().values});
      continue;
    }
    const McapMessage& message = (*reader)->message();
    ++messages;
    auto& topic = topics[message.channel->topic];
    if (topic.is_null()) topic = {{"bytes", 0}, {"count", 0}, {"crc", 0U}};
    topic["count"] = topic["count"].get<size_t>() + 1;
    topic["bytes"] = topic["bytes"].get<size_t>() + message.data.size();
    // A checksum that depends on the order of the messages of a topic.
    topic["crc"] = McapCrc(
        0, absl::StrCat(topic["crc"].get<uint32_t>(), " ", message.sequence,
                        " ", message.log_time, " ", message.data));
  }
  if (!status.ok()) {
    std::cerr << path << ": " << status << "\n";
    return 1;
  }
  if (mode == "--cut") {
    std::cout << messages << "\n";
    return 0;
  }
  std::cout
      << nlohmann::json({{"metadata", metadata}, {"topics", topics}}).dump()
      << "\n";
  return (*reader)->complete() ? 0 : 1;
}

}  // namespace
}  // namespace tactus::internal

int main(int argc, char** argv) {
  return argc < 2 ? 2
                  : tactus::internal::Main(argv[1], argc > 2 ? argv[2] : "");
}
