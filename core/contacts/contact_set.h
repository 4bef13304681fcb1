// File: contact_set.h
//
// Checks that contacts may be used together, and with a model: one skin, one
// rate. What differs is named, and nothing is used that differs.
//
//   TACTUS_RETURN_IF_ERROR(CheckOneSkin(first, contact));
//   TACTUS_RETURN_IF_ERROR(CheckFits(contact, model));
//
// Thread-safe: free functions without state.
#pragma once

#include "absl/status/status.h"
#include "core/classify/model.h"
#include "core/contacts/labelled_contact.h"

namespace tactus::internal {

// INVALID_TRAINING_DATA unless both contacts have the same skin
// (SkinDifference) and the same sample rate. Ideal signals are a skin without a
// name.
absl::Status CheckOneSkin(const LabelledContact& first,
                          const LabelledContact& contact);

// INVALID_CONFIG if the contact comes from a skin or a sample rate that the
// model was not trained with, or has poses where the model had none or the
// other way round. A rate may differ by 5 %, as a stream's may.
// Ideal signals have no skin and fit any.
absl::Status CheckFits(const LabelledContact& contact, const Model& model);

// The same for a trial of taxels with the skin `layout`.
absl::Status CheckSkinOf(const Trial& trial, const SkinLayout& layout,
                         const Model& model);

}  // namespace tactus::internal
