// File: byte_stream.h
//
// ByteStream: one stream that plays a FrameScript as fast as answers arrive. It
// uses the same code for tactusd and for an echo server, so its own cost is
// equal for both.
//
//   TACTUS_ASSIGN_OR_RETURN(auto stream, ByteStream::Open(channel, &script));
//   TACTUS_RETURN_IF_ERROR(stream->Play(1000, 16));
//
// Uses gRPC's blocking interface on the caller's thread. Not thread-safe.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "grpcpp/channel.h"
#include "grpcpp/client_context.h"
#include "grpcpp/support/byte_buffer.h"
#include "grpcpp/support/sync_stream.h"
#include "tools/load/frame_script.h"

namespace tactus::internal::client {

class ByteStream {
 public:
  struct Options {
    // The server is an echo server: all answers are equal.
    bool echo = false;
    // Play only the script's untouched frames, over and over.
    bool untouched = false;
  };

  // Sends the configuration and reads the answer to it. `script` must outlive
  // the stream.
  static absl::StatusOr<std::unique_ptr<ByteStream>> Open(
      const std::shared_ptr<grpc::Channel>& channel, const FrameScript* script,
      const Options& options);
  ~ByteStream();

  // Sends one message at a time and appends the microseconds of each round trip
  // to `rtt_us`.
  absl::Status PingPong(int messages, std::vector<double>* rtt_us);
  // Keeps up to `window` messages unanswered. answered() and superseded() count
  // since Open. An answer that a newer one replaced counts as superseded only.
  absl::Status Play(int messages, int window);

  uint64_t answered() const { return answered_; }
  uint64_t superseded() const { return superseded_; }
  // One answer of about the mean size, as received.
  const std::string& typical_answer() const { return typical_answer_; }

 private:
  ByteStream(const std::shared_ptr<grpc::Channel>& channel,
             const FrameScript* script, const Options& options);
  // Ends the stream and returns its status. No call may follow.
  absl::Status End();
  absl::Status Send();
  absl::Status Receive();
  // Keeps the answer that was read if it is nearer to the mean size.
  void KeepTypicalAnswer();

  const FrameScript* const script_;
  const Options options_;
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<grpc::ByteBuffer, grpc::ByteBuffer>>
      rpc_;
  bool ended_ = false;
  grpc::ByteBuffer read_;
  v1::ClassifyContactResponse response_;
  uint64_t sent_ = 0;
  // Number of messages that are answered or superseded.
  uint64_t settled_ = 0;
  uint64_t answered_ = 0;
  uint64_t superseded_ = 0;
  uint64_t bytes_ = 0;
  std::string typical_answer_;
};

}  // namespace tactus::internal::client
