// File: model_proto.h
//
// Model as the wire's ModelBundle and back, without checks beyond what the
// conversion needs; CompiledModel::Create checks the rest.
//
// Thread-safe: free functions without state.
#pragma once

#include "absl/status/statusor.h"
#include "core/classify/model.h"
#include "tactus/v1/bundle.pb.h"

namespace tactus::internal {

v1::ModelBundle ModelToProto(const Model& model);

// INVALID_MODEL if an enumeration or a feature name is unknown.
absl::StatusOr<Model> ModelFromProto(const v1::ModelBundle& bundle);

}  // namespace tactus::internal
