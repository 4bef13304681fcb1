// File: remote_stream.h
//
// RemoteStream: the public Stream (tactus/stream.h) on a stream to a server: a
// ContactStream, or a ResumableStream, which goes on after a loss.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const std::unique_ptr<Stream> stream,
//       OpenRemoteStream(channel, skin, options, {.token = token}));
//   return stream->Push(frame);
//
// Resumes unless `resume.resume_for` is 0. The callbacks run on a thread of the
// stream. Thread-safe as tactus/stream.h says.
#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "client/stream/resumable_stream.h"
#include "grpcpp/channel.h"
#include "tactus/stream.h"

namespace tactus::internal::client {

// The server's errors, and INVALID_CONFIG for options that are out of range.
absl::StatusOr<std::unique_ptr<Stream>> OpenRemoteStream(
    const std::shared_ptr<grpc::Channel>& channel, const Skin& skin,
    const StreamOptions& options, const ResumeOptions& resume);

}  // namespace tactus::internal::client
