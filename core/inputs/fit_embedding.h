// File: fit_embedding.h
//
// Learns a TaxelEmbedding from labelled contacts. The first dimensions are
// those of a linear discriminant analysis: they separate the classes best,
// relative to the spread within the classes. There is one less than classes,
// and at most kMaxEmbedding. If these are fewer than 16, principal components
// of the taxels' levels make up 16 dimensions; they also hold what is not
// linear in the class means.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       spec.embedding,
//       FitTaxelEmbedding(contacts, class_names, spec.hmm_steps));
//
// Deterministic; which number a taxel has changes nothing but the order of
// sums. Thread-safe: a free function without state.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/classify/step_clock.h"
#include "core/contacts/labelled_contact.h"
#include "core/taxels/taxel_embedding.h"

namespace tactus::internal {

// All contacts must be of one skin and have its taxels (ContactFrames::loads).
// The frames at which `steps` makes a step due are used. INVALID_TRAINING_DATA
// if more than limits::kMaxEmbeddedTaxels taxels were ever touched.
absl::StatusOr<TaxelEmbedding> FitTaxelEmbedding(
    const std::vector<const LabelledContact*>& contacts,
    const std::vector<std::string>& class_names, const StepIntervals& steps);

}  // namespace tactus::internal
