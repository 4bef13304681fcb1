// File: replica.h
//
// Replica: this process among the servers and workers that share a catalogue.
// It has a record there, says every second that it lives, and watches whether
// the others do.
//
//   TACTUS_ASSIGN_OR_RETURN(auto self, Replica::Register(catalog, about, {}));
//   self->Start([](bool gone) { if (gone) LookForTheirJobs(); });
//   if (self->IsDead("replicas/3")) TakeOver();
//   TACTUS_RETURN_IF_ERROR(self->SayServed(change));
//   TACTUS_ASSIGN_OR_RETURN(const auto lagging,
//                           self->WaitServed(change, patience));
//
// Another process is taken for dead once its sign of life has stayed for
// Pace::dead, by the clock of this one and while it could look all
// the time; so no clocks need to agree, and a time without the database kills
// nobody. Or at once, if it has ended and removed its record.
//
// Thread-safe. `catalog` must outlive it.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/base/limits_catalog.h"
#include "core/store/catalog.h"
#include "tactus/v1/storage.pb.h"

namespace tactus::internal::server {

class Replica {
 public:
  // One of all, as this process sees it.
  struct Seen {
    v1::StoredReplica about;
    bool is_this = false;
    bool alive = false;
  };

  struct Pace {
    std::chrono::milliseconds beat{limits::kReplicaBeatMs};
    std::chrono::milliseconds dead{limits::kReplicaDeadMs};
  };

  // Gives it a name. `about` says host, address, version and start time.
  static absl::StatusOr<std::unique_ptr<Replica>> Register(
      Catalog* catalog, v1::StoredReplica about, const Pace& pace);
  // Removes its record, so that others need not wait.
  ~Replica();

  // "replicas/R".
  const std::string& name() const { return about_.name(); }

  // Begins to give signs of life. `on_beat` follows each of them, on the same
  // thread. `gone`: since the last one, another process has ended or has been
  // silent for so long that it is taken for dead.
  void Start(std::function<void(bool gone)> on_beat);
  void Stop();
  // The catalogue may have changed: ends waits.
  void OnNews();

  // True if this process has seen it silent for so long. One that it does not
  // know may just have begun.
  bool IsDead(absl::string_view name) const;
  // All that have a record.
  absl::StatusOr<std::vector<Seen>> All() const;
  // Removes the records of those that are dead for limits::kForgetReplicaMs.
  // One that lives after all writes its own again.
  absl::Status ForgetDead();

  // This process serves all changes of models and aliases up to `change`.
  absl::Status SayServed(uint64_t change);
  // Waits until all that live do, at most for `patience`. Returns the names of
  // those that do not.
  absl::StatusOr<std::vector<std::string>> WaitServed(
      uint64_t change, std::chrono::milliseconds patience) const;

 private:
  using Time = std::chrono::steady_clock::time_point;
  struct Pulse {
    std::string beat;
    Time changed;
  };

  Replica(Catalog* catalog, v1::StoredReplica about, const Pace& pace)
      : catalog_(catalog), about_(std::move(about)), pace_(pace) {}
  void Beat();
  // True if a process is gone that was not gone before.
  bool Look();
  // How long a process has been silent; 0 for one that is not known.
  std::chrono::milliseconds SilenceOf(absl::string_view name) const;

  Catalog* const catalog_;
  const v1::StoredReplica about_;
  const Pace pace_;
  uint64_t beats_ = 0;
  Time last_beat_;

  // Held while the record is written, so that what it says never goes back.
  std::mutex writing_;
  // What the record says.
  uint64_t served_ = 0;

  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  // How often there was news.
  uint64_t news_ = 0;
  bool stopping_ = false;
  // All processes' signs of life, by name.
  std::map<std::string, Pulse, std::less<>> pulses_;
  // Those that the last Look took for dead.
  std::set<std::string> dead_;
  Time last_look_;
  std::thread thread_;
};

}  // namespace tactus::internal::server
