// tactus-trainer-mpi: one rank of a job that mpirun has started. tactus-trainer
// becomes it; people start neither.
#include <cstdio>

#include "server/ranks/mpi_team.h"
#include "server/trainer/exit_status.h"
#include "server/trainer/trainer_main.h"

int main(int argc, char** argv) {
  using namespace tactus::internal::server;
  const auto team = MpiTeam::Join(&argc, &argv);
  if (!team.ok()) {
    std::fprintf(stderr, "tactus-trainer: %s\n",
                 team.status().ToString().c_str());
    return kExitFailed;
  }
  const int status = TrainerMain(argc, argv, **team);
  (*team)->Leave(status);
  return status;
}
