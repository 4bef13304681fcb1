// File: scripted_server.h
//
// ScriptedServer: a gRPC server on loopback whose ClassifyContact does what a
// test says, for tests of clients against servers that misbehave.
//
//   ScriptedServer server([](grpc::ServerContext*, auto* stream) {
//     stream->Write(GoodStarted());
//     return grpc::Status::OK;
//   });
//   const auto channel = MakeChannel(server.address());
//
// Each call runs on a thread of the server. The destructor cancels all calls.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "grpcpp/security/server_credentials.h"
#include "grpcpp/server.h"
#include "grpcpp/server_builder.h"
#include "tactus/v1/contact.grpc.pb.h"

namespace tactus::testing {

class ScriptedServer final : private v1::ContactService::Service {
 public:
  using Stream = grpc::ServerReaderWriter<v1::ClassifyContactResponse,
                                          v1::ClassifyContactRequest>;
  using Script = std::function<grpc::Status(grpc::ServerContext*, Stream*)>;

  explicit ScriptedServer(Script script) : script_(std::move(script)) {
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(),
                             &port_);
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
  }
  ~ScriptedServer() { Stop(); }

  // Cancels all calls and takes no more. May be called from another thread.
  void Stop() { server_->Shutdown(std::chrono::system_clock::now()); }

  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }

  // Keeps a call open, without a word, until its client leaves.
  static grpc::Status SayNothing(grpc::ServerContext* context) {
    while (!context->IsCancelled()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return grpc::Status::CANCELLED;
  }

 private:
  grpc::Status ClassifyContact(grpc::ServerContext* context,
                               Stream* stream) override {
    return script_(context, stream);
  }

  const Script script_;
  int port_ = 0;
  std::unique_ptr<grpc::Server> server_;
};

// Responses as a good server sends them: four classes on cody-forearm.
inline v1::ClassifyContactResponse GoodStarted() {
  v1::ClassifyContactResponse response;
  v1::StreamStarted* started = response.mutable_started();
  for (const char* name : {"HU", "HM", "SU", "SM"}) {
    started->add_class_names(name);
  }
  started->mutable_geometry()->set_rows(16);
  started->mutable_geometry()->set_columns(24);
  return response;
}

inline v1::ClassifyContactResponse GoodPosterior(uint64_t sequence) {
  v1::ClassifyContactResponse response;
  v1::Posterior* posterior = response.mutable_posterior();
  posterior->set_sequence(sequence);
  posterior->set_contact_state(v1::CONTACT_STATE_IN_CONTACT);
  posterior->set_onset_sequence(1);
  for (int k = 0; k < 4; ++k) {
    posterior->add_log_likelihood(-1);
    posterior->add_probability(0.25);
    posterior->add_hmm_probability(0.25);
  }
  return response;
}

}  // namespace tactus::testing
