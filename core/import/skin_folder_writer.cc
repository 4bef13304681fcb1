#include "core/import/skin_folder_writer.h"

#include <filesystem>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/data/similar_names.h"
#include "core/data/trial_csv.h"
#include "core/data/trial_id.h"
#include "core/data/trial_layout.h"
#include "core/files/draft_file.h"
#include "core/import/skin_file.h"
#include "nlohmann/json.hpp"

namespace tactus::internal {
namespace {

namespace fs = std::filesystem;
// Keeps the order of its keys.
using SkinJson = nlohmann::ordered_json;

constexpr char kFrameFolder[] = "frames";
constexpr char kOtherFormats[] = "; export npz, zarr or hdf5";
// Columns of a text file that are no taxels: the time and the pose.
constexpr size_t kOtherColumns = 8;

// The skin.json of a layout whose auxiliary taxels are its last rows.
SkinJson SkinJsonOf(const SkinLayout& skin, const TaxelSeries& taxels) {
  const int rows =
      skin.auxiliary.empty()
          ? skin.rows
          : static_cast<int>(skin.auxiliary.front()) / skin.columns;
  SkinJson json = {
      {"name", skin.name},
      {"rows", rows},
      {"columns", skin.columns},
      {"row_pitch_m", skin.row_pitch_m},
      {"column_pitch_m", skin.column_pitch_m},
      {"taxel_area_m2", skin.taxel_area_m2},
      {"wrap_columns", skin.wrap_columns},
      {"connectivity", skin.connectivity == Connectivity::kFour ? 4 : 8},
      {"unit", UnitText(skin.unit)},
      {"axes", skin.axes},
      {"signed_values", skin.signed_values},
      {"contact_threshold", skin.contact_threshold},
      {"onset_threshold", skin.onset_threshold},
      {"delimiter", ","},
      {"decimal", "."},
      {"header_lines", 1},
      {"time_column", "time"}};
  if (skin.normal_axis) json["normal_axis"] = *skin.normal_axis;
  if (const auto& light = skin.light_touch) {
    json["light_touch"] = {{"window_s", light->window_s},
                           {"rows", light->rows},
                           {"columns", light->columns},
                           {"contact_threshold", light->contact_threshold},
                           {"onset_threshold", light->onset_threshold}};
  }
  if (!skin.mask.empty()) {
    SkinJson masked = SkinJson::array();
    for (int taxel = 0; taxel < rows * skin.columns; ++taxel) {
      if (skin.mask[taxel] == 0) masked.push_back(taxel);
    }
    json["masked_taxels"] = masked;
  }
  if (!skin.auxiliary.empty()) {
    json["auxiliary_values"] = skin.auxiliary.size();
  }
  const size_t last =
      (skin.auxiliary.empty() ? skin.taxels() : skin.auxiliary.back() + 1) *
          static_cast<size_t>(skin.axes) -
      1;
  json["taxel_columns"] = {
      absl::StrCat(TaxelColumn(taxels, 0), "..", TaxelColumn(taxels, last))};
  return json;
}

std::string Cell(absl::string_view text) {
  return absl::StrCat("\"", absl::StrReplaceAll(text, {{"\"", "\"\""}}), "\"");
}

// Shortest digits that are read as the same bits.
std::string DigitsOf(double value) { return SkinJson(value).dump(); }

absl::Status Refuse(const Trial& trial, absl::string_view part,
                    absl::string_view what) {
  return TrialFileInvalid(
      "csv", absl::StrCat("trial ", trial.id, ": ", part, ": ", what));
}

// What no folder of recordings can say.
absl::Status CheckTrial(const Trial& trial) {
  if (trial.taxels.empty()) {
    return Refuse(trial, "taxels",
                  "missing; trials with and without them are not exported to "
                  "one folder, so choose by --trial");
  }
  if (!trial.touches.empty()) {
    return Refuse(
        trial, "touches",
        absl::StrCat("the table has one contact a trial", kOtherFormats));
  }
  if (const std::string fault = TrialIdFault(trial.id); !fault.empty()) {
    return Refuse(trial, "id", fault);
  }
  const std::pair<const char*, const std::string*> texts[] = {
      {"label", &trial.label},
      {"condition", &trial.condition},
      {"object", &trial.object},
      {"material", &trial.material}};
  for (const auto& [name, text] : texts) {
    if (TrimmedName(*text) == *text) continue;
    return Refuse(trial, name,
                  absl::StrCat("is ", Quoted(*text),
                               ", and an import takes the blanks around it "
                               "away",
                               kOtherFormats));
  }
  return absl::OkStatus();
}

}  // namespace

SkinFolderWriter::SkinFolderWriter(std::string folder)
    : folder_(std::move(folder)),
      table_(
          "frames,id,label,condition,material,object,stiffness,velocity,"
          "sample_rate_hz\n") {}

absl::StatusOr<SkinFolderWriter> SkinFolderWriter::Create(
    const std::string& folder) {
  std::error_code error;
  fs::create_directories(fs::path(folder) / kFrameFolder, error);
  if (error) return IoError(folder, error.message());
  return SkinFolderWriter(folder);
}

absl::Status SkinFolderWriter::WriteSkin(const Trial& trial,
                                         const SkinLayout& skin) {
  const std::string path = fs::path(folder_) / "skin.json";
  TACTUS_RETURN_IF_ERROR(
      WriteFileBytes(path, SkinJsonOf(skin, trial.taxels).dump(2) + "\n"));
  TACTUS_ASSIGN_OR_RETURN(const SkinFile file, ReadSkinFile(path));
  if (file.layout != skin) {
    return Refuse(trial, "skin",
                  absl::StrCat("its auxiliary taxels are not the last rows",
                               kOtherFormats));
  }
  for (size_t i = 0; i < file.frame_size(); ++i) {
    places_.push_back(file.PlaceOf(i));
  }
  skin_ = skin;
  return absl::OkStatus();
}

absl::Status SkinFolderWriter::Append(const Trial& trial) {
  TACTUS_RETURN_IF_ERROR(Validate(trial, "csv"));
  TACTUS_RETURN_IF_ERROR(CheckTrial(trial));
  TACTUS_ASSIGN_OR_RETURN(const SkinLayout skin, LayoutOfTrial(trial));
  if (!skin_) TACTUS_RETURN_IF_ERROR(WriteSkin(trial, skin));
  if (skin != *skin_) {
    return Refuse(trial, "skin",
                  "is not that of the first trial, and a folder has one skin; "
                  "choose by --trial");
  }
  const size_t width = places_.size() + kOtherColumns;
  if (places_.size() > limits::kMaxTaxels ||
      width * trial.time.size() > limits::kMaxCsvCells) {
    return Refuse(
        trial, "taxels",
        absl::StrCat("are ", trial.time.size(), " frames of ", places_.size(),
                     " numbers, more than a text file may have",
                     kOtherFormats));
  }
  TACTUS_ASSIGN_OR_RETURN(const std::string frames,
                          FramesToCsv(trial, places_));
  if (frames.size() > limits::kMaxCsvBytes) {
    return Refuse(
        trial, "taxels",
        absl::StrCat("take ", frames.size(), " bytes as text", kOtherFormats));
  }
  const fs::path file = fs::path(kFrameFolder) / (trial.id + ".csv");
  TACTUS_RETURN_IF_ERROR(WriteFileBytes(fs::path(folder_) / file, frames));
  absl::StrAppend(&table_, file.string(), ",", trial.id, ",", Cell(trial.label),
                  ",", Cell(trial.condition), ",", Cell(trial.material), ",",
                  Cell(trial.object), ",", DigitsOf(trial.stiffness), ",",
                  DigitsOf(trial.velocity), ",", DigitsOf(trial.sample_rate_hz),
                  "\n");
  return absl::OkStatus();
}

absl::Status SkinFolderWriter::Close() {
  return WriteFileBytes(fs::path(folder_) / "trials.csv", table_);
}

}  // namespace tactus::internal
