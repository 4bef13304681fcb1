// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
#include "core/base/status_macros.h"
#include "server/ranks/mpi_team.h"
#include "server/trainer/trainer_main.h"

namespace tactus::internal::server::mpi_examples {

static absl::Status MpiTeamExample(int argc, char** argv) {
#include "server/ranks/mpi_team.h.inc"
  return absl::OkStatus();
}

}  // namespace tactus::internal::server::mpi_examples
