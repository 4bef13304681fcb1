#include "core/data/trial_layout.h"

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/files/file_bytes.h"
#include "core/skin/layout_json.h"

namespace tactus::internal {

absl::StatusOr<SkinLayout> ReadLayoutFile(const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(const std::string text,
                          ReadFileBytes(path, limits::kMaxMessageBytes));
  auto layout = LayoutFromJson(text);
  if (!layout.ok()) return Annotate(layout.status(), path);
  return layout;
}

absl::StatusOr<SkinLayout> LayoutOfTrial(const Trial& trial,
                                         const SkinLayout* layout) {
  const bool named = layout != nullptr && layout->name == trial.layout;
  SkinLayout found;
  if (trial.skin) {
    found = *trial.skin;
    if (named && *layout != found) {
      const std::string difference = SkinDifference(*layout, found);
      return InvalidConfig(
          absl::StrCat("layout given for trial ", trial.id),
          difference.empty() ? "another mask" : difference,
          "absent: the trial file holds the skin; import again to change it");
    }
  } else if (named) {
    found = *layout;
  } else {
    TACTUS_ASSIGN_OR_RETURN(found, LayoutPreset(trial.layout));
  }
  const TaxelSeries& taxels = trial.taxels;
  if (found.rows != taxels.rows || found.columns != taxels.columns ||
      found.axes != taxels.axes) {
    const auto shape = [](int rows, int columns, int axes) {
      return absl::StrCat(rows, "x", columns,
                          axes == 1 ? "" : absl::StrCat("x", axes));
    };
    return InvalidConfig(
        absl::StrCat("shape of trial ", trial.id),
        shape(taxels.rows, taxels.columns, taxels.axes),
        absl::StrCat(shape(found.rows, found.columns, found.axes),
                     ", as layout ", found.name));
  }
  if (UnitText(found.unit) != trial.unit) {
    return InvalidConfig(
        absl::StrCat("unit of trial ", trial.id), trial.unit,
        absl::StrCat(UnitText(found.unit), ", as layout ", found.name));
  }
  TACTUS_RETURN_IF_ERROR(Validate(found));
  return found;
}

}  // namespace tactus::internal
