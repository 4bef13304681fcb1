// File: fitting_models.h
//
// The model of a stream: the one that it names, or one that fits its skin. If
// none does, the error says what a client can do: use another model of this
// server, or train one.
//
//   TACTUS_ASSIGN_OR_RETURN(PinnedModel pinned, FindModel(models, settings));
//
// Thread-safe: a free function without state.
#pragma once

#include "absl/status/statusor.h"
#include "core/stream/stream_settings.h"
#include "server/session/model_source.h"

namespace tactus::internal::server {

// Without a name, "default" if it fits the stream, else the first by name of
// the models whose newest version does; its name becomes that of `settings`.
// MODEL_NOT_FOUND for a name that is not there; INVALID_CONFIG or
// GEOMETRY_MISMATCH, as ContactPipeline::Check, if no model serves the stream,
// with the names of models that would, or with what all models need and how to
// train one.
absl::StatusOr<PinnedModel> FindModel(const ModelSource& models,
                                      StreamSettings& settings);

}  // namespace tactus::internal::server
