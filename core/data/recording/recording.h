// File: recording.h
//
// What a recording of a stream holds: an MCAP file with the topics below
// (docs/formats.md, "Recordings"). RecordingWriter writes and RecordingReader
// reads its events in the order in which they happened.
//
//   RecordingEvent event = RecordedTrial{{{"label", "HU"}}};
//   if (const auto* trial = std::get_if<RecordedTrial>(&event)) {
//     trial->Text("label");
//   }
//
// Plain data; thread-safe.
#pragma once

#include <map>
#include <string>
#include <variant>

#include "absl/strings/string_view.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal {

// Topics. All messages but the calibration, which is JSON, are protobuf.
inline constexpr char kFrameTopic[] = "/skin/frames";
inline constexpr char kImageTopic[] = "/skin/image";
inline constexpr char kConfigTopic[] = "/skin/config";
inline constexpr char kEndOfTrialTopic[] = "/skin/end_of_trial";
inline constexpr char kStartedTopic[] = "/contact/started";
inline constexpr char kResultTopic[] = "/contact/result";
// Topics of a calibrated skin: what it sent, what that is like, and how loads
// were made of it.
inline constexpr char kRawTopic[] = "/skin/raw";
inline constexpr char kRawConfigTopic[] = "/skin/raw_config";
inline constexpr char kCalibrationTopic[] = "/skin/calibration";
// Names of metadata: of the whole recording, of a trial, and at the end.
inline constexpr char kRecordingMetadata[] = "recording";
inline constexpr char kTrialMetadata[] = "trial";
inline constexpr char kEndMetadata[] = "recording_end";
// In the metadata of the recording.
inline constexpr char kRecordingFormat[] = "tactus-recording";
inline constexpr char kRecordingVersion[] = "1";

using RecordingTexts = std::map<std::string, std::string>;

// Before the first frame of a trial: what is known about it, e.g. its label.
struct RecordedTrial {
  RecordingTexts values;

  // Empty if there is none.
  std::string Text(const std::string& key) const {
    const auto found = values.find(key);
    return found == values.end() ? "" : found->second;
  }
};

// Written once for a calibrated skin, before the first frame.
struct RecordedCalibration {
  // What the skin sends: geometry, type and scale of its numbers, rate.
  v1::StreamConfig raw;
  // How the loads are made of that
  // (client/drivers/calibration/calibration_in_use.h).
  std::string json;
};

// What the skin sent for the frame before it: one dense frame without poses,
// with that frame's sequence number and capture time.
struct RawFrame {
  v1::FrameBatch batch;
};

// The stream's configuration, once; what the server answered to it, once;
// trials; frames as the driver read them, one dense frame each; of a calibrated
// skin, its calibration and what it sent; ends of trials; and results.
using RecordingEvent =
    std::variant<v1::StreamConfig, v1::StreamStarted, RecordedTrial,
                 v1::FrameBatch, v1::EndOfTrial, v1::Answer,
                 RecordedCalibration, RawFrame>;

}  // namespace tactus::internal
