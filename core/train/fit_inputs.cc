#include "core/base/status_macros.h"
#include "core/train/fit_models.h"
#include "core/train/inputs.h"

namespace tactus {

absl::StatusOr<InputSpec> FitHmmInputs(const FitRun& run,
                                       const std::string& part,
                                       const VariedContacts& contacts) {
  TACTUS_ASSIGN_OR_RETURN(auto saved, run.saved.Find<InputSpec>(part));
  if (saved) return *std::move(saved);
  const FitOptions& options = run.options;
  InputSpec spec;
  spec.hmm_steps = options.hmm_steps;
  spec.hmm = FitInputs(
      contacts, CuesFor(options.hmm_cues, options.features),
      {.log_features = options.log_features, .steps = options.hmm_steps});
  spec.sample_rate_hz = contacts.Original(0).sample_rate_hz;
  return spec;
}

absl::Status FitLstmInputs(const FitRun& run, const std::string& part,
                           const VariedContacts& contacts, InputSpec* spec) {
  TACTUS_ASSIGN_OR_RETURN(auto saved, run.saved.Find<InputSpec>(part));
  if (saved) {
    *spec = *std::move(saved);
    return absl::OkStatus();
  }
  const FitOptions& options = run.options;
  const LstmFit& fit = options.lstm;
  if (fit.networks > 0) {
    TACTUS_RETURN_IF_ERROR(run.GoOn());
    spec->lstm_steps = fit.steps;
    spec->lstm = FitInputs(
        contacts, CuesFor(fit.cues, options.features),
        {.scaling = fit.scaling,
         .steps = fit.steps,
         .stretched_cues = CuesFor(fit.stretched_cues, options.features),
         .stretches = fit.stretches,
         .limit = fit.limit});
  }
  return run.saved.Put(part, *spec);
}

}  // namespace tactus
