// File: replace_models.h
//
// Puts HMMs or networks of another program into a model.
//
//   TACTUS_ASSIGN_OR_RETURN(ForeignModel foreign, ReadModelFile("net.onnx"));
//   TACTUS_RETURN_IF_ERROR(ReplaceModels(foreign, model));
//   TACTUS_RETURN_IF_ERROR(AnswerWarmUp(model));
//
// Calibration, layout and warm-up frames stay as they are. Thread-safe: a free
// function without state.
#pragma once

#include "absl/status/status.h"
#include "core/interchange/model/foreign_model.h"

namespace tactus::internal {

// The HMMs of each class that `foreign` names replace that class's; its
// networks replace all networks, their outputs put into the model's order of
// classes. Inputs that `foreign` states replace the model's. An estimator of
// the object whose inputs change is removed. A model that had no networks gets
// an even weight of HMMs and networks. INVALID_MODEL, and `model` unchanged,
// if a class is not the model's, the sampling rate differs, the inputs are
// nowhere stated, or the result is not valid.
absl::Status ReplaceModels(const ForeignModel& foreign, Model& model);

}  // namespace tactus::internal
