#include "core/skin/layout_json.h"

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/text.h"
#include "core/skin/layout_proto.h"
#include "google/protobuf/util/json_util.h"

namespace tactus::internal {

std::string LayoutToJson(const SkinLayout& layout) {
  google::protobuf::util::JsonPrintOptions options;
  options.preserve_proto_field_names = true;
  std::string text;
  // Fails for malformed UTF-8 only, which a valid name does not hold.
  const auto printed = google::protobuf::util::MessageToJsonString(
      LayoutToProto(layout), &text, options);
  return printed.ok() ? text : "";
}

absl::StatusOr<SkinLayout> LayoutFromJson(absl::string_view json) {
  v1::SensorGeometry geometry;
  const auto parsed = google::protobuf::util::JsonStringToMessage(
      {json.data(), json.size()}, &geometry);
  if (!parsed.ok()) {
    return InvalidConfig("layout", Quoted(json.substr(0, 40)),
                         absl::StrCat("a SensorGeometry in JSON: ",
                                      std::string(parsed.message())));
  }
  return LayoutFromProto(geometry);
}

}  // namespace tactus::internal
