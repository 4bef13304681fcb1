#include "core/data/trial_npz.h"

#include <utility>

#include "core/base/status_macros.h"
#include "core/data/trial_arrays.h"

namespace tactus::internal {

absl::StatusOr<std::string> TrialToNpz(const Trial& trial) {
  TACTUS_ASSIGN_OR_RETURN(const NamedArrays arrays, TrialToArrays(trial));
  return NpzBytes(arrays);
}

absl::StatusOr<Trial> TrialFromNpz(absl::string_view path,
                                   absl::string_view bytes) {
  TACTUS_ASSIGN_OR_RETURN(NpzArrays arrays, ParseNpz(path, bytes));
  return TrialFromArrays(path, std::move(arrays));
}

}  // namespace tactus::internal
