// File: local_fit.h
//
// LocalFit: a training in this process. It does what `trainctl fit` and a job
// of a server do, so the same trials, preset and seed give the same model.
//
//   LocalFit fit(spec, {.threads = 2, .command = "my notebook"});
//   TACTUS_ASSIGN_OR_RETURN(const std::string bundle, fit.Run(trials));
//   fit.Cancel();  // from another thread: Run soon returns CANCELLED
//
// Run may be called once. What the trials point to must outlive it. All other
// methods are thread-safe.
#pragma once

#include <atomic>
#include <cstddef>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/base/work.h"
#include "core/contacts/labelled_contact.h"
#include "core/train/fit_journal.h"
#include "tactus/v1/operations.pb.h"

namespace tactus::internal::python {

// A trial whose frames are where the caller has them. They are copied when the
// trial's contact is taken, one trial for each thread.
struct BorrowedTrial {
  // A serialised v1::TrialRecord without its taxels.
  std::string record;
  absl::string_view taxels;
};

class LocalFit : private FitJournal {
 public:
  struct Options {
    // 0: one for each processor.
    int threads = 0;
    // What the bundle's provenance says.
    std::string command = {};
    std::string data = {};
  };

  // `spec` is a serialised v1::TrainSpec; its dataset and model have no part.
  LocalFit(std::string spec, Options options);

  // The bundle. The errors of a training job; MALFORMED_REQUEST for a spec or a
  // record that is none; CANCELLED.
  absl::StatusOr<std::string> Run(const std::vector<BorrowedTrial>& trials);
  void Cancel() { cancelled_ = true; }

  // What is done at present, and how much of that, 0 to 1.
  std::pair<std::string, double> Done() const;

 private:
  struct Contacts {
    std::vector<LabelledContact> felt;
    bool without_poses = false;
  };

  bool KeepsParts() const override { return false; }
  bool Cancelled() override { return cancelled_; }
  absl::StatusOr<Contacts> Read(const std::vector<BorrowedTrial>& trials,
                                const ParallelFor& parallel,
                                const Progress& progress,
                                bool whole_skin) const;
  void Report(absl::string_view phase, double fraction);

  const std::string spec_;
  const Options options_;
  std::atomic<bool> cancelled_ = false;
  mutable std::mutex mutex_;
  std::string phase_;
  double fraction_ = 0;
};

}  // namespace tactus::internal::python
