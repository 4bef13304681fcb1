// File: measure_skin_range.h
//
// What the taxels read in the contacts that a model is fitted to.
//
//   model.skin_range = MeasureSkinRange(contacts);
//
// Thread-safe: a free function without state.
#pragma once

#include <vector>

#include "core/contacts/labelled_contact.h"
#include "core/taxels/skin_range.h"

namespace tactus::internal {

// The contacts have taxels, and one skin.
SkinRange MeasureSkinRange(const std::vector<const LabelledContact*>& contacts);

}  // namespace tactus::internal
