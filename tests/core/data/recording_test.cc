// Recordings: what is written is read, and what other programs see in the file.
#include <cstring>
#include <limits>

#include "core/base/errors.h"
#include "core/data/recording/recording_reader.h"
#include "core/data/recording/recording_writer.h"
#include "core/skin/layout_proto.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/data/foreign_decoder.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {
namespace {

using testing::HasSubstr;

constexpr int kRecordedFrames = 30;

v1::StreamConfig RecordedConfig(bool u16, bool poses) {
  v1::StreamConfig config;
  SkinLayout layout = *LayoutPreset("cody-forearm");
  layout.mask.assign(layout.taxels(), 1);
  layout.mask[2] = 0;
  *config.mutable_geometry() = LayoutToProto(layout);
  config.set_taxel_type(u16 ? v1::TAXEL_TYPE_UINT16 : v1::TAXEL_TYPE_FLOAT32);
  config.set_scale(u16 ? 0.01 : 1);
  config.set_with_poses(poses);
  return config;
}

v1::FrameBatch RecordedFrame(const v1::StreamConfig& config, int number) {
  v1::FrameBatch frame;
  frame.set_first_sequence(static_cast<uint64_t>(number) + 1);
  // 1 ms before 1970 is the first one.
  frame.set_first_capture_time_ns(int64_t{100'000'000} * number - 1'000'000);
  frame.set_frame_count(1);
  const bool u16 = config.taxel_type() == v1::TAXEL_TYPE_UINT16;
  frame.mutable_taxels()->assign(16 * 24 * (u16 ? 2 : 4), '\0');
  for (int i = 0; i < 4; ++i) {
    if (u16) {
      const auto value = static_cast<uint16_t>(100 * i);
      std::memcpy(frame.mutable_taxels()->data() + 2 * i, &value, 2);
    } else {
      const auto value = static_cast<float>(i);
      std::memcpy(frame.mutable_taxels()->data() + 4 * i, &value, 4);
    }
  }
  for (int i = 0; config.with_poses() && i < 7; ++i) {
    frame.add_poses(i == 6 ? 1 : 0.1 * number);
  }
  return frame;
}

std::vector<RecordingEvent> RecordedEvents(bool u16, bool poses) {
  std::vector<RecordingEvent> events;
  const v1::StreamConfig config = RecordedConfig(u16, poses);
  v1::StreamStarted started;
  started.set_bundle_sha256("abc");
  events.emplace_back(config);
  events.emplace_back(started);
  for (int i = 0; i < kRecordedFrames; ++i) {
    if (i % 15 == 0) events.emplace_back(RecordedTrial{{{"label", "HU"}}});
    events.emplace_back(RecordedFrame(config, i));
    v1::Answer answer;
    answer.set_sequence(static_cast<uint64_t>(i) + 1);
    answer.set_capture_time_ns(int64_t{100'000'000} * i - 1'000'000);
    answer.add_contacts()->add_probability(1.0 / (1 + i));
    events.emplace_back(answer);
    if (i % 15 == 14) events.emplace_back(v1::EndOfTrial());
  }
  return events;
}

// What the skin sent for a frame of RecordedFrame: a 3 x 5 skin of counts.
RawFrame RecordedRaw(const v1::FrameBatch& frame) {
  RawFrame raw;
  raw.batch.set_first_sequence(frame.first_sequence());
  raw.batch.set_first_capture_time_ns(frame.first_capture_time_ns());
  raw.batch.set_frame_count(1);
  raw.batch.mutable_taxels()->assign(3 * 5 * 2, 'r');
  return raw;
}

RecordedCalibration CalibrationOfRaw() {
  RecordedCalibration calibration{.raw = {}, .json = R"({"a": [1, "b"]})"};
  SkinLayout layout = *LayoutPreset("vitac-12x32");
  layout.rows = 3;
  layout.columns = 5;
  *calibration.raw.mutable_geometry() = LayoutToProto(layout);
  calibration.raw.set_taxel_type(v1::TAXEL_TYPE_UINT16);
  return calibration;
}

// The events of a calibrated skin. One raw frame is missing.
std::vector<RecordingEvent> CalibratedEvents() {
  std::vector<RecordingEvent> events;
  for (const RecordingEvent& event : RecordedEvents(false, true)) {
    if (std::holds_alternative<RecordedTrial>(event) && events.size() == 2) {
      events.emplace_back(CalibrationOfRaw());
    }
    events.push_back(event);
    const auto* frame = std::get_if<v1::FrameBatch>(&event);
    if (frame == nullptr || frame->first_sequence() == 4) continue;
    events.emplace_back(RecordedRaw(*frame));
  }
  return events;
}

// An event as text, to compare.
std::string EventText(const RecordingEvent& event) {
  if (const auto* raw = std::get_if<RawFrame>(&event)) {
    return "raw " + raw->batch.SerializeAsString();
  }
  if (const auto* calibration = std::get_if<RecordedCalibration>(&event)) {
    return absl::StrCat("calibration ", calibration->raw.SerializeAsString(),
                        calibration->json);
  }
  if (const auto* trial = std::get_if<RecordedTrial>(&event)) {
    std::string text = "trial";
    for (const auto& [key, value] : trial->values) {
      absl::StrAppend(&text, " ", key, "=", value);
    }
    return text;
  }
  return std::visit(
      [](const auto& message) -> std::string {
        if constexpr (std::is_base_of_v<google::protobuf::Message,
                                        std::decay_t<decltype(message)>>) {
          return message.GetTypeName() + " " + message.SerializeAsString();
        } else {
          return "";
        }
      },
      event);
}

void WriteRecording(const std::string& path,
                    const std::vector<RecordingEvent>& events) {
  std::filesystem::remove(path);
  const auto writer =
      *RecordingWriter::Create(path, {{"driver", "test"}}, {.sync = false});
  for (const RecordingEvent& event : events) {
    const absl::Status status = writer->Write(event);
    ASSERT_TRUE(status.ok()) << status;
  }
  ASSERT_TRUE(writer->Finish({{"lost_frames", "0"}}).ok());
}

struct ReadRecordingResult {
  std::vector<std::string> events;
  absl::Status status;
  std::string cut_off;
};

ReadRecordingResult ReadRecording(const std::string& path) {
  ReadRecordingResult result;
  const auto reader = RecordingReader::Open(path);
  result.status = reader.status();
  RecordingEvent event;
  while (result.status.ok()) {
    const auto more = (*reader)->Next(event);
    result.status = more.status();
    if (!more.ok()) break;
    if (!*more) {
      result.cut_off = (*reader)->CutOff();
      break;
    }
    result.events.push_back(EventText(event));
  }
  return result;
}

TEST(RecordingTest, ReturnsTheEventsThatWereWritten) {
  const ScratchDir folder;
  for (const bool u16 : {false, true}) {
    for (const bool poses : {false, true}) {
      const auto events = RecordedEvents(u16, poses);
      WriteRecording(folder / "a.mcap", events);
      const ReadRecordingResult read = ReadRecording(folder / "a.mcap");
      ASSERT_TRUE(read.status.ok()) << read.status;
      EXPECT_EQ(read.cut_off, "");
      ASSERT_EQ(read.events.size(), events.size());
      for (size_t i = 0; i < events.size(); ++i) {
        EXPECT_EQ(read.events[i], EventText(events[i])) << i;
      }
    }
  }
}

TEST(RecordingTest, ReturnsWhatACalibratedSkinSent) {
  const ScratchDir folder;
  const auto events = CalibratedEvents();
  WriteRecording(folder / "a.mcap", events);
  const ReadRecordingResult read = ReadRecording(folder / "a.mcap");
  ASSERT_TRUE(read.status.ok()) << read.status;
  ASSERT_EQ(read.events.size(), events.size());
  for (size_t i = 0; i < events.size(); ++i) {
    EXPECT_EQ(read.events[i], EventText(events[i])) << i;
  }
}

TEST(RecordingTest, NamesMistakesOfRawFrames) {
  const ScratchDir folder;
  const v1::StreamConfig config = RecordedConfig(false, false);
  const v1::FrameBatch frame = RecordedFrame(config, 5);
  const auto outcome = [&](const std::vector<RecordingEvent>& events) {
    WriteRecording(folder / "a", events);
    const absl::Status status = ReadRecording(folder / "a").status;
    EXPECT_TRUE(status.ok() || ReasonOf(status) == "TRIAL_FILE_INVALID");
    return std::string(status.message());
  };
  const RecordedCalibration calibration = CalibrationOfRaw();
  const RawFrame raw = RecordedRaw(frame);
  EXPECT_EQ(outcome({config, calibration, frame, raw}), "");
  RawFrame other = raw;
  other.batch.set_first_sequence(7);
  RawFrame late = raw;
  late.batch.set_first_capture_time_ns(7);
  RawFrame posed = raw;
  posed.batch.add_poses(1);
  const char kNotThis[] = "must be what the skin sent for the frame before it";
  EXPECT_THAT(outcome({config, calibration, frame, other}),
              HasSubstr(kNotThis));
  EXPECT_THAT(outcome({config, calibration, frame, late}), HasSubstr(kNotThis));
  EXPECT_THAT(outcome({config, calibration, frame, raw, raw}),
              HasSubstr(kNotThis));
  EXPECT_THAT(outcome({config, calibration, frame, posed}),
              HasSubstr("has 1 numbers of poses; it must have 0"));
  EXPECT_THAT(outcome({config, calibration, calibration, frame}),
              HasSubstr("is a second configuration"));
  const auto writer =
      *RecordingWriter::Create(folder / "b", {}, {.sync = false});
  ASSERT_TRUE(writer->Write(config).ok());
  ASSERT_TRUE(writer->Write(frame).ok());
  EXPECT_EQ(ReasonOf(writer->Write(raw)), "INVALID_CONFIG");
}

TEST(RecordingTest, TheSameEventsGiveTheSameBytes) {
  const ScratchDir folder;
  WriteRecording(folder / "a.mcap", RecordedEvents(true, true));
  WriteRecording(folder / "b.mcap", RecordedEvents(true, true));
  EXPECT_EQ(ReadBytes(folder / "a.mcap"), ReadBytes(folder / "b.mcap"));
}

TEST(RecordingTest, CutOffAtEachByteOfItsLastChunkItReturnsWhatIsBefore) {
  const ScratchDir folder;
  for (const bool calibrated : {false, true}) {
    WriteRecording(folder / "a.mcap", calibrated ? CalibratedEvents()
                                                 : RecordedEvents(true, true));
    const std::string bytes = ReadBytes(folder / "a.mcap");
    const ReadRecordingResult whole = ReadRecording(folder / "a.mcap");
    // The last chunk, by walking over the records.
    size_t begin = 0;
    size_t end = 0;
    for (size_t at = kMcapMagic.size(); at + kMcapPrefixBytes < bytes.size();) {
      McapCursor cursor(absl::string_view(bytes).substr(at));
      const auto opcode = cursor.Number<uint8_t>();
      const size_t next = at + kMcapPrefixBytes + cursor.Number<uint64_t>();
      if (opcode == 6) std::tie(begin, end) = std::pair(at, next);
      at = next;
    }
    WriteBytes(folder / "cut", bytes.substr(0, begin));
    const size_t before = ReadRecording(folder / "cut").events.size();
    EXPECT_GT(before, 30U);
    ASSERT_LT(before, whole.events.size());
    for (size_t size = begin; size <= end; ++size) {
      WriteBytes(folder / "cut", bytes.substr(0, size));
      const ReadRecordingResult cut = ReadRecording(folder / "cut");
      ASSERT_TRUE(cut.status.ok()) << size << ": " << cut.status;
      ASSERT_EQ(cut.events.size(), size < end ? before : whole.events.size())
          << size;
      ASSERT_TRUE(std::equal(cut.events.begin(), cut.events.end(),
                             whole.events.begin()));
      ASSERT_THAT(cut.cut_off,
                  HasSubstr(absl::StrCat("first ", size < end ? begin : end)));
    }
  }
}

TEST(RecordingTest, OtherProgramsDecodeAllMessages) {
  const ScratchDir folder;
  WriteRecording(folder / "a.mcap", RecordedEvents(true, true));
  const auto reader = *McapReader::Open(folder / "a.mcap");
  std::map<std::string, std::unique_ptr<ForeignDecoder>> decoders;
  std::map<std::string, std::vector<std::string>> texts;
  while (true) {
    const auto read = reader->Next();
    ASSERT_TRUE(read.ok()) << read.status();
    if (*read == McapRead::kEnd) break;
    if (*read != McapRead::kMessage) continue;
    const McapMessage& message = reader->message();
    EXPECT_EQ(message.schema->encoding, "protobuf");
    auto& decoder = decoders[message.channel->topic];
    if (!decoder) decoder = std::make_unique<ForeignDecoder>(*message.schema);
    texts[message.channel->topic].push_back(decoder->Text(message.data));
  }
  EXPECT_EQ(texts[kFrameTopic].size(), kRecordedFrames);
  EXPECT_EQ(texts[kConfigTopic].size(), 1U);
  EXPECT_THAT(texts[kResultTopic][1], HasSubstr("probability: 0.5"));
  ASSERT_EQ(texts[kImageTopic].size(), kRecordedFrames);
  // 1 N at an onset threshold of T is 255 / (1 + 4 T); taxel 2 is masked.
  const double t = LayoutPreset("cody-forearm")->onset_threshold;
  std::string pixels(16 * 24, '\0');
  pixels[1] = static_cast<char>(std::lround(255 / (1 + 4 * t)));
  pixels[3] = static_cast<char>(std::lround(255 * 3 / (3 + 4 * t)));
  google::protobuf::DescriptorPool pool;
  EXPECT_THAT(texts[kImageTopic][0],
              HasSubstr("timestamp { seconds: -1 nanos: 999000000 } width: 24 "
                        "height: 16 encoding: \"mono8\" step: 24 data: "));
  EXPECT_THAT(texts[kImageTopic][2], HasSubstr("nanos: 199000000"));
  FoxgloveImage image(*LayoutFromProto(RecordedConfig(true, true).geometry()));
  const v1::StreamConfig config = RecordedConfig(true, true);
  EXPECT_THAT(image.Encode(RecordedFrame(config, 0), config.taxel_type(),
                           config.scale()),
              HasSubstr(pixels));
  const v1::StreamConfig f32 = RecordedConfig(false, true);
  EXPECT_THAT(image.Encode(RecordedFrame(f32, 0), f32.taxel_type(), 1),
              HasSubstr(pixels));
}

TEST(RecordingTest, NamesEveryMistake) {
  const ScratchDir folder;
  const v1::StreamConfig config = RecordedConfig(true, false);
  const v1::FrameBatch frame = RecordedFrame(config, 5);
  // A recording of what `change` makes of a frame, after a good frame.
  const auto outcome = [&](auto change) {
    v1::FrameBatch bad = RecordedFrame(config, 6);
    change(bad);
    std::filesystem::remove(folder / "a");
    const auto file = *McapWriter::Create(folder / "a", {.sync = false});
    const auto add = [&](const char* topic, const char* schema) {
      return file->AddChannel(
          {file->AddSchema({schema, "protobuf", ""}), topic, "protobuf", {}});
    };
    const uint16_t configs = add(kConfigTopic, "tactus.v1.StreamConfig");
    const uint16_t frames = add(kFrameTopic, "tactus.v1.FrameBatch");
    EXPECT_TRUE(file->WriteMetadata({kRecordingMetadata,
                                     {{"format", kRecordingFormat},
                                      {"version", kRecordingVersion}}})
                    .ok());
    EXPECT_TRUE(file->Write(configs, 0, config.SerializeAsString()).ok());
    EXPECT_TRUE(file->Write(frames, 0, frame.SerializeAsString()).ok());
    EXPECT_TRUE(file->Write(frames, 0, bad.SerializeAsString()).ok());
    EXPECT_TRUE(file->Finish().ok());
    const absl::Status status = ReadRecording(folder / "a").status;
    EXPECT_TRUE(status.ok() || ReasonOf(status) == "TRIAL_FILE_INVALID");
    return std::string(status.message());
  };
  using Batch = v1::FrameBatch;
  EXPECT_EQ(outcome([](Batch&) {}), "");
  EXPECT_THAT(outcome([](Batch& b) { b.set_frame_count(2); }),
              HasSubstr("message 1 of /skin/frames must have one dense frame"));
  EXPECT_THAT(outcome([](Batch& b) { b.mutable_taxels()->pop_back(); }),
              HasSubstr("has 767 bytes of taxels; the skin has 768"));
  EXPECT_THAT(outcome([](Batch& b) { b.add_poses(1); }),
              HasSubstr("has 1 numbers of poses; it must have 0"));
  EXPECT_THAT(outcome([](Batch& b) { b.set_first_sequence(6); }),
              HasSubstr("has the sequence number 6"));
  EXPECT_THAT(outcome([](Batch& b) { b.set_first_capture_time_ns(1); }),
              HasSubstr("has the capture time 1 ns"));
}

TEST(RecordingTest, RefusesConfigurationsThatNoStreamHas) {
  const ScratchDir folder;
  const auto outcome = [&](auto change) {
    v1::StreamConfig config = RecordedConfig(true, false);
    change(config);
    WriteRecording(folder / "a",
                   {config, RecordedFrame(RecordedConfig(true, false), 0)});
    return std::string(ReadRecording(folder / "a").status.message());
  };
  using Config = v1::StreamConfig;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(outcome([](Config&) {}), "");
  for (const double rate : {1e300, -1.0, 1e-9, nan}) {
    EXPECT_THAT(outcome([=](Config& c) { c.set_sample_rate_hz(rate); }),
                HasSubstr("has the sample_rate_hz"));
  }
  for (const double scale :
       {-1.0, 0.0, nan, std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(outcome([=](Config& c) { c.set_scale(scale); }),
                HasSubstr("has the scale"));
  }
  EXPECT_THAT(outcome([](Config& c) { c.set_release_after_ms(60'001); }),
              HasSubstr("has the release_after_ms"));
}

TEST(RecordingTest, OtherMcapFilesAreNoRecordings) {
  const ScratchDir folder;
  {
    const auto file = *McapWriter::Create(folder / "a", {.sync = false});
    ASSERT_TRUE(file->Finish().ok());
  }
  EXPECT_THAT(std::string(ReadRecording(folder / "a").status.message()),
              HasSubstr("is an MCAP file, but no recording"));
  {
    const auto file = *McapWriter::Create(folder / "b", {.sync = false});
    ASSERT_TRUE(
        file->WriteMetadata({kRecordingMetadata,
                             {{"format", kRecordingFormat}, {"version", "2"}}})
            .ok());
    ASSERT_TRUE(file->Finish().ok());
  }
  EXPECT_THAT(std::string(ReadRecording(folder / "b").status.message()),
              HasSubstr("version \"2\"; it must be"));
}

TEST(RecordingTest, AFrameBeforeTheConfigurationIsRefused) {
  const ScratchDir folder;
  const auto writer =
      *RecordingWriter::Create(folder / "a.mcap", {}, {.sync = false});
  const v1::StreamConfig config = RecordedConfig(true, false);
  EXPECT_EQ(ReasonOf(writer->Write(RecordedFrame(config, 0))),
            "INVALID_CONFIG");
}

}  // namespace
}  // namespace tactus::internal
