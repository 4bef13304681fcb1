// File: trial_merge.h
//
// What becomes of uploaded trials beside those that a dataset holds. Trials are
// recordings: the same frames are the same recording, whatever its id.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const TrialMerge merge,
//       MergeTrials(held, uploaded, {.replace_labels = true}));
//
// Thread-safe: a free function without state.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "tactus/v1/training.pb.h"

namespace tactus::internal::server {

struct MergeOptions {
  // CreateUploadRequest.replace_labels.
  bool replace_labels = false;
};

struct TrialMerge {
  // Held trials that stay.
  std::vector<v1::TrialInfo> kept;
  // Indices of the uploaded trials that are added.
  std::vector<size_t> added;
  // The new id of those whose id names another recording.
  std::map<size_t, std::string> new_ids;
  // How many were left out.
  uint32_t duplicates = 0;
  // How many recordings have another label than before.
  uint32_t relabelled = 0;
  // The first limits::kMaxTrialNotes.
  std::vector<v1::TrialNote> notes;
};

// As FinishUpload of proto/tactus/v1/training.proto says. INVALID_TRIAL with
// both labels if the same frames have two and none may be replaced.
absl::StatusOr<TrialMerge> MergeTrials(
    const std::vector<v1::TrialInfo>& held,
    const std::vector<v1::TrialInfo>& uploaded, const MergeOptions& options);

}  // namespace tactus::internal::server
