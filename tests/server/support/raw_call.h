// File: raw_call.h
//
// Calls a method by name with bytes, as a tool without our protos would.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "client/stream/status.h"
#include "grpcpp/channel.h"
#include "grpcpp/generic/generic_stub.h"

namespace tactus::internal::testing {

struct RawAnswer {
  absl::Status status;
  // Bytes of the last message that came.
  std::string bytes;
};

struct RawOptions {
  // Value of the metadata `authorization`; empty: none.
  std::string authorization = {};
  // Cancels the call after its first answer.
  bool first_only = false;
};

// Sends `bytes` as the only message and half-closes.
inline RawAnswer RawCall(const std::shared_ptr<grpc::Channel>& channel,
                         const std::string& method, const std::string& bytes,
                         const RawOptions& options = {}) {
  RawAnswer answer;
  grpc::GenericStub stub(channel);
  grpc::ClientContext context;
  if (!options.authorization.empty()) {
    context.AddMetadata("authorization", options.authorization);
  }
  grpc::CompletionQueue queue;
  const auto next = [&queue] {
    void* tag;
    bool ok = false;
    return queue.Next(&tag, &ok) && ok;
  };
  auto rpc = stub.PrepareCall(&context, method, &queue);
  rpc->StartCall(nullptr);
  next();
  const grpc::Slice slice(bytes);
  rpc->WriteLast(grpc::ByteBuffer(&slice, 1), {}, nullptr);
  next();
  grpc::ByteBuffer read;
  while (rpc->Read(&read, nullptr), next()) {
    if (options.first_only) context.TryCancel();
    std::vector<grpc::Slice> slices;
    answer.bytes.clear();
    if (!read.Dump(&slices).ok()) continue;
    for (const grpc::Slice& part : slices) {
      answer.bytes.append(reinterpret_cast<const char*>(part.begin()),
                          part.size());
    }
  }
  grpc::Status status;
  rpc->Finish(&status, nullptr);
  next();
  answer.status = client::FromGrpcStatus(status);
  return answer;
}

}  // namespace tactus::internal::testing
