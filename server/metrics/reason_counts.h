// File: reason_counts.h
//
// ReasonCounts: how often something was refused, by reason.
//
//   refused.Add(ReasonOf(status));
//   refused.Collect(CounterFamily("refused_total", "..."), &families);
//
// Thread-safe; takes a lock.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "server/metrics/families.h"

namespace tactus::internal::server {

class ReasonCounts {
 public:
  // A reason of ErrorReason, so that there are few.
  void Add(const std::string& reason) {
    const std::lock_guard lock(mutex_);
    ++counts_[reason];
  }
  // Adds `family` with what was counted.
  void Collect(Family family, Families* families) const {
    const std::lock_guard lock(mutex_);
    for (const auto& [reason, count] : counts_) {
      server::Add({{"reason", reason}}, static_cast<double>(count), &family);
    }
    families->push_back(std::move(family));
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, uint64_t> counts_;
};

}  // namespace tactus::internal::server
