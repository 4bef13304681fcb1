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

namespace tactus::internal::testing {

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
  v1::Question* hardness = started->add_questions();
  hardness->set_name("hardness");
  hardness->set_kind(v1::Question::KIND_PROPERTY);
  hardness->add_values("hard");
  hardness->add_values("soft");
  v1::Question* mobility = started->add_questions();
  mobility->set_name("mobility");
  mobility->set_kind(v1::Question::KIND_STATE);
  mobility->add_values("unmoved");
  mobility->add_values("moved");
  for (const char* name : {"HU", "HM", "SU", "SM"}) {
    started->add_class_names(name);
    hardness->add_value_of_class(name[0] == 'S');
    mobility->add_value_of_class(name[1] == 'M');
  }
  started->mutable_geometry()->set_rows(16);
  started->mutable_geometry()->set_columns(24);
  return response;
}

// With one contact and all that a stream may ask for.
inline v1::ClassifyContactResponse GoodAnswer(uint64_t sequence) {
  v1::ClassifyContactResponse response;
  v1::Answer* answer = response.mutable_answer();
  answer->set_sequence(sequence);
  v1::Contact* contact = answer->add_contacts();
  contact->set_id(1);
  contact->set_state(v1::Contact::STATE_TOUCHING);
  contact->set_onset_sequence(1);
  contact->set_motion_m(0);
  contact->mutable_patch()->set_area_taxels(4);
  v1::ContactScores* scores = answer->mutable_diagnostics()->add_contacts();
  for (int k = 0; k < 4; ++k) {
    contact->add_probability(0.25);
    scores->add_log_likelihood(-1);
    scores->add_hmm_probability(0.25);
  }
  for (int q = 0; q < 2; ++q) {
    v1::QuestionAnswer* question = contact->add_answers();
    question->add_probability(0.5);
    question->add_probability(0.5);
  }
  return response;
}

}  // namespace tactus::internal::testing
