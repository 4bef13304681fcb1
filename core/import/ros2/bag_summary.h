// File: bag_summary.h
//
// BagSummary: what a bag of ROS 2 holds: its topics, how often they have
// messages, and the shape of the taxels in the first message of each.
//
//   TACTUS_ASSIGN_OR_RETURN(const BagSummary summary, SummarizeBag("run1"));
//   for (const BagTopicSummary& each : summary.topics) Print(each.topic.name);
//   Save(SkinToStartFrom(summary));
//
// Plain data; thread-safe.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/import/ros2/ros2_bag.h"

namespace tactus::internal {

struct BagTopicSummary {
  BagTopic topic;
  uint64_t messages = 0;
  int64_t first_ns = 0;
  int64_t last_ns = 0;
  // Messages per second; 0 for less than two messages.
  double rate_hz = 0;
  // The field of the taxels in the first message (ros2_taxels.h), their shape,
  // the numbers of each, and whether one is below zero. Empty if it has none;
  // then `unread` says why.
  std::string field;
  std::vector<size_t> shape;
  size_t axes = 1;
  bool has_negative = false;
  std::string unread;
};

struct BagSummary {
  // "mcap" or "sqlite3".
  std::string storage;
  std::vector<std::string> files;
  std::set<std::string> compressions;
  // Which files were cut off, and where.
  std::vector<std::string> cut_off;
  uint64_t messages = 0;
  double seconds = 0;
  // In the order of their names.
  std::vector<BagTopicSummary> topics;
};

// Reads all messages, and decodes the first one of each topic. IO, DATA_LOST or
// TRIAL_FILE_INVALID with the file.
absl::StatusOr<BagSummary> SummarizeBag(const std::string& path);

// A skin.json for the topic that is likeliest touch: arrays rather than images,
// then that with the most messages; with the topic of poses, if there is only
// one. Thresholds and baseline come from the first frames, pitches are to be
// corrected. Empty if no topic has taxels.
std::string SkinToStartFrom(const BagSummary& summary);

}  // namespace tactus::internal
