// File: folds.h
//
// How contacts are split into folds: each is tested once by models that saw
// none of its fold.
//
// Thread-safe: free functions without state.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/train/labelled_contact.h"

namespace tactus {

struct Protocol {
  enum Kind {
    // Leave one robot condition out (the paper's).
    kLeaveOneConditionOut,
    kLeaveOneOut,
    kLeaveOneMaterialOut,
    // `folds` folds, to which the contacts of each class go in turn.
    kKFold,
  };
  static constexpr int kDefaultFolds = 10;

  // Implicit: a kind is a protocol.
  Protocol(Kind protocol, int k = kDefaultFolds) : kind(protocol), folds(k) {}

  Kind kind;
  int folds;
};

// "loco", "leave-one-out", "leave-one-material-out" or "k-fold", which makes
// `folds`, at least 2; else INVALID_CONFIG.
absl::StatusOr<Protocol> ParseProtocol(absl::string_view name,
                                       int folds = Protocol::kDefaultFolds);

// Indices of the test contacts of each fold. INVALID_TRAINING_DATA if there
// are fewer than two folds.
absl::StatusOr<std::vector<std::vector<int>>> MakeFolds(
    const std::vector<const LabelledContact*>& contacts, Protocol protocol);

// Every `count`-th contact of each class, for inner splits.
std::vector<std::vector<int>> StratifiedFolds(
    const std::vector<const LabelledContact*>& contacts, int count);

// All indices below `count` that are not in `fold`, in order.
std::vector<int> Complement(const std::vector<int>& fold, int count);

}  // namespace tactus
