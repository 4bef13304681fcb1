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
#include "core/base/wire_check.h"
#include "grpcpp/impl/codegen/proto_utils.h"
#include "grpcpp/support/proto_buffer_reader.h"
#include "server/rpc/control_service.h"
#include "server/rpc/request_limits.h"

namespace tactus::internal::server {

// Parses a message of a caller. This is the one place where these services do
// so: the bytes are compared with the limit of their RPC before, and fields
// that the message's type does not know are refused, so that none is ever
// stored. MESSAGE_TOO_LARGE, MALFORMED_REQUEST.
template <typename Message>
absl::Status ParseRequestBytes(grpc::ByteBuffer* bytes, Message* message) {
  const google::protobuf::Descriptor& type = *Message::descriptor();
  const size_t size = bytes->Length();
  const size_t limit = MaxRequestBytes(type);
  if (size > limit) return MessageTooLarge(size, limit);
  grpc::ProtoBufferReader reader(bytes);
  const WireCheck check = CheckWire(type, &reader);
  if (!check.fault.empty()) return NotTheRequest(type.full_name(), check.fault);
  if (!grpc::SerializationTraits<Message>::Deserialize(bytes, message).ok()) {
    return NotTheRequest(type.full_name(), "a text in it is not UTF-8");
  }
  return absl::OkStatus();
}

// Reads the next message; false in `more` after the last one. The errors of
// ControlStream::Read and ParseRequestBytes.
template <typename Message>
absl::Status ReadMessage(ControlStream& stream, Message* message, bool* more) {
  grpc::ByteBuffer bytes;
  TACTUS_RETURN_IF_ERROR(stream.Read(&bytes, more));
  return *more ? ParseRequestBytes(&bytes, message) : absl::OkStatus();
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

}  // namespace tactus::internal::server
