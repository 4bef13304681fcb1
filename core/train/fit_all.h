// File: fit_all.h
//
// Fits several models together: on the threads that are lent, within the memory
// that a fit may take, and with the other ranks, if there are some.
//
//   std::vector<ModelFit*> fits = {&whole, &fold_0, &fold_1};
//   TACTUS_RETURN_IF_ERROR(
//       FitAll(run, contacts, fits, start, parallel, progress));
//   const Model model = whole.TakeModel();
//
// Each rank does some of the tasks and then takes what the others have made.
// Networks whose batches are cut into shards (LstmTrainOptions) are trained by
// all ranks together, one after another.
//
// Thread-safe: a free function without state.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "core/base/work.h"
#include "core/train/fit_run.h"
#include "core/train/model_fit.h"

namespace tactus::internal {

// `contacts`: all of the fit; they take memory too. The threads of `start` work
// until the first iteration.
absl::Status FitAll(const FitRun& run,
                    const std::vector<const LabelledContact*>& contacts,
                    const std::vector<ModelFit*>& fits,
                    const ParallelFor& start, const ParallelFor& parallel,
                    const Progress& progress);

}  // namespace tactus::internal
