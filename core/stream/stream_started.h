// File: stream_started.h
//
// The first message of a stream: the names and the questions of its model, the
// skin, and the limits of the contract.
//
//   v1::StreamStarted started;
//   WriteStarted(settings, *model, &started);
//   started.set_model_version("models/default/versions/1");
//
// Thread-safe: a free function without state.
#pragma once

#include "core/classify/compiled_model.h"
#include "core/stream/stream_settings.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal {

// Fills in all that follows from settings and model; the version's name and
// SHA-256, the stream's id, the server and its timeout stay as they are.
void WriteStarted(const StreamSettings& settings, const CompiledModel& model,
                  v1::StreamStarted* started);

}  // namespace tactus::internal
