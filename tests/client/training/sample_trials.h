// File: sample_trials.h
//
// Small trials to upload, and what tests do with them and with errors.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "client/training/trial_uploader.h"
#include "core/base/random.h"
#include "core/data/trial_pack.h"
#include "server/rpc/status.h"
#include "tests/support/small_trials.h"

namespace tactus::internal::client::testing {

// Trials of different lengths, all random, with ids in rising order.
inline std::vector<Trial> SampleTrials(int count) {
  Random random(17);
  std::vector<Trial> trials(count);
  for (int i = 0; i < count; ++i) {
    trials[i].id = std::to_string(100 + i);
    trials[i].label = i % 2 == 0 ? "HU" : "SM";
    for (int t = 0; t <= 3 * i; ++t) {
      trials[i].time.push_back(0.01 * t);
      trials[i].signals.push_back(
          {random.Uniform(), random.Uniform(), random.Uniform()});
    }
  }
  return trials;
}

// The pack, put together without the uploader.
inline std::string PackOf(const std::vector<Trial>& trials) {
  std::string pack;
  for (const Trial& trial : trials)
    pack += tactus::internal::testing::Packed(trial);
  return pack;
}

// Returns one trial after another.
inline NextTrial From(const std::vector<Trial>& trials) {
  return [&trials,
          next = size_t{0}]() mutable -> absl::StatusOr<std::optional<Trial>> {
    if (next == trials.size()) return std::nullopt;
    return trials[next++];
  };
}

// An error as a server puts it into a message.
inline v1::Status ToProto(const absl::Status& error) {
  v1::Status status;
  status.ParseFromString(server::ToGrpcStatus(error).error_details());
  return status;
}

// Does not wait.
inline RetryOptions NoWaits() {
  return {.limit = 8, .sleep = [](std::chrono::milliseconds) {}};
}

}  // namespace tactus::internal::client::testing
