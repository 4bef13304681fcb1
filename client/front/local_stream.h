// File: local_stream.h
//
// LocalStream: the public Stream (tactus/stream.h) on a model in this process.
//
//   TACTUS_ASSIGN_OR_RETURN(const std::unique_ptr<Stream> stream,
//                           OpenLocalStream(model, skin, options));
//   return stream->Push(frame);
//
// Callbacks run within the calls. A frame allocates nothing once answers have
// grown to their size. Thread-safe as tactus/stream.h says.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "core/classify/compiled_model.h"
#include "tactus/stream.h"

namespace tactus::internal::client {

// A model and what its streams call it.
struct LocalModel {
  std::shared_ptr<const CompiledModel> model;
  // StreamInfo::model_version and model_sha256.
  std::string version;
  std::string sha256;
};

// The errors that a server gives for the same skin and options.
absl::StatusOr<std::unique_ptr<Stream>> OpenLocalStream(
    const LocalModel& model, const Skin& skin, const StreamOptions& options);

}  // namespace tactus::internal::client
