#include "core/data/trial_zarr.h"

#include <utility>

#include "core/base/status_macros.h"
#include "core/data/trial_arrays.h"
#include "core/files/zarr.h"

namespace tactus::internal {

absl::Status TrialToZarr(const Trial& trial, const std::string& folder) {
  TACTUS_ASSIGN_OR_RETURN(const NamedArrays arrays, TrialToArrays(trial));
  return WriteZarr(folder, arrays);
}

absl::StatusOr<Trial> TrialFromZarr(const std::string& folder) {
  TACTUS_ASSIGN_OR_RETURN(NpzArrays arrays, ReadZarr(folder));
  return TrialFromArrays(folder, std::move(arrays));
}

}  // namespace tactus::internal
