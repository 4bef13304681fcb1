// File: server_calls.h
//
// ServerCalls: calls to servers whose messages stay bytes. No thread waits for
// a call: one takes what all of them bring.
//
//   ServerCalls calls;
//   auto call = std::make_shared<ServerCalls::Call>(token);
//   calls.Run(call, channel, "/tactus.v1.ModelService/ListAliases",
//             PageAnswer::kOne, request, [](ServerCalls::Reply reply) {});
//   call->Cancel();                       // any thread, also before Run
//   calls.Stop();                         // cancels all, and waits for them
//
// `done` comes once, on the thread of the object, also for a call that is
// cancelled; it does not come for calls that begin after Stop. Thread-safe. The
// destructor stops.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "absl/status/status.h"
#include "grpcpp/channel.h"
#include "grpcpp/client_context.h"
#include "grpcpp/completion_queue.h"
#include "grpcpp/generic/generic_stub.h"
#include "grpcpp/support/byte_buffer.h"
#include "tools/console/page_methods.h"

namespace tactus::internal::console {

class ServerCalls {
 public:
  struct Reply {
    absl::Status status;
    std::vector<grpc::ByteBuffer> messages;
  };
  using Done = std::function<void(Reply)>;

  class Call;

  ServerCalls();
  ~ServerCalls();

  ServerCalls(const ServerCalls&) = delete;
  ServerCalls& operator=(const ServerCalls&) = delete;

  void Run(std::shared_ptr<Call> call,
           const std::shared_ptr<grpc::Channel>& channel,
           const std::string& path, PageAnswer answer,
           const grpc::ByteBuffer& request, Done done);
  void Stop();

 private:
  void Take();
  void Forget(Call* call);

  grpc::CompletionQueue queue_;
  std::mutex mutex_;
  bool stopped_ = false;
  // Those that have not ended, which keeps them.
  std::set<std::shared_ptr<Call>> calls_;
  std::thread thread_;
};

// One call. Cancel is for any thread; all else is of ServerCalls.
class ServerCalls::Call {
 public:
  // `token` empty: none.
  explicit Call(const std::string& token);

  void Cancel() { context_.TryCancel(); }

 private:
  friend class ServerCalls;

  enum class Step { kBegin, kWrite, kRead, kFinish };

  // What follows a step that is done; false if the call has ended.
  bool Go(bool ok);
  // Keeps the message that was read; false if it is the last one.
  bool Keep();
  void Finish();
  void ReportEnd();

  grpc::ClientContext context_;
  std::unique_ptr<grpc::GenericClientAsyncReaderWriter> stream_;
  PageAnswer answer_ = PageAnswer::kOne;
  Step step_ = Step::kBegin;
  grpc::ByteBuffer request_;
  grpc::ByteBuffer message_;
  std::vector<grpc::ByteBuffer> messages_;
  size_t bytes_ = 0;
  grpc::Status status_;
  Done done_;
};

}  // namespace tactus::internal::console
