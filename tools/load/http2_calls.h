// File: http2_calls.h
//
// Http2Calls: the calls of one connection as bytes of HTTP/2 (RFC 9113, by
// nghttp2). It reads and writes no socket.
//
//   Http2Calls calls("localhost", "http", [&] { touched = true; });
//   calls.Start(&call);
//   TACTUS_RETURN_IF_ERROR(calls.Collect(64 * 1024, &to_send));
//   TACTUS_RETURN_IF_ERROR(calls.Receive(what_came));
//
// Calls must end, or be deleted, before it. What waits for the server takes as
// much memory as the windows of flow control let it send: 64 KiB a connection.
// Not thread-safe; a listener may use its call, but deletes none.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <unordered_set>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "tools/load/grpc_call.h"

struct nghttp2_session;

namespace tactus::internal::client {

class Http2Calls final : public GrpcCall::Carrier {
 public:
  // `on_work` is called when there may be something to send.
  Http2Calls(std::string authority, std::string scheme,
             std::function<void()> on_work);
  ~Http2Calls();
  Http2Calls(const Http2Calls&) = delete;
  Http2Calls& operator=(const Http2Calls&) = delete;

  // The call ends at once if the connection takes no more.
  void Start(GrpcCall* call);
  // False once the server or an error has ended the connection.
  bool takes_calls() const;

  // UNAVAILABLE if the server breaks the protocol.
  absl::Status Receive(absl::string_view bytes);
  // Appends what is to be sent until `out` has about `most` bytes.
  absl::Status Collect(size_t most, std::string* out);
  // Ends all calls: the connection is gone.
  void Fail(const absl::Status& status);

  void Resume(GrpcCall* call) override;
  void Consume(GrpcCall* call, size_t bytes) override;
  void Forget(GrpcCall* call) override;

 private:
  struct Callbacks;
  struct DeleteSession {
    void operator()(nghttp2_session* session) const;
  };

  void SubmitRequest(GrpcCall* call);

  const std::string authority_;
  const std::string scheme_;
  const std::function<void()> on_work_;
  std::unique_ptr<nghttp2_session, DeleteSession> session_;
  std::unordered_set<GrpcCall*> calls_;
  bool failed_ = false;
};

}  // namespace tactus::internal::client
