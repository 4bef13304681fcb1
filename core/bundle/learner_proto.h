// File: learner_proto.h
//
// The parts of a model that see all taxels, as parts of the bundle's message:
// what stands in place of HMMs, and the range of the skin.
//
//   LearnersToProto(model, bundle);
//   TACTUS_RETURN_IF_ERROR(LearnersFromProto(bundle, model));
//
// Thread-safe: free functions without state.
#pragma once

#include "absl/status/status.h"
#include "core/classify/model.h"
#include "tactus/v1/bundle.pb.h"

namespace tactus::internal {

void LearnersToProto(const Model& model, v1::ModelBundle& bundle);

// INVALID_MODEL for numbers that a model cannot hold. Validate() checks the
// rest.
absl::Status LearnersFromProto(const v1::ModelBundle& bundle, Model& model);

}  // namespace tactus::internal
