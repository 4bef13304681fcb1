// File: fitting_models.h
//
// What a client can do whose skin does not fit the model that it named: use
// another model of this server, or train one.
//
//   const absl::Status fits =
//       ContactPipeline::Check(settings.layout, *pinned.model,
//                              settings.pipeline);
//   if (!fits.ok()) return NameFittingModels(fits, pinned, settings, models);
//
// Thread-safe: a free function without state.
#pragma once

#include "absl/status/status.h"
#include "core/stream/stream_settings.h"
#include "server/session/model_source.h"

namespace tactus::server {

// `misfit`, which is why `named` does not serve the stream, with the names of
// models that do. If there are none, it says how to train one.
absl::Status NameFittingModels(const absl::Status& misfit,
                               const PinnedModel& named,
                               const StreamSettings& settings,
                               const ModelSource& models);

}  // namespace tactus::server
