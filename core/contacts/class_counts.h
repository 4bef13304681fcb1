// File: class_counts.h
//
// How many contacts of each class there are, and whether they suffice: to fit a
// model, and to fit one to all folds but one.
//
//   TACTUS_RETURN_IF_ERROR(CheckClasses(CountClasses(contacts), "contacts"));
//   TACTUS_ASSIGN_OR_RETURN(auto folds, MakeFolds(contacts, protocol));
//   TACTUS_RETURN_IF_ERROR(CheckFolds(contacts, folds, protocol));
//
// Thread-safe: free functions without state.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "core/contacts/folds.h"
#include "core/contacts/labelled_contact.h"

namespace tactus::internal {

// A model is fitted to at least this many contacts of each class.
inline constexpr int kMinContactsPerClass = 2;

// Number of contacts by label.
using ClassCounts = std::map<std::string, int>;

ClassCounts CountClasses(const std::vector<const LabelledContact*>& contacts);

// INVALID_TRAINING_DATA, which names the class and its count, unless there are
// 2 to limits::kMaxClasses classes, each with kMinContactsPerClass or more, and
// no label is empty. `noun` is what is counted: "contacts" or "trials".
absl::Status CheckClasses(const ClassCounts& counts, absl::string_view noun);

// INVALID_TRAINING_DATA, which names the class and what is left of it, unless
// the contacts outside of each fold include kMinContactsPerClass of each class.
absl::Status CheckFolds(const std::vector<const LabelledContact*>& contacts,
                        const std::vector<std::vector<int>>& folds,
                        Protocol protocol);

// True if CheckFolds would succeed.
bool LeavesEveryClass(const std::vector<const LabelledContact*>& contacts,
                      const std::vector<std::vector<int>>& folds);

// The labels that CheckClasses would refuse for their count, or for being
// empty.
std::vector<std::string> SmallClasses(const ClassCounts& counts);

// The labels that CheckFolds would refuse.
std::vector<std::string> SmallClasses(
    const std::vector<const LabelledContact*>& contacts,
    const std::vector<std::vector<int>>& folds);

}  // namespace tactus::internal
