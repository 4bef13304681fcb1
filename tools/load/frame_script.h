// File: frame_script.h
//
// FrameScript: the messages of frames that all robots of a load test play,
// each from a different place: simulated contacts of all classes in turn, some
// untouched skin before each.
//
//   TACTUS_ASSIGN_OR_RETURN(auto script, FrameScript::Create({.seed = 1}));
//   script.AppendMessage(position, first_sequence, &bytes);
//
// Taxels are encoded once and shared; only the numbers are written for each
// message, so that a generator costs little beside the server it measures.
// Immutable; thread-safe.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/stream/skin_frame.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal::client {

class FrameScript {
 public:
  struct Options {
    uint64_t seed = 1;
    uint32_t frames_per_message = 1;
    // List touched taxels only.
    bool sparse = false;
    // Before each contact; at most 10.
    double untouched_seconds = 1;
    // If set, contacts are such a fraction of all frames, 0 or 0.02 to 1:
    // untouched frames are left out or repeated. A robot's contact ends only
    // after a pause, so above about 0.7 contacts follow one another as one.
    std::optional<double> touched_fraction = {};
    // Simulated contacts; four are one of each class.
    size_t contacts = 8;
  };

  // INVALID_CONFIG for options out of range, or if a message would exceed what
  // a server takes.
  static absl::StatusOr<FrameScript> Create(const Options& options);

  // For streams of this script: one answer a message, if its cadence stays.
  const v1::StreamConfig& config() const { return config_; }
  // Messages at its begin that hold nothing but untouched frames.
  size_t untouched_messages() const { return untouched_messages_; }
  // Fraction of its frames that contacts begin, hold or leave.
  double touched_fraction() const { return touched_fraction_; }
  // Messages until it begins again.
  size_t size() const { return bodies_.size(); }
  // Appends message `position` modulo size(), numbered from `first_sequence`
  // and captured at the script's rate: a ClassifyContactRequest.
  void AppendMessage(size_t position, uint64_t first_sequence,
                     std::string* out) const;

 private:
  FrameScript() = default;

  // Encodes `frames` one after another.
  absl::Status Encode(const SkinInfo& info, const Options& options,
                      const std::vector<const SkinFrame*>& frames);

  v1::StreamConfig config_;
  int64_t frame_period_ns_ = 0;
  size_t untouched_messages_ = 0;
  double touched_fraction_ = 0;
  // FrameBatches without first_sequence and first_capture_time_ns.
  std::vector<std::string> bodies_;
};

}  // namespace tactus::internal::client
