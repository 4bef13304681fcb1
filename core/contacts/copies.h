// File: copies.h
//
// Contacts of equal recordings: trials whose frames have the same fingerprint.
//
//   for (const Copy& copy : FindCopies(contacts)) {
//     Remark(CopyText(contacts, copy));
//   }
//
// Thread-safe: free functions without state.
#pragma once

#include <string>
#include <vector>

#include "core/contacts/labelled_contact.h"

namespace tactus::internal {

// Indices of a contact and of the first one with the same frames.
struct Copy {
  int contact = 0;
  int first = 0;
};

// For each contact the index of the first one with the same frames; its own if
// there is none before it.
std::vector<int> FirstOfEqual(
    const std::vector<const LabelledContact*>& contacts);

// The contacts whose frames an earlier one has, in order.
std::vector<Copy> FindCopies(
    const std::vector<const LabelledContact*>& contacts);

// "b.csv (SU) has the frames of a.csv (HU)".
std::string CopyText(const std::vector<const LabelledContact*>& contacts,
                     const Copy& copy);

}  // namespace tactus::internal
