#include "core/train/usable.h"

#include <algorithm>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/inputs/inputs.h"

namespace tactus::internal {
namespace {

// Ids that the text of an error names.
constexpr size_t kNamed = 5;

// The first step of the models that are trained is due at this frame.
uint64_t FirstStep(const FitOptions& options) {
  return options.lstm.networks > 0
             ? std::max(options.hmm_steps.First(), options.lstm.steps.First())
             : options.hmm_steps.First();
}

}  // namespace

bool IsUsable(const LabelledContact& contact, const FitOptions& options) {
  return CountSteps(contact, options.hmm_steps) > 0 &&
         (options.lstm.networks == 0 ||
          CountSteps(contact, options.lstm.steps) > 0);
}

absl::Status CheckUsable(const std::vector<const LabelledContact*>& contacts,
                         const FitOptions& options) {
  std::vector<std::string> named;
  size_t count = 0;
  for (const LabelledContact* contact : contacts) {
    if (IsUsable(*contact, options)) continue;
    if (++count <= kNamed) named.push_back(ContactName(*contact));
  }
  if (count == 0) return absl::OkStatus();
  return InvalidTrainingData(absl::StrCat(
      count, " of ", contacts.size(), " contacts are too short: ",
      absl::StrJoin(named, ", "), count > kNamed ? ", ..." : "",
      "; they must be touched at frame ", FirstStep(options),
      " after onset or later, where the models take their first step"));
}

}  // namespace tactus::internal
