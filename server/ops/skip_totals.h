// File: skip_totals.h
//
// SkipTotals: what all streams have left out since the start, by rule. Streams
// count for themselves and add up once, at their end.
//
//   totals.Add(session.skipped());
//   spdlog::info("skipped {}", totals.ToString());
//
// Thread-safe, lock-free.
#pragma once

#include <atomic>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/classify/skip_rules.h"

namespace tactus::internal::server {

class SkipTotals {
 public:
  void Add(const SkipCounters& skipped) {
    for (int i = 0; i < kSkipRuleCount; ++i) {
      const auto rule = static_cast<SkipRule>(i);
      totals_[rule].fetch_add(skipped[rule], std::memory_order_relaxed);
    }
  }

  uint64_t total(SkipRule rule) const {
    return totals_[rule].load(std::memory_order_relaxed);
  }

  // In words.
  std::string ToString() const {
    return absl::StrCat(
        total(SkipRule::kUntouchedFrames), " untouched frames, ",
        total(SkipRule::kUnchangedFrames), " unchanged frames, ",
        total(SkipRule::kUnchangedScores), " unchanged scores, ",
        total(SkipRule::kUnusedLstms), " unused LSTM steps, ",
        total(SkipRule::kUnlistedTaxels), " sparse frames, ",
        total(SkipRule::kQuietRows), " quiet rows");
  }

 private:
  PerSkipRule<std::atomic<uint64_t>> totals_;
};

}  // namespace tactus::internal::server
