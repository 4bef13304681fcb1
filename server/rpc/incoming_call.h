// File: incoming_call.h
//
// IncomingCall: what each call of a queue has from the request for it until it
// is deleted: its place on the queue, its context, its peer, and its place in
// the arrival gate until another limit counts it.
//
//   IncomingCall call(queue);  // before gRPC is asked for the next call
//   absl::Status status =      // a call has come
//       call.Arrive([&] { return gate.Enter(call.peer()); });
//
// A member of the object that carries the call. Everything, including the
// constructor, runs on the queue's thread.
#pragma once

#include <string>

#include "grpcpp/server_context.h"
#include "server/ops/peer.h"
#include "server/rpc/call_queue.h"

namespace tactus::internal::server {

// `Context`: grpc::ServerContext or a class derived from it.
template <typename Context>
class BasicIncomingCall {
 public:
  // `queue` must outlive the call and serves until the call is deleted.
  explicit BasicIncomingCall(CallQueue* queue) : queue_(queue) {
    queue_->Enter();
  }
  ~BasicIncomingCall() { queue_->Leave(); }

  BasicIncomingCall(const BasicIncomingCall&) = delete;
  BasicIncomingCall& operator=(const BasicIncomingCall&) = delete;

  // The call has come. `admit` asks the limit that counts the call from then
  // on, and returns an absl::Status or absl::StatusOr. The call leaves the
  // arrival gate if that is OK, else when it is deleted. Returns what `admit`
  // returned.
  template <typename Admit>
  auto Arrive(Admit admit) {
    Arrive();
    auto admitted = admit();
    if (admitted.ok()) arrival_.Admit();
    return admitted;
  }
  // The call has come, and no other limit counts it.
  void Arrive() {
    arrival_.Arrive();
    peer_ = PeerOf(context_.peer());
  }

  CallQueue* queue() const { return queue_; }
  Context* context() { return &context_; }
  const Context& context() const { return context_; }
  // The peer that made the call, as PeerOf names it; empty before Arrive.
  const std::string& peer() const { return peer_; }

 private:
  CallQueue* const queue_;
  ArrivalGate::Request arrival_{queue_->arrivals()};
  Context context_;
  std::string peer_;
};

using IncomingCall = BasicIncomingCall<grpc::ServerContext>;

}  // namespace tactus::internal::server
