// File: mpi_team.h
//
// MpiTeam: the ranks that mpirun has started, by MPI.
//
//   TACTUS_ASSIGN_OR_RETURN(auto team, MpiTeam::Join(&argc, &argv));
//   const int status = TrainerMain(argc, argv, *team);
//   team->Leave(status);
//
// Whoever waits for others sleeps: MPI itself would keep a processor busy that
// robots' streams may need. A rank that ends without Leave ends all: mpirun
// sees to it.
//
// One in a process. Thread-safe as Team says; all calls of MPI are behind one
// lock (MPI_THREAD_SERIALIZED).
#pragma once

#include <mpi.h>

#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "server/trainer/team.h"

namespace tactus::internal::server {

class MpiTeam final : public Team {
 public:
  // INTERNAL if MPI gives no threads.
  static absl::StatusOr<std::unique_ptr<MpiTeam>> Join(int* argc, char*** argv);
  // With another exit status than 0, ends all ranks at once with it. Else waits
  // for the others. No other call may follow.
  void Leave(int status);

  int rank() const override { return rank_; }
  int size() const override { return size_; }
  absl::StatusOr<std::vector<std::string>> Exchange(
      const absl::StatusOr<std::string>& mine) override;
  void Tell(const std::string& bytes) override;
  void Hear(const Take& take) override;
  void WhileWaiting(std::function<void()> call) override;

 private:
  // What a rank says before its bytes.
  struct Header {
    int64_t bytes;
    // Number of messages that it has told so far.
    int64_t told;
    int64_t failed;
  };
  struct Sent {
    std::string bytes;
    MPI_Request request;
  };

  MpiTeam(int rank, int size) : rank_(rank), size_(size), heard_(size) {}
  // Sleeps until the request is done, and hears meanwhile.
  void Wait(MPI_Request& request);
  std::vector<Header> ExchangeHeaders(const Header& mine);
  // Adds to `given` a slice of what each rank gives, from byte `at` on.
  void ExchangeSlice(int64_t at, const std::string& bytes,
                     const std::vector<Header>& headers,
                     std::vector<std::string>& given);
  // At the first rank: until all has come that was told before `headers`.
  void HearAll(const std::vector<Header>& headers);

  const int rank_;
  const int size_;
  std::function<void()> while_waiting_;
  absl::Status error_;  // what has ended the common work

  std::mutex mutex_;  // of MPI and of the following
  std::list<Sent> sent_;
  int64_t told_ = 0;
  std::vector<int64_t> heard_;  // messages of each rank
};

}  // namespace tactus::internal::server
