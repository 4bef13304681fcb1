// File: byte_stream.h
//
// ByteStream: one stream that plays a FrameScript as fast as answers come, to
// tactusd or to an echo server, with the same code and so at the same cost.
//
//   TACTUS_ASSIGN_OR_RETURN(auto stream, ByteStream::Open(channel, &script));
//   TACTUS_RETURN_IF_ERROR(stream->Play(1000, 16));
//
// gRPC's blocking interface, all on the caller's thread. Not thread-safe.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "client/tools/load/frame_script.h"
#include "grpcpp/channel.h"
#include "grpcpp/client_context.h"
#include "grpcpp/support/byte_buffer.h"
#include "grpcpp/support/sync_stream.h"

namespace tactus::client {

class ByteStream {
 public:
  struct Options {
    // The answers are an echo's: all the same.
    bool echo = false;
    // Play only the script's untouched frames, over and over.
    bool untouched = false;
  };

  // Sends the configuration and takes the answer to it. `script` must outlive
  // the stream.
  static absl::StatusOr<std::unique_ptr<ByteStream>> Open(
      const std::shared_ptr<grpc::Channel>& channel, const FrameScript* script,
      const Options& options);
  ~ByteStream();

  // One message at a time: adds the microseconds of each to `rtt_us`.
  absl::Status PingPong(int messages, std::vector<double>* rtt_us);
  // Up to `window` messages unanswered. Answers superseded by newer ones count
  // as such, not as answered. Sums both since Open below.
  absl::Status Play(int messages, int window);

  uint64_t answered() const { return answered_; }
  uint64_t superseded() const { return superseded_; }
  // One answer, as it was on the wire, of about the mean size.
  const std::string& typical_answer() const { return typical_answer_; }

 private:
  ByteStream(const std::shared_ptr<grpc::Channel>& channel,
             const FrameScript* script, const Options& options);
  // How the stream ended; nothing may follow.
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
  // Messages that need no more waiting for.
  uint64_t settled_ = 0;
  uint64_t answered_ = 0;
  uint64_t superseded_ = 0;
  uint64_t bytes_ = 0;
  std::string typical_answer_;
};

}  // namespace tactus::client
