#include <algorithm>
#include <iterator>
#include <vector>

#include "core/base/status_macros.h"
#include "core/inputs/fit_embedding.h"
#include "core/inputs/inputs.h"
#include "core/train/fit_models.h"

namespace tactus::internal {
namespace {

// Kept for each model that is fitted at the same time: the paper's 1,835
// trials and their copies take 20 MB.
constexpr size_t kKeptCueBytes = size_t{32} << 20;

// The taxels that the inputs of HMMs and LSTMs are made from, if any are.
absl::StatusOr<TaxelEmbedding> EmbeddingFor(const FitRun& run,
                                            const VariedContacts& contacts) {
  const FitOptions& options = run.options;
  std::vector<Cue> cues;
  if (options.learner == Learner::kHmms)
    cues = CuesFor(options.hmm_cues, options.features);
  if (options.lstm.networks > 0) {
    std::ranges::copy(CuesFor(options.lstm.cues, options.features),
                      std::back_inserter(cues));
  }
  CueSources sources = 0;
  for (const Cue cue : cues) sources |= SourcesOf(cue);
  if ((sources & kFromEmbedding) != 0) {
    return FitTaxelEmbedding(contacts.originals(), run.class_names,
                             options.hmm_steps);
  }
  TaxelEmbedding none;
  if ((sources & kFromTaxels) != 0) {
    none.taxels = contacts.Original(0).layout.taxels();
  }
  return none;
}

// The cues that the options ask for and the embedding has.
std::vector<Cue> Available(const std::vector<Cue>& wanted,
                           const FitOptions& options,
                           const TaxelEmbedding& embedding) {
  std::vector<Cue> cues = CuesFor(wanted, options.features);
  std::erase_if(cues, [&](Cue cue) {
    return (SourcesOf(cue) & kFromEmbedding) != 0 &&
           PlaceInGroup(cue) >= embedding.dimensions;
  });
  return cues;
}

}  // namespace

absl::StatusOr<InputSpec> FitHmmInputs(const FitRun& run,
                                       const std::string& part,
                                       const VariedContacts& contacts,
                                       const ParallelFor& parallel,
                                       CueTable* table) {
  TACTUS_ASSIGN_OR_RETURN(auto saved, run.saved.Find<InputSpec>(part));
  if (saved) return *std::move(saved);
  const FitOptions& options = run.options;
  InputSpec spec;
  spec.hmm_steps = options.hmm_steps;
  spec.sample_rate_hz = contacts.Original(0).sample_rate_hz;
  TACTUS_ASSIGN_OR_RETURN(spec.embedding, EmbeddingFor(run, contacts));
  if (options.learner != Learner::kHmms) return spec;
  spec.hmm =
      FitInputs(contacts, Available(options.hmm_cues, options, spec.embedding),
                {.log_features = options.log_features,
                 .steps = options.hmm_steps,
                 .embedding = &spec.embedding,
                 .kept_bytes = kKeptCueBytes},
                parallel, table);
  return spec;
}

absl::Status FitLstmInputs(const FitRun& run, const std::string& part,
                           const VariedContacts& contacts, bool put,
                           InputSpec* spec) {
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
        contacts, Available(fit.cues, options, spec->embedding),
        {.scaling = fit.scaling,
         .steps = fit.steps,
         .stretched_cues = CuesFor(fit.stretched_cues, options.features),
         .stretches = fit.stretches,
         .limit = fit.limit,
         .embedding = &spec->embedding});
  }
  return put ? run.saved.Put(part, *spec) : absl::OkStatus();
}

}  // namespace tactus::internal
