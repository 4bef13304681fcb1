// File: grpc_call.h
//
// GrpcCall: one call whose requests and responses are streams of messages, as
// HTTP/2 carries them: what its listener has to send, and what came for it.
//
//   GrpcCall call(&listener, "/tactus.v1.ContactService/ClassifyContact");
//   call.ReadAll();
//   connection->Start(&call);   // asks the listener for messages
//   call.Resume();              // it has more of them
//
// The listener outlives the call. Not thread-safe: the thread that serves the
// connection calls it, and is the one that calls the listener.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace tactus::internal::client {

class GrpcCall {
 public:
  enum class Next { kMessage, kLater, kNoMore };

  class Listener {
   public:
    // Appends the bytes of one message to `out`, or none: then it will Resume
    // the call, or has sent all that it ever will.
    virtual Next TakeMessage(std::string* out) = 0;
    virtual void OnMessage(absl::string_view message) = 0;
    // Once, after the last message. A status of the server has its reason.
    virtual void OnEnded(const absl::Status& status) = 0;

   protected:
    ~Listener() = default;
  };
  // Where a call's frames go. It serves a call from Start to Forget.
  class Carrier {
   public:
    virtual void Resume(GrpcCall* call) = 0;
    // The call took so many bytes: the server may send as many more.
    virtual void Consume(GrpcCall* call, size_t bytes) = 0;
    // The call has ended. Resets its stream if that is still open.
    virtual void Forget(GrpcCall* call) = 0;

   protected:
    ~Carrier() = default;
  };

  // `method` has static storage.
  GrpcCall(Listener* listener, absl::string_view method)
      : listener_(listener), method_(method) {}
  ~GrpcCall() {
    if (carrier_ != nullptr) carrier_->Forget(this);
  }
  GrpcCall(const GrpcCall&) = delete;
  GrpcCall& operator=(const GrpcCall&) = delete;

  void Resume() {
    if (carrier_ != nullptr) carrier_->Resume(this);
  }
  // Takes one more message, or all that come. Without it none is taken, and
  // the server has to wait once the flow-control window is full.
  void ReadOne();
  void ReadAll();
  // Ends the call.
  void Cancel();

  absl::string_view method() const { return method_; }

  // For its carrier. `stream`: its number in HTTP/2.
  void OnStarted(Carrier* carrier, int32_t stream);
  int32_t stream() const { return stream_; }
  // Copies up to `size` bytes to be sent into `out`. With none, `next` says
  // why.
  size_t Send(uint8_t* out, size_t size, Next* next);
  void OnHeader(absl::string_view name, absl::string_view value);
  void OnData(absl::string_view bytes);
  // The server has sent all that it will: the status is in its headers.
  void OnServerEnded();
  // The stream is gone, for `fault` unless that is OK.
  void OnClosed(const absl::Status& fault);
  // Ends the call without the server.
  void End(const absl::Status& status);
  // The server, or this side, has not ended the stream.
  bool is_open() const { return !closed_ && !(sent_all_ && server_ended_); }

 private:
  // Tells the listener what it wants to know.
  void Deliver();
  void Consume(size_t bytes);
  absl::Status StatusOfHeaders() const;

  Listener* const listener_;
  const absl::string_view method_;
  Carrier* carrier_ = nullptr;
  int32_t stream_ = -1;

  // What is left of the message that is being sent.
  std::string outgoing_;
  size_t sent_ = 0;
  bool sent_all_ = false;

  std::string incoming_;
  // How many of these bytes the server counts as not taken.
  size_t unconsumed_ = 0;
  uint64_t wanted_ = 0;
  static constexpr uint64_t kAll = std::numeric_limits<uint64_t>::max();

  std::string http_status_;
  std::string grpc_status_;
  std::string grpc_message_;
  std::string grpc_details_;
  // The server's last word, until all messages before it are delivered.
  std::optional<absl::Status> last_;
  bool server_ended_ = false;
  bool closed_ = false;
  bool ended_ = false;
};

}  // namespace tactus::internal::client
