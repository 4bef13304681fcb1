// File: dataset_skin.h
//
// DatasetSkin: the skin and the sample rate that the trials of a dataset share.
// A model is trained on one skin and one rate; what differs is refused by then.
//
//   DatasetSkin skin(blobs, "datasets/arm", held);
//   TACTUS_RETURN_IF_ERROR(skin.Check(trial));
//
// Uses `blobs` and `held` in the constructor only. Not thread-safe.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "core/data/trial.h"
#include "core/skin/layout.h"
#include "core/store/blob_store.h"
#include "tactus/v1/training.pb.h"

namespace tactus::internal::server {

class DatasetSkin {
 public:
  // Takes the skin of the first of the trials that can be read.
  DatasetSkin(const BlobStore& blobs, const std::string& dataset,
              const std::vector<v1::TrialInfo>& held);

  // INVALID_TRIAL, which names both skins, unless the trial has the skin
  // (SkinDifference) and the rate of the dataset. The first trial of an empty
  // dataset sets them.
  absl::Status Check(const Trial& trial);

 private:
  struct Shared {
    // The trial that has set it.
    std::string trial;
    // Nothing for ideal signals.
    std::optional<SkinLayout> layout;
    double sample_rate_hz = 0;
  };

  static Shared SharedOf(const Trial& trial, const std::string& name);
  // "cody-forearm" (16x24 taxels, 100 frames per second).
  static std::string Text(const Shared& shared);

  std::optional<Shared> shared_;
};

}  // namespace tactus::internal::server
