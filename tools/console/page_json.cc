#include "tools/console/page_json.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits_console.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "google/protobuf/any.pb.h"
#include "google/protobuf/descriptor.h"
#include "google/protobuf/message.h"
#include "google/protobuf/util/json_util.h"
#include "grpc/health/v1/health.pb.h"
#include "grpcpp/impl/codegen/proto_buffer_reader.h"
#include "tactus/v1/common.pb.h"

namespace tactus::internal::console {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

constexpr int kMaxDepth = 32;
constexpr absl::string_view kOwnErrorInfo =
    "type.googleapis.com/tactus.v1.ErrorInfo";

const google::protobuf::MethodDescriptor* DescriptorOf(
    const PageMethod& method) {
  // The linker leaves out messages that no code names.
  grpc::health::v1::HealthCheckRequest::descriptor();
  return google::protobuf::DescriptorPool::generated_pool()->FindMethodByName(
      method.FullName());
}

std::unique_ptr<Message> NewMessage(const Descriptor* type) {
  return std::unique_ptr<Message>(
      google::protobuf::MessageFactory::generated_factory()
          ->GetPrototype(type)
          ->New());
}

absl::Status NoSuchMethod(const PageMethod& method) {
  return InvalidConfig("method", method.FullName(),
                       "one that the console was built with");
}

// JSON of protobuf needs the names of types that the program has.
void NameDetails(v1::Status& status) {
  auto& details = *status.mutable_details();
  for (int i = details.size() - 1; i >= 0; --i) {
    v1::ErrorInfo info;
    if (absl::EndsWith(details[i].type_url(), ".ErrorInfo") &&
        info.ParseFromString(details[i].value())) {
      details[i].set_type_url(std::string(kOwnErrorInfo));
    } else {
      details.DeleteSubrange(i, 1);
    }
  }
}

// Also in the messages that `message` holds.
void NameAllDetails(Message& message) {
  if (auto* status = dynamic_cast<v1::Status*>(&message)) {
    return NameDetails(*status);
  }
  const auto& reflection = *message.GetReflection();
  std::vector<const FieldDescriptor*> fields;
  reflection.ListFields(message, &fields);
  for (const FieldDescriptor* field : fields) {
    if (field->cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE ||
        field->is_map()) {
      continue;
    }
    if (!field->is_repeated()) {
      NameAllDetails(*reflection.MutableMessage(&message, field));
      continue;
    }
    for (int i = 0; i < reflection.FieldSize(message, field); ++i) {
      NameAllDetails(*reflection.MutableRepeatedMessage(&message, field, i));
    }
  }
}

absl::StatusOr<std::string> JsonOfMessage(const Descriptor* type,
                                          const grpc::ByteBuffer& bytes) {
  const auto message = NewMessage(type);
  grpc::ByteBuffer copy = bytes;
  grpc::ProtoBufferReader reader(&copy);
  const bool parses = message->ParseFromZeroCopyStream(&reader);
  if (!parses || !reader.status().ok()) {
    return InvalidResponse("the message", "not to be read", type->full_name());
  }
  NameAllDetails(*message);
  google::protobuf::util::JsonPrintOptions options;
  options.preserve_proto_field_names = true;
  options.always_print_primitive_fields = true;
  std::string json;
  const auto status =
      google::protobuf::util::MessageToJsonString(*message, &json, options);
  if (!status.ok()) {
    return InvalidResponse("the message", std::string(status.message()),
                           "one that can be written as JSON");
  }
  return json;
}

// Objects and lists within each other, of text that is JSON.
int DepthOf(absl::string_view json) {
  int depth = 0;
  int deepest = 0;
  bool in_text = false;
  for (size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (c == '"') in_text = !in_text;
    if (c == '\\') ++i;
    if (in_text) continue;
    if (c == '{' || c == '[') deepest = std::max(deepest, ++depth);
    if (c == '}' || c == ']') --depth;
  }
  return deepest;
}

http::status HttpStatusOf(absl::StatusCode code) {
  switch (code) {
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kOutOfRange:
      return http::status::bad_request;
    case absl::StatusCode::kUnauthenticated:
      return http::status::unauthorized;
    case absl::StatusCode::kPermissionDenied:
      return http::status::forbidden;
    case absl::StatusCode::kNotFound:
      return http::status::not_found;
    case absl::StatusCode::kAlreadyExists:
    case absl::StatusCode::kAborted:
    case absl::StatusCode::kFailedPrecondition:
      return http::status::conflict;
    case absl::StatusCode::kResourceExhausted:
      return http::status::too_many_requests;
    case absl::StatusCode::kUnimplemented:
      return http::status::not_implemented;
    case absl::StatusCode::kUnavailable:
      return http::status::service_unavailable;
    case absl::StatusCode::kDeadlineExceeded:
      return http::status::gateway_timeout;
    default:
      return http::status::internal_server_error;
  }
}

}  // namespace

absl::StatusOr<grpc::ByteBuffer> RequestFromJson(const PageMethod& method,
                                                 const std::string& json) {
  const auto* descriptor = DescriptorOf(method);
  if (descriptor == nullptr) return NoSuchMethod(method);
  // The parser of protobuf takes more than JSON, and lists of any depth.
  if (!IsUtf8(json) || !client::Json::accept(json)) {
    return InvalidConfig("body", "something else", "JSON in UTF-8");
  }
  if (DepthOf(json) > kMaxDepth) {
    return InvalidConfig("levels of the body", DepthOf(json),
                         absl::StrCat("at most ", kMaxDepth));
  }
  const auto message = NewMessage(descriptor->input_type());
  const auto status =
      google::protobuf::util::JsonStringToMessage(json, message.get());
  if (!status.ok()) {
    return InvalidConfig(
        "body", Quoted(std::string(status.message())),
        absl::StrCat("JSON of ", descriptor->input_type()->full_name()));
  }
  const grpc::Slice slice(message->SerializeAsString());
  return grpc::ByteBuffer(&slice, 1);
}

absl::StatusOr<std::string> JsonOfReply(
    const PageMethod& method, const std::vector<grpc::ByteBuffer>& messages) {
  const auto* descriptor = DescriptorOf(method);
  if (descriptor == nullptr) return NoSuchMethod(method);
  const bool all = method.answer == PageAnswer::kAll;
  if (!all && messages.size() != 1) {
    return InvalidResponse("messages", messages.size(), "1");
  }
  std::string json = all ? "{\"messages\":[" : "";
  for (size_t i = 0; i < messages.size(); ++i) {
    TACTUS_ASSIGN_OR_RETURN(
        const std::string part,
        JsonOfMessage(descriptor->output_type(), messages[i]));
    absl::StrAppend(&json, i > 0 ? "," : "", part);
    if (json.size() > limits::kMaxPageReplyJsonBytes) {
      return InvalidResponse(
          "bytes of JSON", json.size(),
          absl::StrCat("at most ", limits::kMaxPageReplyJsonBytes));
    }
  }
  if (all) json += "]}";
  return json;
}

Response ErrorOfCall(const absl::Status& status) {
  const v1::ErrorInfo info = InfoOf(status);
  client::Json metadata = client::Json::object();
  for (const auto& [key, value] : info.metadata()) metadata[key] = value;
  return JsonResponse(HttpStatusOf(status.code()),
                      {{"code", absl::StatusCodeToString(status.code())},
                       {"reason", ReasonOf(status)},
                       {"message", std::string(status.message())},
                       {"metadata", std::move(metadata)}});
}

}  // namespace tactus::internal::console
