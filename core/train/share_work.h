// File: share_work.h
//
// Work on many items that all ranks of a fit share out.
//
//   std::vector<ScoredContact> scores(contacts.size());
//   TACTUS_RETURN_IF_ERROR(ShareWork(run, parallel, scores, [&](int i) {
//     scores[i] = ScoreContact(model, *contacts[i], frames);
//     return absl::OkStatus();
//   }));
//
// Thread-safe: a free function without state.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/work.h"
#include "core/train/archive.h"
#include "core/train/fit_run.h"
#include "core/train/run_all.h"

namespace tactus::internal {

// Calls make(i), which sets results[i], for each i at one rank, and gives all
// ranks all results. The error of any rank is returned at all.
template <typename T>
absl::Status ShareWork(const FitRun& run, const ParallelFor& parallel,
                       std::vector<T>& results,
                       const std::function<absl::Status(int)>& make) {
  Ranks& ranks = run.ranks;
  const auto size = static_cast<size_t>(ranks.size());
  const auto place_of = [&](int rank, size_t k) {
    return k * size + static_cast<size_t>(rank);
  };
  const auto count_of = [&](int rank) {
    return (results.size() + size - 1 - static_cast<size_t>(rank)) / size;
  };
  const absl::Status made = RunAll(
      parallel, count_of(ranks.rank()),
      [&](int k) { return make(static_cast<int>(place_of(ranks.rank(), k))); });
  if (ranks.size() == 1) return made;
  ByteWriter writer;
  for (size_t k = 0; k < count_of(ranks.rank()); ++k) {
    writer(results[place_of(ranks.rank(), k)]);
  }
  absl::StatusOr<std::string> given = writer.Take();
  if (!made.ok()) given = made;
  TACTUS_ASSIGN_OR_RETURN(const auto all, ranks.Exchange(given));
  for (int rank = 0; rank < ranks.size(); ++rank) {
    ByteReader reader(all[rank]);
    for (size_t k = 0; k < count_of(rank); ++k) {
      reader(results[place_of(rank, k)]);
    }
    if (!reader.AtEnd()) {
      return CheckpointInvalid("shared work", "a rank has sent other results");
    }
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal
