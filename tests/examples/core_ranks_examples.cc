// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
#include <string>
#include <vector>

#include "core/base/ranks.h"
#include "core/base/status_macros.h"
#include "core/lstm/batch_gradient.h"
#include "core/lstm/tensors.h"
#include "core/train/fit_all.h"
#include "core/train/run_all.h"
#include "core/train/share_work.h"
#include "server/trainer/team.h"
#include "server/trainer/trainer_main.h"
#include "server/training_flags.h"

namespace tactus::internal::ranks_examples {

using Contacts = std::vector<const LabelledContact*>;

std::string Make(int i);
absl::Status Fit(int i);
void Take(int rank, const std::string& bytes);

static absl::Status RanksExample() {
#include "core/base/ranks.h.inc"
  return absl::OkStatus();
}

static absl::Status RunAllExample(const ParallelFor& parallel) {
#include "core/train/run_all.h.inc"
  return absl::OkStatus();
}

static absl::Status ShareWorkExample(
    const FitRun& run, const ParallelFor& parallel, const Contacts& contacts,
    const std::shared_ptr<const CompiledModel>& model,
    const std::vector<double>& frames) {
#include "core/train/share_work.h.inc"
  return absl::OkStatus();
}

static absl::Status FitAllExample(const FitRun& run, const Contacts& contacts,
                                  ModelFit& whole, ModelFit& fold_0,
                                  ModelFit& fold_1, const ParallelFor& start,
                                  const ParallelFor& parallel,
                                  const Progress& progress) {
#include "core/train/fit_all.h.inc"
  return absl::OkStatus();
}

static void TensorsExample(LstmNetwork& gradient) {
#include "core/lstm/tensors.h.inc"
}

static absl::Status BatchGradientExample(const LstmNetwork& network,
                                         LstmSequenceSource& source,
                                         const LstmTrainOptions& options,
                                         Ranks& ranks,
                                         std::span<const size_t> numbers,
                                         uint64_t step, LstmNetwork& gradient) {
#include "core/lstm/batch_gradient.h.inc"
  return absl::OkStatus();
}

}  // namespace tactus::internal::ranks_examples

namespace tactus::internal::server::ranks_examples {

void Take(int rank, const std::string& bytes);

static void TeamExample(const v1::JobEvent& event) {
#include "server/trainer/team.h.inc"
}

static int TrainerMainExample(int argc, char** argv) {
#include "server/trainer/trainer_main.h.inc"
}

static absl::Status TrainingFlagsExample(CLI::App& app,
                                         const std::string& address,
                                         ModelRegistry& registry) {
#include "server/training_flags.h.inc"
  return absl::OkStatus();
}

}  // namespace tactus::internal::server::ranks_examples
