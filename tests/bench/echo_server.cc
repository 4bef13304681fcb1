#include "tests/bench/echo_server.h"

#include <atomic>
#include <fstream>
#include <memory>
#include <thread>

#include "CLI/CLI.hpp"
#include "absl/strings/escaping.h"
#include "core/base/call_event.h"
#include "core/base/errors.h"
#include "grpcpp/alarm.h"
#include "grpcpp/generic/async_generic_service.h"
#include "grpcpp/server.h"
#include "grpcpp/server_builder.h"

namespace tactus::internal::client {
namespace {

class EchoReactor : public grpc::ServerGenericBidiReactor {
 public:
  explicit EchoReactor(const grpc::ByteBuffer* answer) : answer_(answer) {
    StartRead(&read_);
  }
  void OnReadDone(bool ok) override {
    if (!ok) {
      Finish(grpc::Status::OK);
      return;
    }
    if (owed_.fetch_add(1) == 0) StartWrite(answer_);
    StartRead(&read_);
  }
  void OnWriteDone(bool ok) override {
    if (ok && owed_.fetch_sub(1) > 1) StartWrite(answer_);
  }
  void OnDone() override { delete this; }

 private:
  const grpc::ByteBuffer* const answer_;
  grpc::ByteBuffer read_;
  std::atomic<int> owed_ = 0;
};

class CallbackEcho : public grpc::CallbackGenericService {
 public:
  explicit CallbackEcho(const grpc::ByteBuffer* answer) : answer_(answer) {}
  grpc::ServerGenericBidiReactor* CreateReactor(
      grpc::GenericCallbackServerContext*) override {
    return new EchoReactor(answer_);
  }

 private:
  const grpc::ByteBuffer* const answer_;
};

// One stream of a completion queue. Its client takes all answers before it
// ends, so that nothing is in flight when it is deleted.
class QueueEcho {
 public:
  static void Await(grpc::AsyncGenericService* service,
                    grpc::ServerCompletionQueue* queue,
                    const grpc::ByteBuffer* answer) {
    auto* echo = new QueueEcho(service, queue, answer);
    service->RequestCall(&echo->context_, &echo->stream_, queue, queue,
                         echo->started_.tag());
  }

 private:
  QueueEcho(grpc::AsyncGenericService* service,
            grpc::ServerCompletionQueue* queue, const grpc::ByteBuffer* answer)
      : service_(service), queue_(queue), answer_(answer) {}

  void OnStarted(bool ok) {
    if (!ok) return;
    Await(service_, queue_, answer_);
    stream_.Read(&read_, read_done_.tag());
  }
  void OnRead(bool ok) {
    if (!ok) {
      stream_.Finish(grpc::Status::OK, finished_.tag());
      return;
    }
    if (owed_.fetch_add(1) == 0) stream_.Write(*answer_, write_done_.tag());
    stream_.Read(&read_, read_done_.tag());
  }
  void OnWritten(bool ok) {
    if (ok && owed_.fetch_sub(1) > 1)
      stream_.Write(*answer_, write_done_.tag());
  }
  void OnFinished(bool) { delete this; }

  grpc::AsyncGenericService* const service_;
  grpc::ServerCompletionQueue* const queue_;
  const grpc::ByteBuffer* const answer_;
  grpc::GenericServerContext context_;
  grpc::GenericServerAsyncReaderWriter stream_{&context_};
  grpc::ByteBuffer read_;
  std::atomic<int> owed_ = 0;
  using Event = MemberEvent<QueueEcho>;
  Event started_{this, &QueueEcho::OnStarted};
  Event read_done_{this, &QueueEcho::OnRead};
  Event write_done_{this, &QueueEcho::OnWritten};
  Event finished_{this, &QueueEcho::OnFinished};
};

void ServeQueue(grpc::ServerCompletionQueue* queue) {
  void* tag = nullptr;
  bool ok = false;
  while (queue->Next(&tag, &ok)) {
    static_cast<CallEvent*>(tag)->OnEvent(ok);
  }
}

}  // namespace

void AddEchoFlags(EchoOptions& options, CLI::App& command) {
  command.add_option("--port-file", options.port_file,
                     "Where to tell the port");
  command.add_option("--answer", options.answer, "Every answer, hexadecimal")
      ->required();
  command.add_flag("--callbacks", options.callbacks,
                   "In place of a completion queue and its thread");
}

absl::Status RunEchoServer(const EchoOptions& options) {
  const grpc::Slice bytes(absl::HexStringToBytes(options.answer));
  const grpc::ByteBuffer answer(&bytes, 1);
  CallbackEcho callback(&answer);
  grpc::AsyncGenericService async;
  grpc::ServerBuilder builder;
  int port = 0;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(),
                           &port);
  std::unique_ptr<grpc::ServerCompletionQueue> queue;
  if (options.callbacks) {
    builder.RegisterCallbackGenericService(&callback);
  } else {
    builder.RegisterAsyncGenericService(&async);
    queue = builder.AddCompletionQueue();
  }
  const auto server = builder.BuildAndStart();
  if (server == nullptr) return IoError("127.0.0.1", "cannot listen there");
  std::thread thread;
  if (queue != nullptr) {
    QueueEcho::Await(&async, queue.get(), &answer);
    thread = std::thread(ServeQueue, queue.get());
  }
  std::ofstream(options.port_file) << port << std::endl;
  server->Wait();
  if (thread.joinable()) thread.join();
  return absl::OkStatus();
}

}  // namespace tactus::internal::client
