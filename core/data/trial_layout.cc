#include "core/data/trial_layout.h"

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/data/file_bytes.h"
#include "core/skin/layout_proto.h"
#include "google/protobuf/util/json_util.h"

namespace tactus {

absl::StatusOr<SkinLayout> ReadLayoutFile(const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(const std::string text,
                          ReadFileBytes(path, limits::kMaxMessageBytes));
  v1::SensorGeometry geometry;
  const auto parsed =
      google::protobuf::util::JsonStringToMessage(text, &geometry);
  if (!parsed.ok()) {
    return IoError(path, absl::StrCat("not a SensorGeometry in JSON: ",
                                      std::string(parsed.message())));
  }
  auto layout = LayoutFromProto(geometry);
  if (!layout.ok()) return Annotate(layout.status(), path);
  return layout;
}

absl::StatusOr<SkinLayout> LayoutOfTrial(const Trial& trial,
                                         const SkinLayout* layout) {
  SkinLayout found;
  if (layout != nullptr && layout->name == trial.layout) {
    found = *layout;
  } else {
    TACTUS_ASSIGN_OR_RETURN(found, LayoutPreset(trial.layout));
  }
  if (found.rows != trial.taxels.rows ||
      found.columns != trial.taxels.columns) {
    return InvalidConfig(
        absl::StrCat("shape of trial ", trial.id),
        absl::StrCat(trial.taxels.rows, "x", trial.taxels.columns),
        absl::StrCat(found.rows, "x", found.columns, ", as layout ",
                     found.name));
  }
  TACTUS_RETURN_IF_ERROR(Validate(found));
  return found;
}

}  // namespace tactus
