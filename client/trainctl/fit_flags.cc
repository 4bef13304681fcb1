#include "client/trainctl/fit_flags.h"

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::client {

void FitFlags::Add(CLI::App& command) {
  command.add_option("--preset", preset, "default or paper");
  command.add_option("--features", features,
                     "Any of f (force), m (motion), a (area), like f,m");
  command.add_option("--seed", seed, "Seed of every random choice");
  command.add_option("--states", states,
                     "States per HMM instead of the preset's");
  command.add_option("--mixtures", mixtures,
                     "HMMs per category instead of the preset's");
}

absl::StatusOr<FitOptions> FitFlags::Options() const {
  TACTUS_ASSIGN_OR_RETURN(FitOptions options, FitPreset(preset));
  TACTUS_ASSIGN_OR_RETURN(options.features, ParseFeatures(features));
  options.seed = seed;
  if (states < 0 || states > limits::kMaxHmmStates) {
    return InvalidConfig("--states", states,
                         absl::StrCat("1 to ", limits::kMaxHmmStates));
  }
  if (mixtures < 0 || mixtures > limits::kMaxHmmsPerClass) {
    return InvalidConfig("--mixtures", mixtures,
                         absl::StrCat("1 to ", limits::kMaxHmmsPerClass));
  }
  if (states > 0) options.states = states;
  if (mixtures > 0) options.hmms_per_class = mixtures;
  return options;
}

}  // namespace tactus::client
