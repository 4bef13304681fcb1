// File: control_handlers.h
//
// Handlers of control calls from functions of typed messages.
//
//   control.Add("/tactus.v1.ModelService/ListAliases", Role::kRobot,
//               Unary<v1::ListAliasesRequest,
//               v1::ListAliasesResponse>(answer));
//
// Thread-safe: function templates without state.
#pragma once

#include <functional>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "grpcpp/impl/codegen/proto_utils.h"
#include "server/rpc/control_service.h"

namespace tactus::server {

// Reads the next message; false in `more` after the last one.
// MALFORMED_REQUEST.
template <typename Message>
absl::Status ReadMessage(ControlStream& stream, Message* message, bool* more) {
  grpc::ByteBuffer bytes;
  TACTUS_RETURN_IF_ERROR(stream.Read(&bytes, more));
  if (!*more) return absl::OkStatus();
  const size_t size = bytes.Length();
  if (!grpc::SerializationTraits<Message>::Deserialize(&bytes, message).ok()) {
    return MalformedRequest(size);
  }
  return absl::OkStatus();
}

template <typename Message>
absl::Status WriteMessage(ControlStream& stream, const Message& message) {
  grpc::ByteBuffer bytes;
  bool own = false;
  grpc::SerializationTraits<Message>::Serialize(message, &bytes, &own)
      .IgnoreError();
  return stream.Write(bytes);
}

// The one request of a call. EMPTY_REQUEST if there is none.
template <typename Request>
absl::Status ReadRequest(ControlStream& stream, Request* request) {
  bool more = false;
  TACTUS_RETURN_IF_ERROR(ReadMessage(stream, request, &more));
  return more ? absl::OkStatus() : EmptyRequest();
}

// One request, one response.
template <typename Request, typename Response>
ControlService::Handler Unary(
    std::function<absl::StatusOr<Response>(const Request&, const Caller&)>
        answer) {
  return [answer = std::move(answer)](ControlStream& stream) -> absl::Status {
    Request request;
    TACTUS_RETURN_IF_ERROR(ReadRequest(stream, &request));
    TACTUS_ASSIGN_OR_RETURN(const Response response,
                            answer(request, stream.caller()));
    return WriteMessage(stream, response);
  };
}

// One request; `answer` writes any number of responses.
template <typename Request>
ControlService::Handler ServerStream(
    std::function<absl::Status(const Request&, ControlStream&)> answer) {
  return [answer = std::move(answer)](ControlStream& stream) -> absl::Status {
    Request request;
    TACTUS_RETURN_IF_ERROR(ReadRequest(stream, &request));
    return answer(request, stream);
  };
}

}  // namespace tactus::server
