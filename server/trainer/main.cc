// tactus-trainer: runs one job of tactusd. Started by tactusd, not by people.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>

#include "server/trainer/exit_status.h"
#include "server/trainer/trainer_main.h"

namespace tactus::internal::server {
namespace {

// True if mpirun has started this process.
bool IsRank() { return std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr; }

// Becomes the program that knows MPI, so that this one needs none.
int RunAsRank(char** argv) {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string program =
      (self.parent_path() / "tactus-trainer-mpi").string();
  execv(program.c_str(), argv);
  std::fprintf(stderr,
               "tactus-trainer: %s: %s; it is built where libopenmpi-dev is "
               "installed, and a job of several ranks needs it\n",
               program.c_str(), std::strerror(errno));
  return kExitFailed;
}

}  // namespace
}  // namespace tactus::internal::server

int main(int argc, char** argv) {
  using namespace tactus::internal::server;
  if (IsRank()) return RunAsRank(argv);
  LoneTeam alone;
  return TrainerMain(argc, argv, alone);
}
