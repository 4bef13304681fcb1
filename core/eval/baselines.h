// File: baselines.h
//
// What needs no model: the most frequent class, one nearest neighbour, and the
// size of a contact alone. An accuracy is worth what it is above these.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       auto folds, MakeFolds(contacts, Protocol::kLeaveOneConditionOut));
//   TACTUS_ASSIGN_OR_RETURN(const Baselines baselines,
//                           MeasureBaselines(contacts, folds));
//   baselines.nearest_right;  // of baselines.contacts
//
// Deterministic. Contacts must outlive the call. Thread-safe: free functions
// without state.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/contacts/labelled_contact.h"

namespace tactus::internal {

// Numbers of contacts that are answered rightly.
struct Baselines {
  int contacts = 0;
  // Every answer is the class with most contacts.
  int frequent_right = 0;
  // See CountNearestRight().
  int nearest_right = 0;
  // See CountSizeRight().
  int size_right = 0;
};

// `folds` are those of MakeFolds(): each contact is tested once, by the
// contacts of the other folds. Errors of CountNearestRight().
absl::StatusOr<Baselines> MeasureBaselines(
    const std::vector<const LabelledContact*>& contacts,
    const std::vector<std::vector<int>>& folds);

// Contacts that have the label of the nearest one of the other folds. A contact
// is a point: mean, deviation and largest value over its touched frames of the
// features, the whole skin's force and the load profile, each in deviations.
// INVALID_TRAINING_DATA for numbers that are not finite.
absl::StatusOr<int> CountNearestRight(
    const std::vector<const LabelledContact*>& contacts,
    const std::vector<std::vector<int>>& folds);

// Contacts that the largest touched area alone answers rightly, with one
// threshold fewer than there are classes: of all such thresholds, those with
// most right answers on the other folds.
int CountSizeRight(const std::vector<const LabelledContact*>& contacts,
                   const std::vector<std::vector<int>>& folds);

}  // namespace tactus::internal
