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

namespace tactus {

// Topics. All messages are protobuf.
inline constexpr char kFrameTopic[] = "/skin/frames";
inline constexpr char kImageTopic[] = "/skin/image";
inline constexpr char kConfigTopic[] = "/skin/config";
inline constexpr char kEndOfTrialTopic[] = "/skin/end_of_trial";
inline constexpr char kStartedTopic[] = "/contact/started";
inline constexpr char kResultTopic[] = "/contact/result";
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

// The stream's configuration, once; what the server answered to it, once;
// trials; frames as the driver read them, one dense frame each; ends of trials;
// and results.
using RecordingEvent =
    std::variant<v1::StreamConfig, v1::StreamStarted, RecordedTrial,
                 v1::FrameBatch, v1::EndOfTrial, v1::Posterior>;

}  // namespace tactus
