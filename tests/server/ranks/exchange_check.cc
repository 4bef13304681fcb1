// Three ranks exchange bytes: mpirun -n 3 exchange_check. Prints what is wrong
// and ends with status 1.
#include <cstdio>
#include <cstdlib>
#include <string>

#include "core/base/errors.h"
#include "server/ranks/mpi_team.h"

namespace tactus::internal::server {
namespace {

std::string BytesOf(int rank, size_t size) {
  std::string bytes(size, '\0');
  for (size_t i = 0; i < size; ++i) {
    bytes[i] = static_cast<char>((i * 31 + i / 251 + 7 * rank) & 0xff);
  }
  return bytes;
}

// Rank r gives sizes[r % 3] bytes.
bool Arrives(MpiTeam& team, const std::vector<size_t>& sizes) {
  const auto given =
      team.Exchange(BytesOf(team.rank(), sizes[team.rank() % sizes.size()]));
  if (!given.ok()) return false;
  for (int rank = 0; rank < team.size(); ++rank) {
    if ((*given)[rank] != BytesOf(rank, sizes[rank % sizes.size()])) {
      return false;
    }
  }
  return true;
}

}  // namespace

int ExchangeCheck(int argc, char** argv) {
  auto team = MpiTeam::Join(&argc, &argv);
  if (!team.ok()) return 1;
  constexpr size_t kMib = 1024 * 1024;
  // With an argument: so many MiB from each rank, such as 1100 for more than
  // an int can count.
  const size_t mib = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 9;
  for (const std::vector<size_t>& sizes :
       {std::vector<size_t>{0, 0, 0},
        {5, 0, 1},
        {4 * kMib, 4 * kMib + 1, 3},
        {mib * kMib + 3, mib * kMib, mib * kMib - 1}}) {
    if (Arrives(**team, sizes)) continue;
    std::fprintf(stderr, "rank %d: %zu, %zu and %zu bytes do not arrive\n",
                 (*team)->rank(), sizes[0], sizes[1], sizes[2]);
    (*team)->Leave(1);
    return 1;
  }
  // What one rank cannot give, all hear of.
  const auto failed = (*team)->Exchange(
      (*team)->rank() == 1 ? absl::StatusOr<std::string>(IoError("/x", "gone"))
                           : BytesOf(0, 9));
  const bool heard = ReasonOf(failed.status()) == "IO";
  (*team)->Leave(heard ? 0 : 1);
  return heard ? 0 : 1;
}

}  // namespace tactus::internal::server

int main(int argc, char** argv) {
  return tactus::internal::server::ExchangeCheck(argc, argv);
}
