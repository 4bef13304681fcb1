// Folders of index.csv and trials/NNNN.npy.
#include <filesystem>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/data/import.h"
#include "core/data/npy.h"

namespace tactus {
namespace {

// The file names hold four digits, ids six.
struct TrialFiles {
  std::string id;
  std::string values;
  std::string time;
};

absl::StatusOr<TrialFiles> FilesOf(const std::string& folder,
                                   const CsvTable& table, size_t row,
                                   size_t column) {
  const absl::string_view text = table.text(row, column);
  uint32_t number = 0;
  // Only digits, so that no index leads out of its folder.
  if (text.empty() || text.size() > 6 ||
      text.find_first_not_of("0123456789") != absl::string_view::npos ||
      !absl::SimpleAtoi(text, &number)) {
    return table.RowError(row, "trial must be a number of up to six digits");
  }
  const std::string stem =
      std::filesystem::path(folder) / "trials" / std::string(text);
  return TrialFiles{absl::StrFormat("%06d", number), stem + ".npy",
                    stem + "_time.npy"};
}

absl::Status ExpectColumns(const std::string& path, const NpyArray& array,
                           size_t columns) {
  if (array.shape.size() == 2 && array.shape[1] == columns) {
    return absl::OkStatus();
  }
  return TrialFileInvalid(
      path, absl::StrCat("has shape ", absl::StrJoin(array.shape, " x "),
                         "; it must be frames x ", columns));
}

// The letter of a two-valued column.
absl::StatusOr<char> Letter(const CsvTable& table, size_t row, size_t column,
                            absl::string_view first, absl::string_view second) {
  const absl::string_view text = table.text(row, column);
  // The capital: "hard" gives H.
  if (text == first) return static_cast<char>(first[0] - 'a' + 'A');
  if (text == second) return static_cast<char>(second[0] - 'a' + 'A');
  return table.RowError(row,
                        absl::StrCat(table.header()[column], " is \"", text,
                                     "\"; it must be ", first, " or ", second));
}

// The files of icub_slide20 hold the readings of `rows` triangles in a wrong
// order: frames x triangles was taken for triangles x frames and transposed.
// Put right, taxels change by 0.19 from a frame to the next on average, and by
// 7.1 as the files have them.
std::vector<float> InOrderOfTime(const std::vector<float>& stored, size_t rows,
                                 size_t columns) {
  const size_t triangles = stored.size() / columns;
  const size_t frames = triangles / rows;
  std::vector<float> ordered;
  ordered.reserve(stored.size());
  for (size_t i = 0; i < triangles; ++i) {
    const auto* from = &stored[(i % frames * rows + i / frames) * columns];
    ordered.insert(ordered.end(), from, from + columns);
  }
  return ordered;
}

// "session_2026-02-16_14-11-55" was recorded on 2026-02-16.
std::string DayOf(absl::string_view session) {
  const std::vector<absl::string_view> parts = absl::StrSplit(session, '_');
  return std::string(parts.size() == 3 ? parts[1] : session);
}

}  // namespace

absl::StatusOr<size_t> ImportVitac(const std::string& folder,
                                   const CsvTable& table, TrialSink sink) {
  constexpr int kRows = 12;
  constexpr int kColumns = 32;
  TACTUS_ASSIGN_OR_RETURN(const size_t trial_column, table.Column("trial"));
  TACTUS_ASSIGN_OR_RETURN(const size_t hardness, table.Column("hardness"));
  TACTUS_ASSIGN_OR_RETURN(const size_t motion, table.Column("motion"));
  TACTUS_ASSIGN_OR_RETURN(const size_t object, table.Column("object"));
  TACTUS_ASSIGN_OR_RETURN(const size_t session, table.Column("session"));
  for (size_t row = 0; row < table.rows(); ++row) {
    TACTUS_ASSIGN_OR_RETURN(const TrialFiles files,
                            FilesOf(folder, table, row, trial_column));
    Trial trial;
    trial.id = files.id;
    TACTUS_ASSIGN_OR_RETURN(const char hard,
                            Letter(table, row, hardness, "hard", "soft"));
    TACTUS_ASSIGN_OR_RETURN(const char moved,
                            Letter(table, row, motion, "moved", "unmoved"));
    trial.label = {hard, moved};
    trial.condition = DayOf(table.text(row, session));
    trial.object = std::string(table.text(row, object));
    // "ramp_rubber" is of rubber.
    trial.material = trial.object.substr(trial.object.rfind('_') + 1);
    trial.layout = "vitac-12x32";
    trial.unit = "counts";

    TACTUS_ASSIGN_OR_RETURN(NpyArray values, ReadNpy(files.values));
    TACTUS_RETURN_IF_ERROR(
        ExpectColumns(files.values, values, size_t{kRows} * kColumns));
    if (values.u16.empty()) {
      return TrialFileInvalid(files.values, "must hold uint16 values");
    }
    // The files hold twice the counts above baseline.
    trial.taxels = {kRows, kColumns, std::move(values.u16), {}, 0.5};

    TACTUS_ASSIGN_OR_RETURN(const NpyArray time, ReadNpy(files.time));
    TACTUS_RETURN_IF_ERROR(ExpectColumns(files.time, time, 3));
    if (time.f64.empty()) {
      return TrialFileInvalid(files.time, "must hold float64 values");
    }
    for (size_t i = 0; i < time.f64.size(); i += 3) {
      trial.time.push_back(time.f64[i]);
    }
    TACTUS_RETURN_IF_ERROR(Validate(trial, files.values));
    TACTUS_RETURN_IF_ERROR(sink(std::move(trial)));
  }
  return table.rows();
}

absl::StatusOr<size_t> ImportIcub(const std::string& folder,
                                  const CsvTable& table, TrialSink sink) {
  constexpr int kRows = 6;
  constexpr int kColumns = 10;
  // Assumed: the data set does not state its rate; the skin's ports run at up
  // to this.
  constexpr double kSampleRateHz = 50;
  TACTUS_ASSIGN_OR_RETURN(const size_t trial_column, table.Column("trial"));
  TACTUS_ASSIGN_OR_RETURN(const size_t name, table.Column("material_by_index"));
  TACTUS_ASSIGN_OR_RETURN(const size_t part, table.Column("part"));
  for (size_t row = 0; row < table.rows(); ++row) {
    TACTUS_ASSIGN_OR_RETURN(const TrialFiles files,
                            FilesOf(folder, table, row, trial_column));
    Trial trial;
    trial.id = files.id;
    trial.label = std::string(table.text(row, name));
    trial.material = trial.label;
    trial.object = trial.label;
    trial.condition = std::string(table.text(row, part));
    trial.layout = "icub-6x10";
    trial.unit = "counts";
    trial.sample_rate_hz = kSampleRateHz;

    TACTUS_ASSIGN_OR_RETURN(NpyArray values, ReadNpy(files.values));
    TACTUS_RETURN_IF_ERROR(
        ExpectColumns(files.values, values, size_t{kRows} * kColumns));
    if (values.f32.empty()) {
      return TrialFileInvalid(files.values, "must hold float32 values");
    }
    trial.taxels = {
        kRows, kColumns, {}, InOrderOfTime(values.f32, kRows, kColumns), 1};
    for (size_t i = 0; i < values.shape[0]; ++i) {
      trial.time.push_back(static_cast<double>(i) / kSampleRateHz);
    }
    TACTUS_RETURN_IF_ERROR(Validate(trial, files.values));
    TACTUS_RETURN_IF_ERROR(sink(std::move(trial)));
  }
  return table.rows();
}

}  // namespace tactus
