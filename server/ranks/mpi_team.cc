#include "server/ranks/mpi_team.h"

#include <sched.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_proto.h"

namespace tactus::internal::server {
namespace {

using std::chrono::microseconds;
using std::chrono::steady_clock;

// For as long, whoever waits only offers its processor: ranks that share out a
// batch wait shorter than a sleep takes.
constexpr microseconds kEager(200);
constexpr microseconds kSleep(50);
constexpr int kTellTag = 1;
// What a rank gives at once: MPI counts the bytes of all ranks in an int.
constexpr int64_t kSliceBytes = 4 * 1024 * 1024;

}  // namespace

absl::StatusOr<std::unique_ptr<MpiTeam>> MpiTeam::Join(int* argc,
                                                       char*** argv) {
  int given = 0;
  MPI_Init_thread(argc, argv, MPI_THREAD_SERIALIZED, &given);
  if (given < MPI_THREAD_SERIALIZED) {
    return absl::InternalError(absl::StrCat(
        "this MPI allows calls of threads at level ", given,
        "; want MPI_THREAD_SERIALIZED (", MPI_THREAD_SERIALIZED, ")"));
  }
  int rank = 0;
  int size = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  return std::unique_ptr<MpiTeam>(new MpiTeam(rank, size));
}

void MpiTeam::Leave(int status) {
  if (status != 0) MPI_Abort(MPI_COMM_WORLD, status);
  MPI_Finalize();
}

absl::StatusOr<std::vector<std::string>> MpiTeam::Exchange(
    const absl::StatusOr<std::string>& mine) {
  if (!error_.ok()) return error_;
  if (while_waiting_) while_waiting_();
  const std::string failure =
      mine.ok() ? "" : ToStatusProto(mine.status()).SerializeAsString();
  const std::string& bytes = mine.ok() ? *mine : failure;
  Header header = {.bytes = static_cast<int64_t>(bytes.size()),
                   .told = 0,
                   .failed = mine.ok() ? 0 : 1};
  {
    const std::lock_guard lock(mutex_);
    header.told = told_;
  }
  const std::vector<Header> headers = ExchangeHeaders(header);
  std::vector<std::string> given(size_);
  int64_t longest = 0;
  for (const Header& of_rank : headers) {
    longest = std::max(longest, of_rank.bytes);
  }
  for (int64_t at = 0; at < longest; at += kSliceBytes) {
    ExchangeSlice(at, bytes, headers, given);
  }
  HearAll(headers);
  for (int rank = 0; rank < size_; ++rank) {
    if (headers[rank].failed == 0 || !error_.ok()) continue;
    v1::Status status;
    error_ =
        status.ParseFromString(given[rank])
            ? FromStatusProto(status)
            : absl::InternalError(absl::StrCat("rank ", rank, " has failed"));
  }
  if (!error_.ok()) return error_;
  return given;
}

void MpiTeam::ExchangeSlice(int64_t at, const std::string& bytes,
                            const std::vector<Header>& headers,
                            std::vector<std::string>& given) {
  const auto length = [at](int64_t size) {
    return static_cast<int>(std::clamp<int64_t>(size - at, 0, kSliceBytes));
  };
  std::vector<int> counts;
  std::vector<int> places;
  int all = 0;
  for (const Header& of_rank : headers) {
    counts.push_back(length(of_rank.bytes));
    places.push_back(all);
    all += counts.back();
  }
  std::string received(static_cast<size_t>(all), '\0');
  const int mine = counts[rank_];
  MPI_Request request;
  {
    const std::lock_guard lock(mutex_);
    MPI_Iallgatherv(mine > 0 ? bytes.data() + at : nullptr, mine, MPI_BYTE,
                    received.data(), counts.data(), places.data(), MPI_BYTE,
                    MPI_COMM_WORLD, &request);
  }
  Wait(request);
  for (int rank = 0; rank < size_; ++rank) {
    given[rank].append(received, places[rank], counts[rank]);
  }
}

std::vector<MpiTeam::Header> MpiTeam::ExchangeHeaders(const Header& mine) {
  std::vector<Header> headers(size_);
  MPI_Request request;
  {
    const std::lock_guard lock(mutex_);
    MPI_Iallgather(&mine, sizeof mine, MPI_BYTE, headers.data(), sizeof mine,
                   MPI_BYTE, MPI_COMM_WORLD, &request);
  }
  Wait(request);
  return headers;
}

void MpiTeam::Wait(MPI_Request& request) {
  const auto eager_end = steady_clock::now() + kEager;
  while (true) {
    {
      const std::lock_guard lock(mutex_);
      int done = 0;
      MPI_Test(&request, &done, MPI_STATUS_IGNORE);
      if (done != 0) return;
    }
    if (steady_clock::now() < eager_end) {
      sched_yield();
      continue;
    }
    if (while_waiting_) while_waiting_();
    std::this_thread::sleep_for(kSleep);
  }
}

void MpiTeam::HearAll(const std::vector<Header>& headers) {
  if (rank_ != 0 || !while_waiting_) return;
  const auto all_heard = [&] {
    const std::lock_guard lock(mutex_);
    for (int rank = 1; rank < size_; ++rank) {
      if (heard_[rank] < headers[rank].told) return false;
    }
    return true;
  };
  while (!all_heard()) {
    while_waiting_();
    sched_yield();
  }
}

void MpiTeam::Tell(const std::string& bytes) {
  const std::lock_guard lock(mutex_);
  std::erase_if(sent_, [](Sent& sent) {
    int done = 0;
    MPI_Test(&sent.request, &done, MPI_STATUS_IGNORE);
    return done != 0;
  });
  Sent& sent = sent_.emplace_back(Sent{bytes, MPI_REQUEST_NULL});
  MPI_Isend(sent.bytes.data(), static_cast<int>(sent.bytes.size()), MPI_BYTE, 0,
            kTellTag, MPI_COMM_WORLD, &sent.request);
  ++told_;
}

void MpiTeam::Hear(const Take& take) {
  if (rank_ != 0) return;
  while (true) {
    int rank = 0;
    std::string bytes;
    {
      const std::lock_guard lock(mutex_);
      int has = 0;
      MPI_Status status;
      MPI_Iprobe(MPI_ANY_SOURCE, kTellTag, MPI_COMM_WORLD, &has, &status);
      if (has == 0) return;
      int size = 0;
      MPI_Get_count(&status, MPI_BYTE, &size);
      rank = status.MPI_SOURCE;
      bytes.resize(static_cast<size_t>(size));
      MPI_Recv(bytes.data(), size, MPI_BYTE, rank, kTellTag, MPI_COMM_WORLD,
               MPI_STATUS_IGNORE);
      ++heard_[rank];
    }
    take(rank, bytes);
  }
}

void MpiTeam::WhileWaiting(std::function<void()> call) {
  while_waiting_ = std::move(call);
}

}  // namespace tactus::internal::server
