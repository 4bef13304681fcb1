// File: small_trials.h
//
// Small labelled trials, and packs of them as they are uploaded.
//
//   const Trial trial = testing::SmallTrial(7);
//   const std::string pack = testing::SmallPack(0, 16);
//   pack + testing::Packed("no record");
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

#include "core/data/trial.h"
#include "core/data/trial_record.h"

namespace tactus::internal::testing {

// A contact of ideal signals: soft ones (even numbers) yield more slowly than
// hard ones. Models can be fitted to those of `frames` 60.
inline Trial SmallTrial(int number, int frames = 60) {
  const bool soft = number % 2 == 0;
  const int of_kind = number / 2;
  Trial trial;
  trial.id = "trial-" + std::to_string(number);
  trial.label = soft ? "SU" : "HU";
  trial.condition = of_kind % 2 == 0 ? "slow" : "fast";
  for (int f = 0; f < frames; ++f) {
    const double load = 1 - std::exp(-f / (soft ? 30.0 : 5.0));
    trial.time.push_back(0.01 * f);
    trial.signals.push_back({(1 + 0.1 * of_kind) * load + 0.01,
                             1e-4 * (1 + load),
                             1e-3 * (soft ? load : 0.1 * load)});
  }
  return trial;
}

// A record as a pack holds it: behind its length.
inline std::string Packed(const std::string& record) {
  const auto length = static_cast<uint32_t>(record.size());
  std::string bytes(sizeof length, '\0');
  std::memcpy(bytes.data(), &length, sizeof length);
  return bytes + record;
}
inline std::string Packed(const Trial& trial) {
  return Packed(ToRecord(trial).SerializeAsString());
}

// The trials with the numbers `first` to `end` - 1.
inline std::string SmallPack(int first = 0, int end = 16, int frames = 60) {
  std::string pack;
  for (int i = first; i < end; ++i) pack += Packed(SmallTrial(i, frames));
  return pack;
}

}  // namespace tactus::internal::testing
