// Any bytes as an MCAP file, read as such, as a recording, and imported. What
// is imported must be valid trials.
//
// Its corpus, tests/fuzz/corpus/mcap, begins with good files without checksums,
// so that changed bytes are not refused at once. With TACTUS_SEEDS=FOLDER the
// empty input writes them there.
#include "core/data/recording/recording_writer.h"
#include "core/files/mcap/mcap_reader.h"
#include "core/files/mcap/mcap_writer.h"
#include "core/import/import_recording.h"
#include "core/skin/layout_proto.h"
#include "tests/fuzz/damaged.h"
#include "tests/support/flat_layout.h"

namespace {

using namespace tactus::internal;
namespace v1 = tactus::v1;

// A skin of 2 x 2, with a contact in the middle. Without descriptors, which
// nobody reads.
std::string GoodRecording(bool u16, bool poses, bool light_touch) {
  const std::string path = fuzz::Folder() + "/good.mcap";
  std::filesystem::remove(path);
  {
    const auto file =
        *McapWriter::Create(path, {.chunk_ns = 100'000'000, .sync = false});
    const auto add = [&](const char* topic, const char* schema) {
      return file->AddChannel(
          {file->AddSchema({schema, "protobuf", ""}), topic, "protobuf", {}});
    };
    const uint16_t configs = add(kConfigTopic, "tactus.v1.StreamConfig");
    const uint16_t frames = add(kFrameTopic, "tactus.v1.FrameBatch");
    const uint16_t ends = add(kEndOfTrialTopic, "tactus.v1.EndOfTrial");
    const uint16_t results = add(kResultTopic, "tactus.v1.Answer");
    REQUIRE(file->WriteMetadata({kRecordingMetadata,
                                 {{"format", kRecordingFormat},
                                  {"version", kRecordingVersion}}})
                .ok());
    REQUIRE(
        file->WriteMetadata({kTrialMetadata, {{"id", "1"}, {"label", "HU"}}})
            .ok());
    v1::StreamConfig config;
    SkinLayout layout =
        testing::FlatLayout("s", 2, 2, TaxelUnit::kNewton, 10, 20);
    if (light_touch) {
      layout.light_touch = {.window_s = 0.05,
                            .rows = 1,
                            .columns = 1,
                            .contact_threshold = 1,
                            .onset_threshold = 2};
    }
    *config.mutable_geometry() = LayoutToProto(layout);
    config.set_taxel_type(u16 ? v1::TAXEL_TYPE_UINT16 : v1::TAXEL_TYPE_FLOAT32);
    config.set_with_poses(poses);
    config.set_release_after_ms(50);
    config.set_scale(u16 ? 0.9 : 1);
    config.set_sample_rate_hz(100);
    REQUIRE(file->Write(configs, 0, config.SerializeAsString()).ok());
    for (int i = 0; i < 60; ++i) {
      v1::FrameBatch frame;
      frame.set_frame_count(1);
      frame.set_first_sequence(static_cast<uint64_t>(i) + 1);
      frame.set_first_capture_time_ns(10'000'000L * i);
      const bool touch = i >= 40 && i < 50;
      for (int taxel = 0; taxel < 4; ++taxel) {
        const auto small = static_cast<uint16_t>(touch ? 30 + taxel : 0);
        const auto large = static_cast<float>(small);
        frame.mutable_taxels()->append(
            u16 ? reinterpret_cast<const char*>(&small)
                : reinterpret_cast<const char*>(&large),
            u16 ? 2 : 4);
      }
      for (int k = 0; poses && k < 7; ++k) frame.add_poses(k == 6 ? 1 : 0);
      const uint64_t time = 10'000'000UL * i;
      REQUIRE(file->Write(frames, time, frame.SerializeAsString()).ok());
      v1::Answer posterior;
      posterior.set_sequence(static_cast<uint64_t>(i) + 1);
      if (i % 20 == 0) {
        REQUIRE(file->Write(results, time, posterior.SerializeAsString()).ok());
      }
    }
    REQUIRE(file->Write(ends, 590'000'000, "").ok());
    REQUIRE(file->Finish().ok());
  }
  std::ifstream in(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  // 0 is no checksum.
  for (size_t at = kMcapMagic.size(); at + kMcapPrefixBytes < bytes.size();) {
    McapCursor cursor(absl::string_view(bytes).substr(at));
    const auto opcode = static_cast<McapOpcode>(cursor.Number<uint8_t>());
    const auto content = at + kMcapPrefixBytes;
    at = content + cursor.Number<uint64_t>();
    if (opcode == McapOpcode::kChunk) bytes.replace(content + 24, 4, 4, '\0');
    if (opcode == McapOpcode::kDataEnd) bytes.replace(content, 4, 4, '\0');
    if (opcode == McapOpcode::kFooter) bytes.replace(content + 16, 4, 4, '\0');
  }
  return bytes;
}

// Returns the number of trials.
absl::StatusOr<size_t> Import(const std::string& bytes) {
  const std::string path = fuzz::Write("a.mcap", bytes);
  // The container.
  const auto reader = McapReader::Open(path);
  fuzz::RequireReason(reader.status());
  while (reader.ok()) {
    const auto read = (*reader)->Next();
    fuzz::RequireReason(read.status());
    if (!read.ok() || *read == McapRead::kEnd) break;
    REQUIRE((*reader)->complete_bytes() <= bytes.size());
    if (*read != McapRead::kMessage) continue;
    REQUIRE((*reader)->message().channel != nullptr);
    REQUIRE((*reader)->message().data.size() <= bytes.size());
  }
  const auto imported = ImportRecording(path, {}, [](const Trial& trial) {
    REQUIRE(Validate(trial, "trial").ok());
    REQUIRE(!trial.label.empty());
    return absl::OkStatus();
  });
  fuzz::RequireReason(imported.status());
  return imported;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  if (size == 0) {
    // The good files are good.
    for (const int kind : {0, 1, 3, 6}) {
      const std::string good =
          GoodRecording((kind & 1) != 0, (kind & 2) != 0, (kind & 4) != 0);
      REQUIRE(*Import(good) == 1);
      if (const char* folder = std::getenv("TACTUS_SEEDS")) {
        std::ofstream(
            std::string(folder) + "/good" + std::to_string(kind) + ".mcap",
            std::ios::binary)
            << good;
      }
    }
    return 0;
  }
  Import(std::string(reinterpret_cast<const char*>(bytes), size))
      .status()
      .IgnoreError();
  return 0;
}
