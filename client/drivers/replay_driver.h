// File: replay_driver.h
//
// ReplayDriver: plays the trials of a trial file (docs/formats.md).
//
//   ReplayDriver driver("vitac.h5", {}, {.max_trials = 10});
//
// Each driver belongs to one thread. Drivers of different threads take turns
// at the HDF5 library.
#pragma once

#include <optional>
#include <string>

#include "client/drivers/trial_driver.h"
#include "core/data/trial_file.h"

namespace tactus::internal::client {

class ReplayDriver : public TrialDriver {
 public:
  struct Options {
    // 0: all trials of the file.
    size_t max_trials = 0;
    // For files whose layout class is no preset.
    std::optional<SkinLayout> layout = std::nullopt;
  };

  ReplayDriver(std::string path, const Shard& shard, const Options& options);
  ~ReplayDriver() override;

 protected:
  absl::StatusOr<SkinInfo> OnConfigure() override;
  absl::StatusOr<Trial> MakeTrial(size_t index) override;

 private:
  const std::string path_;
  const size_t max_trials_;
  std::optional<TrialFileReader> reader_;
};

}  // namespace tactus::internal::client
