// File: fit_run.h
//
// FitRun: what all parts of one fit share.
//
//   TACTUS_RETURN_IF_ERROR(run.GoOn());
//   run.Report({.phase = "fit HMMs", .part = "hmm/SU/0", .iteration = 1});
//
// Refers to its members' owners, which must outlive it. Thread-safe.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "core/base/errors.h"
#include "core/base/ranks.h"
#include "core/questions/question.h"
#include "core/train/fit_journal.h"
#include "core/train/fit_options.h"
#include "core/train/saved_parts.h"

namespace tactus::internal {

struct FitRun {
  const FitOptions& options;
  const std::vector<std::string>& class_names;
  const std::vector<Question>& questions;
  FitJournal* journal;  // may be null
  const SavedParts& saved;
  Ranks& ranks;

  // CANCELLED if the journal says so.
  absl::Status GoOn() const {
    return journal != nullptr && journal->Cancelled() ? WorkCancelled("the fit")
                                                      : absl::OkStatus();
  }
  // The rank that keeps and reports what all have made together.
  bool IsFirst() const { return ranks.rank() == 0; }
  void Report(const LearningPoint& point) const {
    if (journal != nullptr) journal->OnPoint(point);
  }
};

}  // namespace tactus::internal
