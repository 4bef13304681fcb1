// File: replay_driver.h
//
// ReplayDriver: plays the trials of a trial file (docs/formats.md).
//
//   ReplayDriver driver("vitac.h5", {});
//
// One thread a driver; drivers of different threads take turns at the HDF5
// library.
#pragma once

#include <optional>
#include <string>

#include "client/drivers/trial_driver.h"
#include "core/data/trial_file.h"

namespace tactus::client {

class ReplayDriver : public TrialDriver {
 public:
  // Plays at most `max_trials` trials of the file; 0 for all.
  ReplayDriver(std::string path, const Shard& shard, size_t max_trials = 0);
  ~ReplayDriver() override;

 protected:
  absl::StatusOr<SkinInfo> OnConfigure() override;
  absl::StatusOr<Trial> MakeTrial(size_t index) override;

 private:
  const std::string path_;
  const size_t max_trials_;
  std::optional<TrialFileReader> reader_;
};

}  // namespace tactus::client
