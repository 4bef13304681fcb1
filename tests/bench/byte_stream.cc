#include "tests/bench/byte_stream.h"

#include <chrono>
#include <cmath>

#include "client/stream/status.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "grpcpp/impl/codegen/proto_utils.h"
#include "grpcpp/impl/rpc_method.h"
#include "grpcpp/support/proto_buffer_reader.h"

namespace tactus::internal::client {
namespace {

using std::chrono::steady_clock;

constexpr char kMethod[] = "/tactus.v1.ContactService/ClassifyContact";

}  // namespace

ByteStream::ByteStream(const std::shared_ptr<grpc::Channel>& channel,
                       const FrameScript* script, const Options& options)
    : script_(script), options_(options) {
  const grpc::internal::RpcMethod method(
      kMethod, grpc::internal::RpcMethod::RpcType::BIDI_STREAMING, channel);
  rpc_.reset(grpc::internal::ClientReaderWriterFactory<
             grpc::ByteBuffer, grpc::ByteBuffer>::Create(channel.get(), method,
                                                         &context_));
}

absl::StatusOr<std::unique_ptr<ByteStream>> ByteStream::Open(
    const std::shared_ptr<grpc::Channel>& channel, const FrameScript* script,
    const Options& options) {
  std::unique_ptr<ByteStream> stream(new ByteStream(channel, script, options));
  v1::ClassifyContactRequest request;
  *request.mutable_config() = script->config();
  const grpc::Slice slice(request.SerializeAsString());
  if (!stream->rpc_->Write(grpc::ByteBuffer(&slice, 1)) ||
      !stream->rpc_->Read(&stream->read_)) {
    return stream->End();
  }
  return stream;
}

ByteStream::~ByteStream() {
  if (ended_) return;
  rpc_->WritesDone();
  while (rpc_->Read(&read_)) {
  }
  End().IgnoreError();
}

absl::Status ByteStream::End() {
  ended_ = true;
  const absl::Status status = FromGrpcStatus(rpc_->Finish());
  return status.ok() ? StreamFinished() : status;
}

void ByteStream::KeepTypicalAnswer() {
  const double mean =
      static_cast<double>(bytes_) / static_cast<double>(answered_);
  const auto distance = [mean](size_t size) {
    return std::abs(static_cast<double>(size) - mean);
  };
  if (distance(response_.ByteSizeLong()) < distance(typical_answer_.size())) {
    typical_answer_ = response_.SerializeAsString();
  }
}

absl::Status ByteStream::Send() {
  // Frames are numbered from 1 and there is one a message.
  const size_t length =
      options_.untouched ? script_->untouched_messages() : script_->size();
  std::string message;
  script_->AppendMessage(sent_ % length, sent_ + 1, &message);
  const grpc::Slice bytes(message);
  if (!rpc_->Write(grpc::ByteBuffer(&bytes, 1))) return End();
  ++sent_;
  return absl::OkStatus();
}

absl::Status ByteStream::Receive() {
  if (!rpc_->Read(&read_)) return End();
  bytes_ += read_.Length();
  grpc::ProtoBufferReader reader(&read_);
  if (!response_.ParseFromZeroCopyStream(&reader)) {
    return MalformedRequest(read_.Length());
  }
  const v1::Answer& posterior = response_.answer();
  ++answered_;
  if (options_.echo) {
    ++settled_;
    return absl::OkStatus();
  }
  KeepTypicalAnswer();
  superseded_ = posterior.superseded();
  if (posterior.sequence() <= settled_ || posterior.sequence() > sent_) {
    return NumericalFailure(absl::StrCat("frame ", posterior.sequence(),
                                         " was answered after frame ",
                                         settled_));
  }
  settled_ = posterior.sequence();
  return absl::OkStatus();
}

absl::Status ByteStream::PingPong(int messages, std::vector<double>* rtt_us) {
  for (int i = 0; i < messages; ++i) {
    const auto start = steady_clock::now();
    TACTUS_RETURN_IF_ERROR(Send());
    TACTUS_RETURN_IF_ERROR(Receive());
    const std::chrono::duration<double, std::micro> rtt =
        steady_clock::now() - start;
    rtt_us->push_back(rtt.count());
  }
  return absl::OkStatus();
}

absl::Status ByteStream::Play(int messages, int window) {
  const uint64_t last = sent_ + messages;
  while (settled_ < last) {
    while (sent_ < last && sent_ - settled_ < static_cast<uint64_t>(window)) {
      TACTUS_RETURN_IF_ERROR(Send());
    }
    TACTUS_RETURN_IF_ERROR(Receive());
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal::client
