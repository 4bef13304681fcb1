#include "core/import/frame_columns.h"

#include <algorithm>
#include <optional>
#include <set>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"

namespace tactus::internal {
namespace {

constexpr absl::string_view kRange = "..";

// True for the names that programs give to columns of times.
bool IsTimeName(absl::string_view name) {
  static const auto* const names = new std::set<std::string>{
      "t",  "ts", "s",    "sec",   "secs",   "second", "seconds", "ms",  "msec",
      "us", "ns", "usec", "nsecs", "millis", "micros", "nanos",   "date"};
  const std::string lower = absl::AsciiStrToLower(name);
  // "t (s)" and "t [ms]" as "t".
  const std::string word =
      lower.substr(0, std::min(lower.find_first_of(" ([_/"), lower.size()));
  return absl::StrContains(lower, "time") ||
         absl::StrContains(lower, "stamp") || names->contains(word);
}

class Finder {
 public:
  Finder(const std::string& path, const ArrayFile& file, const SkinFile& skin)
      : path_(path), file_(file), skin_(skin) {
    const std::vector<size_t>& shape = file.array.shape;
    if (shape.size() == 2) width_ = shape[1];
    for (const std::vector<size_t>& frame : FrameShapes(skin)) {
      if (std::equal(frame.begin(), frame.end(), shape.begin() + 1,
                     shape.end())) {
        width_ = skin.frame_size();
      }
    }
  }

  // The shapes of a frame that has several axes.
  static std::vector<std::vector<size_t>> FrameShapes(const SkinFile& skin) {
    std::vector<std::vector<size_t>> shapes;
    const auto axes = static_cast<size_t>(skin.layout.axes);
    if (axes > 1) shapes.push_back({skin.frame_taxels(), axes});
    if (!skin.cells.empty()) return shapes;
    shapes.push_back({static_cast<size_t>(skin.layout.rows),
                      static_cast<size_t>(skin.layout.columns)});
    if (axes > 1) shapes.back().push_back(axes);
    return shapes;
  }

  absl::StatusOr<FrameColumns> Run() {
    TACTUS_RETURN_IF_ERROR(FindTime());
    TACTUS_RETURN_IF_ERROR(FindPose());
    TACTUS_ASSIGN_OR_RETURN(
        const std::vector<size_t> auxiliary,
        FindNamed("auxiliary_columns", skin_.auxiliary_columns));
    if (skin_.taxel_columns.empty()) {
      for (size_t i = 0; i < width_; ++i) {
        if (!Contains(columns_.time, i) && !Contains(columns_.pose, i) &&
            !Contains(auxiliary, i)) {
          columns_.taxels.push_back(i);
        }
      }
    } else {
      columns_.taxels_are_named = true;
      TACTUS_ASSIGN_OR_RETURN(columns_.taxels,
                              FindNamed("taxel_columns", skin_.taxel_columns));
    }
    columns_.taxels.insert(columns_.taxels.end(), auxiliary.begin(),
                           auxiliary.end());
    TACTUS_RETURN_IF_ERROR(CheckDistinct());
    TACTUS_RETURN_IF_ERROR(CheckTaxels());
    Describe();
    return std::move(columns_);
  }

 private:
  static bool Contains(const std::vector<size_t>& list, size_t value) {
    return std::find(list.begin(), list.end(), value) != list.end();
  }

  template <typename... Parts>
  absl::Status Complain(const Parts&... parts) const {
    return TrialFileInvalid(path_, absl::StrCat(parts...));
  }

  // A column by its name, else by its place from 0.
  absl::StatusOr<size_t> Place(absl::string_view field,
                               absl::string_view name) const {
    std::vector<size_t> found;
    for (size_t i = 0; i < file_.header.size(); ++i) {
      if (file_.header[i] == name) found.push_back(i);
    }
    if (found.size() > 1) {
      return Complain("has ", found.size(), " columns ", Quoted(name),
                      "; name each once");
    }
    if (found.size() == 1) return found.front();
    uint32_t place = 0;
    if (absl::SimpleAtoi(name, &place) && place < width_) return place;
    return Complain(
        field, ": there is no column ", Quoted(name), " but ",
        file_.header.empty()
            ? absl::StrCat(width_, " columns without names, 0 to ",
                           width_ - std::min<size_t>(width_, 1))
            : Printable(absl::StrJoin(file_.header, ", ").substr(0, 500)));
  }

  absl::Status FindTime() {
    if (skin_.time_column) {
      // Empty: the recording has no times, or none to be read.
      if (skin_.time_column->empty()) return absl::OkStatus();
      TACTUS_ASSIGN_OR_RETURN(const size_t place,
                              Place("time_column", *skin_.time_column));
      columns_.time.push_back(place);
      return absl::OkStatus();
    }
    for (size_t i = 0; i < file_.header.size(); ++i) {
      if (absl::EqualsIgnoreCase(file_.header[i], "time")) {
        columns_.time.push_back(i);
      }
    }
    if (columns_.time.size() < 2) return absl::OkStatus();
    return Complain("has ", columns_.time.size(),
                    " columns time; say which one is the time: "
                    "\"time_column\" in skin.json");
  }

  absl::Status FindPose() {
    const auto& names = PoseColumns();
    for (size_t i = 0; i < file_.header.size(); ++i) {
      const auto pose = std::find(names.begin(), names.end(), file_.header[i]);
      if (pose == names.end()) continue;
      if (static_cast<size_t>(pose - names.begin()) != columns_.pose.size()) {
        return Complain("column ", *pose, " is out of order; a pose is ",
                        absl::StrJoin(names, ", "));
      }
      columns_.pose.push_back(i);
    }
    if (columns_.pose.empty() || columns_.pose.size() == names.size()) {
      return absl::OkStatus();
    }
    return Complain("has ", columns_.pose.size(),
                    " columns of a pose; it takes ",
                    absl::StrJoin(names, ", "));
  }

  // The columns that a field of skin.json names, each or in ranges.
  absl::StatusOr<std::vector<size_t>> FindNamed(
      absl::string_view field, const std::vector<std::string>& names) const {
    std::vector<size_t> found;
    for (const std::string& name : names) {
      const size_t at = absl::string_view(name).find(kRange);
      if (at == absl::string_view::npos) {
        TACTUS_ASSIGN_OR_RETURN(const size_t column, Place(field, name));
        found.push_back(column);
        continue;
      }
      TACTUS_ASSIGN_OR_RETURN(const size_t first,
                              Place(field, name.substr(0, at)));
      TACTUS_ASSIGN_OR_RETURN(const size_t last,
                              Place(field, name.substr(at + kRange.size())));
      if (last < first) {
        return Complain(field, ": ", Quoted(name), " ends at column ", last,
                        ", before it begins at column ", first);
      }
      for (size_t i = first; i <= last; ++i) found.push_back(i);
    }
    for (const size_t time : columns_.time) {
      if (!Contains(found, time)) continue;
      return Complain(field, ": name ", ColumnName(file_, time),
                      ", which is the time; if it is none, say "
                      "\"time_column\": \"\" in skin.json");
    }
    return found;
  }

  absl::Status CheckDistinct() const {
    const std::set<size_t> distinct(columns_.taxels.begin(),
                                    columns_.taxels.end());
    if (distinct.size() == columns_.taxels.size()) return absl::OkStatus();
    return Complain("taxel_columns: name a column twice");
  }

  // The first column that is named as times are, among the taxels.
  std::optional<size_t> TimeLikeTaxel() const {
    if (columns_.taxels_are_named || file_.header.empty()) return {};
    for (const size_t column : columns_.taxels) {
      if (IsTimeName(file_.header[column])) return column;
    }
    return {};
  }

  absl::Status CheckTaxels() const {
    const std::vector<size_t>& shape = file_.array.shape;
    const auto time_like = TimeLikeTaxel();
    const std::string advice =
        time_like
            ? absl::StrCat(". The column ", Quoted(file_.header[*time_like]),
                           " is named as times are: say \"time_column\": ",
                           Quoted(file_.header[*time_like]),
                           " in skin.json, or name the taxels: "
                           "\"taxel_columns\"")
            : "";
    if (columns_.taxels.size() != skin_.frame_size()) {
      return Complain("has shape ", absl::StrJoin(shape, " x "),
                      file_.header.empty() && !columns_.taxels_are_named
                          ? ""
                          : absl::StrCat(", ", columns_.taxels.size(),
                                         " columns of taxels"),
                      "; it must be frames x ", skin_.frame_size(), advice,
                      advice.empty() ? ShapeAdvice() : "");
    }
    if (!time_like) return absl::OkStatus();
    return Complain("would have ", columns_.taxels.size(), " taxels", advice);
  }

  std::string ShapeAdvice() const {
    const std::vector<size_t>& shape = file_.array.shape;
    if (shape.size() == 2 && shape[0] == skin_.frame_size()) {
      return ". If each row is a taxel, say \"array_order\": \"columns first\" "
             "in skin.json for HDF5, or store it the other way round";
    }
    if (shape.size() == 2 && columns_.taxels.size() > skin_.frame_size()) {
      return file_.header.empty()
                 ? ". If a column is the time, say its place from 0: "
                   "\"time_column\": \"0\" in skin.json, or say those of the "
                   "taxels: \"taxel_columns\""
                 : ". Name those of the taxels: \"taxel_columns\" in skin.json";
    }
    size_t last = 1;
    for (size_t axis = shape.size(); axis-- > 2;) {
      last *= shape[axis];
      if (last != skin_.frame_size()) continue;
      return ". If each part along the first axis is a trial, name the parts "
             "in the table: FILE#0, FILE#1 ...";
    }
    return "";
  }

  void Describe() {
    if (file_.header.empty()) return;
    const std::vector<size_t>& taxels = columns_.taxels;
    columns_.found =
        absl::StrCat(columns_.time.empty()
                         ? "no column is the time"
                         : absl::StrCat("the time is ",
                                        Quoted(file_.header[columns_.time[0]])),
                     ", the ", taxels.size(), " taxels are ",
                     Quoted(file_.header[taxels.front()]), " to ",
                     Quoted(file_.header[taxels.back()]));
    std::vector<std::string> left;
    for (size_t i = 0; i < width_; ++i) {
      if (Contains(taxels, i) || Contains(columns_.time, i) ||
          Contains(columns_.pose, i)) {
        continue;
      }
      left.push_back(Quoted(file_.header[i]));
    }
    if (left.empty()) return;
    absl::StrAppend(&columns_.found,
                    "; not read: ", absl::StrJoin(left, ", ").substr(0, 300));
  }

  const std::string& path_;
  const ArrayFile& file_;
  const SkinFile& skin_;
  size_t width_ = 0;
  FrameColumns columns_;
};

}  // namespace

const std::vector<absl::string_view>& PoseColumns() {
  static const auto* const names =
      new std::vector<absl::string_view>{"x", "y", "z", "qx", "qy", "qz", "qw"};
  return *names;
}

std::string ColumnName(const ArrayFile& file, size_t column) {
  return file.header.empty() ? absl::StrCat("column ", column)
                             : Quoted(file.header[column]);
}

absl::StatusOr<FrameColumns> FindFrameColumns(const std::string& path,
                                              const ArrayFile& file,
                                              const SkinFile& skin) {
  return Finder(path, file, skin).Run();
}

}  // namespace tactus::internal
