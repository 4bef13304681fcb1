// File: choice_folds.h
//
// The folds by which models for contacts are compared, as the contacts ask for
// them: what a robot meets later is another object or another condition, so
// groups or conditions are left out where they allow it.
//
//   const ChoiceFolds folds = FoldsForChoice(contacts);
//   folds.by;  // FoldsBy::kGroups
//
// Deterministic. Thread-safe: free functions without state.
#pragma once

#include <vector>

#include "core/contacts/folds.h"
#include "core/contacts/labelled_contact.h"

namespace tactus::internal {

enum class FoldsBy { kGroups, kConditions, kClasses };

struct ChoiceFolds {
  FoldsBy by = FoldsBy::kClasses;
  std::vector<std::vector<int>> folds;
};

// The stratified folds where neither groups nor conditions can be left out.
inline const Protocol kStratifiedChoice(Protocol::kKFold, 3);

// Folds that leave out groups (LabelledContact::material) if there are several
// and every class remains; else conditions, likewise; else the folds of
// kStratifiedChoice. At most 8 groups or conditions are left out one by one;
// more are dealt to 5 folds of similar classes, none of them to two. Contacts
// of one fold alone give that fold.
ChoiceFolds FoldsForChoice(const std::vector<const LabelledContact*>& contacts);

}  // namespace tactus::internal
