#include "tools/trainctl/remote/proto_json.h"

#include <iostream>
#include <map>
#include <string>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "client/stream/status.h"
#include "core/base/errors.h"
#include "google/protobuf/descriptor.h"
#include "tactus/v1/common.pb.h"

namespace tactus::internal::client {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

Json StatusToJson(const v1::Status& status) {
  return {{"code", status.code()},
          {"reason", ReasonOf(FromStatusProto(status))},
          {"message", status.message()}};
}

// The value of a field, or item `index` of a repeated one.
Json ValueToJson(const Message& message, const FieldDescriptor& field,
                 int index) {
  const auto& reflection = *message.GetReflection();
  const bool repeated = field.is_repeated();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_BOOL:
      return repeated ? reflection.GetRepeatedBool(message, &field, index)
                      : reflection.GetBool(message, &field);
    case FieldDescriptor::CPPTYPE_INT32:
      return repeated ? reflection.GetRepeatedInt32(message, &field, index)
                      : reflection.GetInt32(message, &field);
    case FieldDescriptor::CPPTYPE_UINT32:
      return repeated ? reflection.GetRepeatedUInt32(message, &field, index)
                      : reflection.GetUInt32(message, &field);
    case FieldDescriptor::CPPTYPE_INT64:
      return repeated ? reflection.GetRepeatedInt64(message, &field, index)
                      : reflection.GetInt64(message, &field);
    case FieldDescriptor::CPPTYPE_UINT64:
      return repeated ? reflection.GetRepeatedUInt64(message, &field, index)
                      : reflection.GetUInt64(message, &field);
    case FieldDescriptor::CPPTYPE_FLOAT:
      return repeated ? reflection.GetRepeatedFloat(message, &field, index)
                      : reflection.GetFloat(message, &field);
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return repeated ? reflection.GetRepeatedDouble(message, &field, index)
                      : reflection.GetDouble(message, &field);
    case FieldDescriptor::CPPTYPE_STRING:
      return repeated ? reflection.GetRepeatedString(message, &field, index)
                      : reflection.GetString(message, &field);
    case FieldDescriptor::CPPTYPE_ENUM:
      return EnumText(repeated
                          ? *reflection.GetRepeatedEnum(message, &field, index)
                          : *reflection.GetEnum(message, &field));
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return ToJson(repeated
                        ? reflection.GetRepeatedMessage(message, &field, index)
                        : reflection.GetMessage(message, &field));
  }
  return nullptr;
}

// The keys of our maps are text.
Json MapToJson(const Message& message, const FieldDescriptor& field) {
  const auto& reflection = *message.GetReflection();
  std::map<std::string, Json> sorted;
  for (int i = 0; i < reflection.FieldSize(message, &field); ++i) {
    const Message& entry = reflection.GetRepeatedMessage(message, &field, i);
    const auto& type = *entry.GetDescriptor();
    sorted[ValueToJson(entry, *type.map_key(), 0).get<std::string>()] =
        ValueToJson(entry, *type.map_value(), 0);
  }
  Json json = Json::object();
  for (auto& [key, value] : sorted) json[key] = std::move(value);
  return json;
}

}  // namespace

std::string EnumText(const google::protobuf::EnumValueDescriptor& value) {
  // TaxelUnit becomes TAXEL_UNIT_.
  std::string prefix;
  for (const char c : value.type()->name()) {
    if (absl::ascii_isupper(c) && !prefix.empty()) prefix += '_';
    prefix += absl::ascii_toupper(c);
  }
  return absl::AsciiStrToLower(
      absl::StripPrefix(value.name(), absl::StrCat(prefix, "_")));
}

Json ToJson(const Message& message) {
  if (const auto* status = dynamic_cast<const v1::Status*>(&message)) {
    return StatusToJson(*status);
  }
  const auto& reflection = *message.GetReflection();
  const auto& type = *message.GetDescriptor();
  Json json = Json::object();
  for (int i = 0; i < type.field_count(); ++i) {
    const FieldDescriptor& field = *type.field(i);
    if (field.is_map()) {
      json[field.name()] = MapToJson(message, field);
    } else if (field.is_repeated()) {
      Json array = Json::array();
      for (int k = 0; k < reflection.FieldSize(message, &field); ++k) {
        array.push_back(ValueToJson(message, field, k));
      }
      json[field.name()] = std::move(array);
    } else if (!field.has_presence() || reflection.HasField(message, &field)) {
      json[field.name()] = ValueToJson(message, field, 0);
    }
  }
  return json;
}

void PrintJson(const Json& json) { std::cout << JsonText(json) << "\n"; }

}  // namespace tactus::internal::client
