// File: usable.h
//
// Which contacts models can be fitted to: those that give every model at least
// one step. A contact that ends, or loses touch for good, before the first step
// is due gives none.
//
//   std::erase_if(contacts, [&](const LabelledContact* contact) {
//     return !IsUsable(*contact, options);
//   });
//   TACTUS_RETURN_IF_ERROR(CheckUsable(contacts, options));
//
// Thread-safe: free functions without state.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "core/contacts/labelled_contact.h"
#include "core/train/fit_options.h"

namespace tactus::internal {

// Only the contact itself counts. A fit leaves out copies without a step.
bool IsUsable(const LabelledContact& contact, const FitOptions& options);

// INVALID_TRAINING_DATA, which names contacts that are not usable, and how many
// there are.
absl::Status CheckUsable(const std::vector<const LabelledContact*>& contacts,
                         const FitOptions& options);

}  // namespace tactus::internal
