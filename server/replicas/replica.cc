#include "server/replicas/replica.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/store/numbers.h"
#include "core/store/records.h"

namespace tactus::internal::server {
namespace {

using Clock = std::chrono::steady_clock;

constexpr char kReplicas[] = "replicas";
constexpr std::chrono::milliseconds kForget(limits::kForgetReplicaMs);
// News may be missed.
constexpr std::chrono::milliseconds kLookAgain(200);

}  // namespace

absl::StatusOr<std::unique_ptr<Replica>> Replica::Register(
    Catalog* catalog, v1::StoredReplica about, const Pace& pace) {
  TACTUS_RETURN_IF_ERROR(
      catalog->Change([&](Transaction& change) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(const uint32_t last,
                                LastNumber(change, kReplicas));
        about.set_name(absl::StrCat(kReplicas, "/", last + 1));
        TACTUS_RETURN_IF_ERROR(
            change.Put(Table::kNumbers, kReplicas, NumberKey(last + 1)));
        return PutRecord(change, Table::kReplicas, about.name(), about);
      }));
  std::unique_ptr<Replica> replica(
      new Replica(catalog, std::move(about), pace));
  replica->Beat();
  replica->Look();
  return replica;
}

Replica::~Replica() {
  Stop();
  catalog_
      ->Change([&](Transaction& change) -> absl::Status {
        TACTUS_RETURN_IF_ERROR(change.Erase(Table::kReplicas, name()));
        return change.Erase(Table::kBeats, name());
      })
      .IgnoreError();
}

void Replica::Start(std::function<void(bool gone)> on_beat) {
  thread_ = std::thread([this, on_beat = std::move(on_beat)] {
    std::unique_lock lock(mutex_);
    while (!stopping_) {
      lock.unlock();
      Beat();
      on_beat(Look());
      lock.lock();
      changed_.wait_for(lock, pace_.beat, [&] { return stopping_; });
    }
  });
}

void Replica::Stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void Replica::OnNews() {
  {
    const std::lock_guard lock(mutex_);
    ++news_;
  }
  changed_.notify_all();
}

void Replica::Beat() {
  ++beats_;
  const Time now = Clock::now();
  v1::StoredReplica about = about_;
  const std::lock_guard writing(writing_);
  about.set_served_change(served_);
  // Others may have forgotten one that was silent.
  const bool again = beats_ > 1 && now - last_beat_ >= pace_.dead;
  const absl::Status given =
      catalog_->Change([&](Transaction& change) -> absl::Status {
        if (again) {
          TACTUS_RETURN_IF_ERROR(
              PutRecord(change, Table::kReplicas, name(), about));
        }
        return change.Put(Table::kBeats, name(), absl::StrCat(beats_));
      });
  // The next one tries again.
  if (given.ok()) last_beat_ = now;
}

bool Replica::Look() {
  std::vector<CatalogEntry> beats;
  const absl::Status looked =
      catalog_->Look([&](const Transaction& look) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(beats, look.Scan(Table::kBeats, {}));
        return absl::OkStatus();
      });
  const Time now = Clock::now();
  const std::lock_guard lock(mutex_);
  // Whoever could not look, or stood still, has not seen that nothing came.
  const bool blind = !looked.ok() || now - last_look_ > pace_.dead / 2;
  last_look_ = now;
  if (blind) {
    for (auto& [name, pulse] : pulses_) pulse.changed = now;
  }
  if (!looked.ok()) return false;
  std::map<std::string, Pulse, std::less<>> pulses;
  for (const CatalogEntry& entry : beats) {
    const auto before = pulses_.find(entry.key);
    const bool same =
        before != pulses_.end() && before->second.beat == entry.value;
    pulses[entry.key] = {entry.value, same ? before->second.changed : now};
  }
  bool gone = false;
  for (const auto& [name, pulse] : pulses_) {
    gone = gone || (!pulses.contains(name) && !dead_.contains(name));
  }
  std::set<std::string> dead;
  for (const auto& [name, pulse] : pulses) {
    if (name == about_.name() || now - pulse.changed < pace_.dead) continue;
    gone = gone || !dead_.contains(name);
    dead.insert(name);
  }
  pulses_ = std::move(pulses);
  dead_ = std::move(dead);
  return gone;
}

std::chrono::milliseconds Replica::SilenceOf(absl::string_view name) const {
  const std::lock_guard lock(mutex_);
  const auto pulse = pulses_.find(name);
  if (pulse == pulses_.end()) return std::chrono::milliseconds(0);
  return std::chrono::floor<std::chrono::milliseconds>(Clock::now() -
                                                       pulse->second.changed);
}

bool Replica::IsDead(absl::string_view name) const {
  return name != this->name() && SilenceOf(name) >= pace_.dead;
}

absl::Status Replica::ForgetDead() {
  TACTUS_ASSIGN_OR_RETURN(const std::vector<Seen> all, All());
  for (const Seen& seen : all) {
    const std::string& name = seen.about.name();
    if (seen.is_this || SilenceOf(name) < kForget) continue;
    TACTUS_RETURN_IF_ERROR(
        catalog_->Change([&](Transaction& change) -> absl::Status {
          TACTUS_RETURN_IF_ERROR(change.Erase(Table::kReplicas, name));
          return change.Erase(Table::kBeats, name);
        }));
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<Replica::Seen>> Replica::All() const {
  std::vector<v1::StoredReplica> records;
  TACTUS_RETURN_IF_ERROR(
      catalog_->Look([&](const Transaction& look) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(records, ScanRecords<v1::StoredReplica>(
                                             look, Table::kReplicas, {}));
        return absl::OkStatus();
      }));
  std::vector<Seen> all;
  for (v1::StoredReplica& record : records) {
    const bool alive = !IsDead(record.name());
    const bool is_this = record.name() == name();
    all.push_back({std::move(record), is_this, alive});
  }
  return all;
}

absl::Status Replica::SayServed(uint64_t change) {
  const std::lock_guard writing(writing_);
  if (change <= served_) return absl::OkStatus();
  v1::StoredReplica about = about_;
  about.set_served_change(change);
  TACTUS_RETURN_IF_ERROR(catalog_->Change([&](Transaction& transaction) {
    return PutRecord(transaction, Table::kReplicas, name(), about);
  }));
  served_ = change;
  return absl::OkStatus();
}

absl::StatusOr<std::vector<std::string>> Replica::WaitServed(
    uint64_t change, std::chrono::milliseconds patience) const {
  const Time until = Clock::now() + patience;
  while (true) {
    uint64_t seen = 0;
    {
      const std::lock_guard lock(mutex_);
      seen = news_;
    }
    TACTUS_ASSIGN_OR_RETURN(const std::vector<Seen> all, All());
    std::vector<std::string> lagging;
    for (const Seen& replica : all) {
      // Workers have no streams.
      if (!replica.alive || replica.about.address().empty()) continue;
      if (replica.about.served_change() < change) {
        lagging.push_back(replica.about.name());
      }
    }
    if (lagging.empty() || Clock::now() >= until) return lagging;
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kLookAgain,
                      [&] { return stopping_ || news_ != seen; });
  }
}

}  // namespace tactus::internal::server
