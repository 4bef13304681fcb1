// File: folds.h
//
// How contacts are split into folds. Each contact is tested once, by a model
// that was fitted to the contacts of the other folds. Contacts of equal
// recordings (copies.h) are in one fold, that of the first of them, so that no
// model is tested on a recording that it was fitted to.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       auto folds, MakeFolds(contacts, Protocol::kLeaveOneConditionOut));
//   for (const std::vector<int>& fold : folds) {
//     std::vector<int> training = Complement(fold, contacts.size());
//   }
//
// Thread-safe: free functions without state.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/contacts/labelled_contact.h"

namespace tactus::internal {

struct Protocol {
  enum Kind {
    // Leave one robot condition out, as in the paper.
    kLeaveOneConditionOut,
    kLeaveOneOut,
    kLeaveOneMaterialOut,
    // `folds` folds; the contacts of each class are dealt to them in turn.
    kKFold,
  };
  static constexpr int kDefaultFolds = 10;

  // Implicit: a kind is a protocol.
  Protocol(Kind protocol, int k = kDefaultFolds) : kind(protocol), folds(k) {}

  Kind kind;
  int folds;
};

// Parses "loco", "leave-one-out", "leave-one-material-out" or "k-fold". `folds`
// is the number of k-fold's folds, at least 2. INVALID_CONFIG for other values.
absl::StatusOr<Protocol> ParseProtocol(absl::string_view name,
                                       int folds = Protocol::kDefaultFolds);

// Returns the indices of the test contacts of each fold. INVALID_TRAINING_DATA
// if there are fewer than two folds.
absl::StatusOr<std::vector<std::vector<int>>> MakeFolds(
    const std::vector<const LabelledContact*>& contacts, Protocol protocol);

// Deals the contacts of each class to `count` folds in turn. Leaves out folds
// that stay empty.
std::vector<std::vector<int>> StratifiedFolds(
    const std::vector<const LabelledContact*>& contacts, int count);

// Returns all indices below `count` that are not in `fold`, in order. `fold`
// may be in any order.
std::vector<int> Complement(const std::vector<int>& fold, int count);

}  // namespace tactus::internal
