// File: warm_up.h
//
// The answers that a model gives to its warm-up trial. A bundle stores them,
// and RunWarmUp (compiled_model.h) compares.
//
//   model.warm_up.samples = samples;
//   TACTUS_RETURN_IF_ERROR(AnswerWarmUp(model));
//
// Thread-safe: a free function without state.
#pragma once

#include "absl/status/status.h"
#include "core/classify/model.h"

namespace tactus::internal {

// Sets the probabilities and log-likelihoods of model.warm_up to what `model`
// answers after its samples. Fails as Validate(model) does, whatever answers it
// had.
absl::Status AnswerWarmUp(Model& model);

}  // namespace tactus::internal
