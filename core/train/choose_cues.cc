#include "core/train/choose_cues.h"

#include <algorithm>
#include <optional>

#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal {

absl::StatusOr<std::vector<Cue>> CuesNamed(
    absl::string_view field, const std::vector<std::string>& names) {
  std::vector<Cue> cues;
  for (const std::string& name : names) {
    const std::optional<Cue> cue = ParseCue(name);
    if (!cue) return InvalidConfig(field, name, "names of docs/cues.md");
    cues.push_back(*cue);
  }
  return cues;
}

absl::Status AddLstmCues(absl::string_view field,
                         const std::vector<std::string>& names,
                         FitOptions& options) {
  TACTUS_ASSIGN_OR_RETURN(const std::vector<Cue> added,
                          CuesNamed(field, names));
  std::vector<Cue>& cues = options.lstm.cues;
  for (const Cue cue : added) {
    if (options.lstm.networks == 0) {
      return InvalidConfig(field, CueName(cue), "empty without LSTMs");
    }
    if (std::ranges::count(cues, cue) > 0) {
      return InvalidConfig(field, CueName(cue),
                           "cues that LSTMs would not take already");
    }
    cues.push_back(cue);
  }
  return absl::OkStatus();
}

absl::Status LeaveOutCues(absl::string_view field,
                          const std::vector<std::string>& names,
                          FitOptions& options) {
  TACTUS_ASSIGN_OR_RETURN(const std::vector<Cue> removed,
                          CuesNamed(field, names));
  LstmFit& lstm = options.lstm;
  for (const Cue cue : removed) {
    size_t found = std::erase(lstm.stretched_cues, cue);
    for (std::vector<Cue>* cues : {&options.hmm_cues, &lstm.cues}) {
      const size_t erased = std::erase(*cues, cue);
      // No cues would stand for the features.
      if (erased > 0 && cues->empty()) {
        return InvalidConfig(field, CueName(cue),
                             "other cues: some models have no other input");
      }
      found += erased;
    }
    if (found == 0) {
      return InvalidConfig(field, CueName(cue),
                           "cues that the models would take");
    }
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal
