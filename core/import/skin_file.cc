#include "core/import/skin_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/limits_skin.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/files/csv.h"
#include "core/files/file_bytes.h"
#include "core/import/mistakes.h"
#include "core/skin/taxel_grid.h"
#include "nlohmann/json.hpp"

namespace tactus::internal {
namespace {

using Json = nlohmann::json;

constexpr char kFromIdle[] = "from idle frames";

// Takes fields out of a JSON object one by one. The first mistake of each field
// is kept, and whatever was not asked for at the end is a mistake too.
class Fields {
 public:
  Fields(std::string path, const Json& object)
      : path_(std::move(path)), object_(object) {}

  bool Has(const std::string& name) {
    known_.insert(name);
    return object_.contains(name);
  }

  void Text(const std::string& name, std::string* value) {
    if (!Has(name)) return;
    const Json& json = object_[name];
    if (!json.is_string()) return Complain(name, json, "text");
    *value = json.get<std::string>();
    const std::string fault = TextFault(*value, limits::kMaxTrialTextBytes);
    if (!fault.empty()) Complain(name, fault);
  }

  // The name of a file; false if it is not beside the skin.json. A folder may
  // come from a stranger, and errors quote what is in a file.
  bool File(const std::string& name, std::string* value) {
    Text(name, value);
    const std::filesystem::path file(*value);
    if (!file.is_absolute() &&
        std::find(file.begin(), file.end(), "..") == file.end()) {
      return true;
    }
    Complain(name, object_[name], "a file beside the skin.json");
    return false;
  }

  void Number(const std::string& name, double low, double high, double* value) {
    if (!Has(name)) return;
    const Json& json = object_[name];
    // Written so that a NaN fails.
    if (json.is_number() && json.get<double>() >= low &&
        json.get<double>() <= high) {
      *value = json.get<double>();
      return;
    }
    Complain(name, json, absl::StrCat("a number from ", low, " to ", high));
  }

  void Whole(const std::string& name, int low, int high, int* value) {
    if (!Has(name)) return;
    const Json& json = object_[name];
    if (json.is_number_integer() && json.get<int64_t>() >= low &&
        json.get<int64_t>() <= high) {
      *value = json.get<int>();
      return;
    }
    Complain(name, json,
             absl::StrCat("a whole number from ", low, " to ", high));
  }

  void Bool(const std::string& name, bool* value) {
    if (!Has(name)) return;
    const Json& json = object_[name];
    if (!json.is_boolean()) return Complain(name, json, "true or false");
    *value = json.get<bool>();
  }

  template <typename Value>
  void Choice(const std::string& name,
              const std::vector<std::pair<std::string, Value>>& choices,
              Value* value) {
    if (!Has(name)) return;
    const Json& json = object_[name];
    std::vector<std::string> names;
    for (const auto& [text, chosen] : choices) {
      if (json == text) {
        *value = chosen;
        return;
      }
      names.push_back(Json(text).dump());
    }
    Complain(name, json, absl::StrJoin(names, " or "));
  }

  const Json& At(const std::string& name) { return object_[name]; }

  void Complain(const std::string& name, const Json& got,
                absl::string_view want) {
    Complain(name, absl::StrCat("is ", Printable(got.dump().substr(0, 60)),
                                "; it must be ", want));
  }
  void Complain(const std::string& name, absl::string_view what) {
    if (!wrong_.insert(name).second) return;
    Keep(TrialFileInvalid(path_, absl::StrCat(name, ": ", what)));
  }
  void Complain(const absl::Status& status) {
    if (!status.ok()) Keep(TrialFileInvalid(path_, status.message()));
  }

  // Takes over a mistake that names its file and field.
  void Adopt(const absl::Status& status) { Keep(status); }

  absl::Status Finish() {
    for (const auto& [name, value] : object_.items()) {
      if (!known_.contains(name)) {
        Complain(name, absl::StrCat("is not known; use ",
                                    absl::StrJoin(known_, ", ")));
      }
    }
    TACTUS_RETURN_IF_ERROR(other_);
    return mistakes_.Status();
  }

 private:
  void Keep(const absl::Status& status) {
    const absl::Status other = mistakes_.Add("", status);
    if (other_.ok()) other_ = other;
  }

  const std::string path_;
  const Json& object_;
  std::set<std::string> known_;
  // The fields that have a mistake.
  std::set<std::string> wrong_;
  Mistakes mistakes_{path_};
  absl::Status other_;
};

absl::StatusOr<std::vector<Eigen::Vector3d>> ReadPositions(
    const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(const CsvTable table, CsvTable::Read(path));
  const std::vector<absl::string_view> names = {"x", "y", "z"};
  std::vector<size_t> columns;
  for (const absl::string_view name : names) {
    if (name == "z" && !table.Has(name)) break;
    TACTUS_ASSIGN_OR_RETURN(const size_t column, table.Column(name));
    columns.push_back(column);
  }
  std::vector<Eigen::Vector3d> positions;
  for (size_t row = 0; row < table.rows(); ++row) {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    for (size_t axis = 0; axis < columns.size(); ++axis) {
      TACTUS_ASSIGN_OR_RETURN(position[axis], table.Number(row, columns[axis]));
    }
    positions.push_back(position);
  }
  return positions;
}

// From the places of the taxels.
absl::Status TakePositions(const std::string& path, SkinFile& skin) {
  TACTUS_ASSIGN_OR_RETURN(const auto positions, ReadPositions(path));
  auto grid = PlaceOnGrid(positions);
  if (!grid.ok()) return Annotate(grid.status(), path);
  skin.layout.rows = grid->rows;
  skin.layout.columns = grid->columns;
  skin.layout.row_pitch_m = grid->row_pitch_m;
  skin.layout.column_pitch_m = grid->column_pitch_m;
  skin.layout.mask = std::move(grid->mask);
  skin.cells = std::move(grid->cells);
  skin.placed = true;
  return absl::OkStatus();
}

void TakeShape(const std::string& folder, Fields& fields, SkinFile& skin) {
  SkinLayout& layout = skin.layout;
  fields.Text("name", &layout.name);
  if (layout.name.empty()) fields.Complain("name", "is missing: name the skin");
  std::string positions;
  const bool may_read = fields.File("taxel_positions", &positions);
  const bool shaped = fields.Has("rows") || fields.Has("columns") ||
                      fields.Has("row_pitch_m") || fields.Has("column_pitch_m");
  bool preset = false;
  if (positions.empty() && !shaped) {
    auto found = LayoutPreset(layout.name);
    preset = found.ok();
    if (preset) {
      layout = *std::move(found);
    } else {
      fields.Complain("rows",
                      "is missing; give rows, columns and pitches, "
                      "taxel_positions, or the name of a preset");
    }
  } else if (shaped && !positions.empty()) {
    fields.Complain("taxel_positions",
                    "is given with a shape; give one of the two");
  } else if (!positions.empty()) {
    if (may_read) {
      fields.Complain(
          TakePositions(std::filesystem::path(folder) / positions, skin));
    }
    layout.taxel_area_m2 = layout.row_pitch_m * layout.column_pitch_m;
  } else {
    for (const char* name :
         {"rows", "columns", "row_pitch_m", "column_pitch_m"}) {
      if (!fields.Has(name)) fields.Complain(name, "is missing");
    }
    fields.Whole("rows", 1, limits::kMaxRows, &layout.rows);
    fields.Whole("columns", 1, limits::kMaxColumns, &layout.columns);
    fields.Number("row_pitch_m", limits::kMinTaxelPitchM,
                  limits::kMaxTaxelPitchM, &layout.row_pitch_m);
    fields.Number("column_pitch_m", limits::kMinTaxelPitchM,
                  limits::kMaxTaxelPitchM, &layout.column_pitch_m);
    layout.taxel_area_m2 = layout.row_pitch_m * layout.column_pitch_m;
  }
  fields.Number("taxel_area_m2", limits::kMinTaxelAreaM2,
                limits::kMaxTaxelAreaM2, &layout.taxel_area_m2);
  fields.Bool("wrap_columns", &layout.wrap_columns);
  int connectivity = layout.connectivity == Connectivity::kFour ? 4 : 8;
  fields.Whole("connectivity", 4, 8, &connectivity);
  if (connectivity != 4 && connectivity != 8) {
    fields.Complain("connectivity", connectivity, "4 or 8");
  }
  layout.connectivity =
      connectivity == 4 ? Connectivity::kFour : Connectivity::kEight;
  if (!preset && !fields.Has("unit")) {
    fields.Complain("unit", "is missing; give \"newton\" or \"counts\"");
  }
  fields.Choice<TaxelUnit>(
      "unit", {{"newton", TaxelUnit::kNewton}, {"counts", TaxelUnit::kCounts}},
      &layout.unit);
}

// `masked_taxels` counts in the order of the files.
void TakeMask(Fields& fields, SkinFile& skin) {
  // Without a shape, which is a mistake of its own, no taxel has a place.
  if (!fields.Has("masked_taxels") || skin.frame_taxels() == 0) return;
  const Json& list = fields.At("masked_taxels");
  if (!list.is_array()) {
    return fields.Complain("masked_taxels", list, "a list of taxels");
  }
  std::vector<uint8_t>& mask = skin.layout.mask;
  if (mask.empty()) mask.assign(skin.layout.taxels(), 1);
  for (const Json& taxel : list) {
    if (!taxel.is_number_unsigned() ||
        taxel.get<uint64_t>() >= skin.frame_taxels()) {
      return fields.Complain(
          "masked_taxels", taxel,
          absl::StrCat("a taxel from 0 to ", skin.frame_taxels() - 1));
    }
    const auto index = taxel.get<size_t>();
    mask[skin.cells.empty() ? index : skin.cells[index]] = 0;
  }
}

// What does not fit together is found by Validate().
void TakeAxes(Fields& fields, SkinFile& skin) {
  SkinLayout& layout = skin.layout;
  fields.Whole("axes", 1, 3, &layout.axes);
  if (layout.axes == 2) fields.Complain("axes", 2, "1 or 3");
  if (fields.Has("normal_axis")) {
    layout.normal_axis = 0;
    fields.Whole("normal_axis", 0, 2, &*layout.normal_axis);
  }
  fields.Bool("signed_values", &layout.signed_values);
  if (layout.signed_values && fields.Has("negative_values")) {
    fields.Complain("negative_values",
                    "is given with signed_values; values below zero stay as "
                    "they are, so give one of the two");
  }
}

void TakeThresholds(Fields& fields, SkinFile& skin) {
  SkinLayout& layout = skin.layout;
  if (fields.Has("thresholds")) {
    if (fields.At("thresholds") != kFromIdle) {
      fields.Complain("thresholds", fields.At("thresholds"),
                      absl::StrCat("\"", kFromIdle, "\""));
    }
    if (fields.Has("contact_threshold") || fields.Has("onset_threshold")) {
      fields.Complain("thresholds",
                      "is given with contact_threshold or onset_threshold; "
                      "give one of the two");
    }
    skin.thresholds_from_idle = true;
    layout.contact_threshold = 0;
    layout.onset_threshold = 0;
    return;
  }
  fields.Number("contact_threshold", limits::kMinThreshold,
                limits::kMaxTaxelValue, &layout.contact_threshold);
  if (layout.contact_threshold == 0) {
    fields.Complain("contact_threshold",
                    "is missing; give it, or \"thresholds\": \"from idle "
                    "frames\"");
  }
  layout.onset_threshold =
      std::max(layout.onset_threshold, layout.contact_threshold);
  fields.Number("onset_threshold", layout.contact_threshold,
                limits::kMaxTaxelValue, &layout.onset_threshold);
}

// What is missing or does not fit together is found by Validate().
void TakeLightTouch(const std::string& path, Fields& fields, SkinFile& skin) {
  if (!fields.Has("light_touch")) return;
  const Json& object = fields.At("light_touch");
  if (!object.is_object()) {
    return fields.Complain("light_touch", object, "an object");
  }
  LightTouch& light = skin.layout.light_touch.emplace();
  Json named = Json::object();
  for (const auto& [name, value] : object.items()) {
    named["light_touch." + name] = value;
  }
  Fields inner(path, named);
  using namespace limits;
  inner.Number("light_touch.window_s", kMinLightWindowS, kMaxLightWindowS,
               &light.window_s);
  inner.Whole("light_touch.rows", 1, kMaxLightSide, &light.rows);
  inner.Whole("light_touch.columns", 1, kMaxLightSide, &light.columns);
  inner.Number("light_touch.contact_threshold", kMinLightThreshold,
               kMaxTaxelValue, &light.contact_threshold);
  inner.Number("light_touch.onset_threshold", kMinLightThreshold,
               kMaxTaxelValue, &light.onset_threshold);
  fields.Adopt(inner.Finish());
}

void TakeNumbers(Fields& fields, SkinFile& skin) {
  fields.Number("sample_rate_hz", limits::kMinSampleRateHz,
                limits::kMaxSampleRateHz, &skin.sample_rate_hz);
  fields.Number("scale", 1e-12, 1e12, &skin.scale);
  fields.Number("time_scale_s", 1e-12, 1e3, &skin.time_scale_s);
  fields.Whole("idle_frames", 1, 1'000'000, &skin.idle_frames);
  fields.Number("idle_taxels", 1e-3, 0.9, &skin.idle_taxels);
  if (fields.Has("baseline") && fields.At("baseline") == kFromIdle) {
    skin.baseline_from_idle = true;
  } else {
    fields.Number("baseline", -1e12, 1e12, &skin.baseline);
  }
  fields.Choice<bool>("pressing", {{"raises", false}, {"lowers", true}},
                      &skin.pressing_lowers);
  fields.Choice<NegativeValues>("negative_values",
                                {{"refused", NegativeValues::kRefused},
                                 {"zero", NegativeValues::kZero},
                                 {"absolute", NegativeValues::kAbsolute}},
                                &skin.negative_values);
  fields.Choice<EventRule>("events",
                           {{"count", EventRule::kCount},
                            {"sum", EventRule::kSum},
                            {"hold", EventRule::kHold}},
                           &skin.events);
  if (skin.baseline_from_idle && skin.idle_frames == 0) {
    fields.Complain("idle_frames",
                    "is missing; the baseline is taken from idle frames");
  }
  if (skin.thresholds_from_idle && skin.idle_frames == 0 &&
      skin.idle_taxels == 0) {
    fields.Complain("idle_frames",
                    "is missing, and so is idle_taxels; the thresholds are "
                    "taken from one of them");
  }
  if (skin.idle_frames > 0 && skin.idle_taxels > 0) {
    fields.Complain("idle_taxels",
                    "is given with idle_frames; give one of the two");
  }
}

// The skin becomes two planes of taxels, one below the other. Too many rows are
// found by Validate().
void TakePolarity(Fields& fields, SkinFile& skin) {
  bool wanted = false;
  fields.Choice<bool>("polarity", {{"two planes", true}}, &wanted);
  if (!wanted || skin.frame_taxels() == 0) return;
  SkinLayout& layout = skin.layout;
  if (layout.axes != 1 ||
      (skin.events != EventRule::kCount && skin.events != EventRule::kSum)) {
    return fields.Complain("polarity",
                           "needs \"events\": \"count\" or \"sum\", and "
                           "one axis");
  }
  std::vector<uint8_t> plane = layout.mask;
  if (plane.empty()) plane.assign(layout.taxels(), 1);
  const std::vector<uint8_t> between(layout.columns, 0);
  const int second = layout.taxels() + layout.columns;
  if (skin.cells.empty()) {
    skin.cells.resize(layout.taxels());
    std::iota(skin.cells.begin(), skin.cells.end(), 0);
  }
  const std::vector<int> cells = skin.cells;
  for (const int cell : cells) skin.cells.push_back(second + cell);
  layout.mask = plane;
  layout.mask.insert(layout.mask.end(), between.begin(), between.end());
  layout.mask.insert(layout.mask.end(), plane.begin(), plane.end());
  layout.rows = 2 * layout.rows + 1;
  skin.two_planes = true;
}

// A column by its name or by its place.
std::optional<std::string> ColumnText(const Json& json) {
  if (json.is_string()) return json.get<std::string>();
  if (json.is_number_unsigned()) return absl::StrCat(json.get<uint64_t>());
  return {};
}

void TakeColumns(Fields& fields, const std::string& name,
                 std::vector<std::string>* columns) {
  if (!fields.Has(name)) return;
  const Json& list = fields.At(name);
  if (!list.is_array() || list.empty()) {
    return fields.Complain(name, list, "a list of columns");
  }
  for (const Json& item : list) {
    const auto column = ColumnText(item);
    if (!column) {
      return fields.Complain(
          name, item,
          "the name of a column, its place from 0, or a range: \"c1..c16\"");
    }
    columns->push_back(*column);
  }
}

void TakeFormat(Fields& fields, SkinFile& skin) {
  fields.Choice<char>(
      "delimiter",
      {{",", ','}, {";", ';'}, {"\t", '\t'}, {"|", '|'}, {" ", ' '}},
      &skin.format.text.delimiter);
  fields.Choice<char>("decimal", {{".", '.'}, {",", ','}},
                      &skin.format.text.decimal);
  if (skin.format.text.delimiter == ',' && skin.format.text.decimal == ',' &&
      fields.Has("decimal")) {
    fields.Complain("decimal", "is the delimiter too; one of them is wrong");
  }
  fields.Whole("header_lines", 0, 1000, &skin.format.text.header_lines);
  fields.Choice<Hdf5Order>("array_order",
                           {{"rows first", Hdf5Order::kRowsFirst},
                            {"columns first", Hdf5Order::kColumnsFirst}},
                           &skin.format.order);
  fields.Choice<RepeatedTimes>("repeated_times",
                               {{"refused", RepeatedTimes::kRefused},
                                {"dropped", RepeatedTimes::kDropped}},
                               &skin.repeated_times);
  if (fields.Has("time_column")) {
    skin.time_column = ColumnText(fields.At("time_column"));
    if (!skin.time_column) {
      fields.Complain("time_column", fields.At("time_column"),
                      "the name of a column, or its place from 0");
    }
  }
  TakeColumns(fields, "taxel_columns", &skin.taxel_columns);
}

// Auxiliary taxels lie in rows of their own, below those of the skin. Too many
// rows are found by Validate().
void TakeAuxiliary(Fields& fields, SkinFile& skin) {
  int count = 0;
  TakeColumns(fields, "auxiliary_columns", &skin.auxiliary_columns);
  fields.Whole("auxiliary_values", 1,
               static_cast<int>(limits::kMaxAuxiliaryTaxels), &count);
  SkinLayout& layout = skin.layout;
  if (count == 0) {
    if (!skin.auxiliary_columns.empty()) {
      fields.Complain("auxiliary_values",
                      "is missing: say how many auxiliary_columns there are");
    }
    return;
  }
  if (skin.frame_taxels() == 0) return;
  if (skin.two_planes || skin.events != EventRule::kNone) {
    return fields.Complain("auxiliary_values", "cannot be given with events");
  }
  if (skin.cells.empty()) {
    skin.cells.resize(layout.taxels());
    std::iota(skin.cells.begin(), skin.cells.end(), 0);
  }
  const int first = layout.taxels();
  layout.rows += (count + layout.columns - 1) / layout.columns;
  if (layout.mask.empty()) layout.mask.assign(first, 1);
  layout.mask.resize(layout.taxels(), 0);
  for (int i = 0; i < count; ++i) {
    skin.cells.push_back(first + i);
    layout.auxiliary.push_back(static_cast<uint32_t>(first + i));
  }
  if (layout.axes == 1 && !layout.signed_values) {
    layout.signed_values = true;
    layout.normal_axis = 0;
    skin.unsigned_touch = true;
  }
}

void TakeTableFields(Fields& fields, SkinFile& skin) {
  if (!fields.Has("fields")) return;
  const Json& made = fields.At("fields");
  if (!made.is_object()) {
    return fields.Complain("fields", made, "an object of texts");
  }
  for (const auto& [name, value] : made.items()) {
    const auto& known = TableFields();
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      return fields.Complain(absl::StrCat("fields.", name),
                             absl::StrCat("is no field of a trial; use ",
                                          absl::StrJoin(known, ", ")));
    }
    if (!value.is_string()) {
      return fields.Complain(absl::StrCat("fields.", name), value,
                             "text like \"{name of a column}\"");
    }
    skin.fields[name] = value.get<std::string>();
  }
}

absl::StatusOr<Json> ParseObject(const std::string& path,
                                 const std::string& text) {
  // The library reports by exception only where the mistake is.
  try {
    Json json = Json::parse(text);
    if (json.is_object()) return json;
  } catch (const Json::parse_error& error) {
    const auto end = text.begin() +
                     static_cast<ptrdiff_t>(std::min(error.byte, text.size()));
    return TrialFileInvalid(
        path, absl::StrCat("line ", 1 + std::count(text.begin(), end, '\n'),
                           ": is no JSON"));
  } catch (const Json::out_of_range&) {
    return TrialFileInvalid(path, "a number in it is too large");
  }
  return TrialFileInvalid(path, "must be one JSON object");
}

}  // namespace

const std::vector<absl::string_view>& TableFields() {
  static const auto* const fields = new std::vector<absl::string_view>{
      "frames",   "id",        "label",    "condition",      "group", "object",
      "material", "stiffness", "velocity", "sample_rate_hz", "time",  "pose"};
  return *fields;
}

absl::StatusOr<SkinFile> ReadSkinFile(const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(const std::string text,
                          ReadFileBytes(path, limits::kMaxMessageBytes));
  TACTUS_ASSIGN_OR_RETURN(const Json json, ParseObject(path, text));
  SkinFile skin;
  Fields fields(path, json);
  TakeShape(std::filesystem::path(path).parent_path(), fields, skin);
  TakeAxes(fields, skin);
  TakeThresholds(fields, skin);
  TakeLightTouch(path, fields, skin);
  TakeNumbers(fields, skin);
  TakeMask(fields, skin);
  TakePolarity(fields, skin);
  TakeFormat(fields, skin);
  TakeAuxiliary(fields, skin);
  fields.Text("dataset", &skin.dataset);
  fields.Text("bag_values", &skin.bag_values);
  fields.Text("pose_topic", &skin.pose_topic);
  fields.File("table", &skin.table);
  fields.Text("file_names", &skin.file_names);
  TakeTableFields(fields, skin);
  TACTUS_RETURN_IF_ERROR(fields.Finish());
  SkinLayout complete = skin.layout;
  if (skin.thresholds_from_idle) {
    complete.contact_threshold = complete.onset_threshold = 1;
  }
  if (const absl::Status status = Validate(complete); !status.ok()) {
    return TrialFileInvalid(path, status.message());
  }
  return skin;
}

}  // namespace tactus::internal
