#include "core/import/event_frames.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

constexpr int kAbsent = -1;

// Where in a row of the file each part of an event is.
struct EventColumns {
  int time = kAbsent;
  int taxel = kAbsent;
  int row = kAbsent;
  int column = kAbsent;
  int value = kAbsent;
};

absl::StatusOr<EventColumns> FindColumns(const std::string& path,
                                         const ArrayFile& file) {
  if (file.array.shape.size() != 2) {
    return TrialFileInvalid(
        path, absl::StrCat("has shape ", absl::StrJoin(file.array.shape, " x "),
                           "; a list of events has a row per event"));
  }
  EventColumns found;
  if (!file.header.empty()) {
    for (size_t i = 0; i < file.header.size(); ++i) {
      const std::pair<absl::string_view, int*> names[] = {
          {"time", &found.time},
          {"taxel", &found.taxel},
          {"row", &found.row},
          {"column", &found.column},
          {"value", &found.value}};
      for (const auto& [name, place] : names) {
        if (file.header[i] == name) *place = static_cast<int>(i);
      }
    }
    if (found.time != kAbsent &&
        (found.taxel != kAbsent ||
         (found.row != kAbsent && found.column != kAbsent))) {
      return found;
    }
    return TrialFileInvalid(
        path, absl::StrCat("has the columns ", absl::StrJoin(file.header, ", "),
                           "; events need time and taxel, or time, row and "
                           "column"));
  }
  switch (file.array.shape[1]) {
    case 2:
      return EventColumns{.time = 0, .taxel = 1};
    case 3:
      return EventColumns{.time = 0, .taxel = 1, .value = 2};
    case 4:
      return EventColumns{.time = 0, .row = 1, .column = 2, .value = 3};
    default:
      return TrialFileInvalid(
          path, absl::StrCat("has ", file.array.shape[1],
                             " columns; events have 2 (time, taxel), 3 (and "
                             "value) or 4 (time, row, column, value)"));
  }
}

struct Event {
  double time = 0;
  size_t taxel = 0;
  double value = 1;
};

class EventReader {
 public:
  EventReader(const std::string& path, const ArrayFile& file,
              const SkinFile& skin, const EventColumns& columns)
      : path_(path), file_(file), skin_(skin), columns_(columns) {}

  size_t size() const { return file_.array.shape[0]; }

  absl::StatusOr<Event> Read(size_t index) const {
    Event event;
    event.time = At(index, columns_.time) * skin_.time_scale_s;
    if (!(std::abs(event.time) <= limits::kMaxTrialTimeS)) {
      return Complain(index, "time is ", event.time, " s");
    }
    const auto place = [&](int column, size_t count) -> absl::StatusOr<size_t> {
      const double value = At(index, column);
      if (value >= 0 && value < static_cast<double>(count) &&
          value == std::floor(value)) {
        return static_cast<size_t>(value);
      }
      return Complain(index, "its taxel, row or column is ", value,
                      "; it must be a whole number from 0 to ", count - 1);
    };
    if (columns_.taxel != kAbsent) {
      TACTUS_ASSIGN_OR_RETURN(event.taxel,
                              place(columns_.taxel, skin_.event_taxels()));
    } else {
      TACTUS_ASSIGN_OR_RETURN(const size_t row,
                              place(columns_.row, skin_.event_rows()));
      TACTUS_ASSIGN_OR_RETURN(const size_t column,
                              place(columns_.column, skin_.layout.columns));
      event.taxel = row * skin_.layout.columns + column;
    }
    if (columns_.value != kAbsent) event.value = At(index, columns_.value);
    if (skin_.two_planes) {
      if (std::isnan(event.value)) {
        return Complain(index, "its polarity is no number");
      }
      if (!(event.value > 0)) event.taxel += skin_.event_taxels();
      event.value = 1;
    }
    return event;
  }

  template <typename... Parts>
  absl::Status Complain(size_t index, const Parts&... parts) const {
    return TrialFileInvalid(path_,
                            absl::StrCat("event ", index, ": ", parts...));
  }

 private:
  double At(size_t index, int column) const {
    return file_.Number(index * file_.array.shape[1] + column);
  }

  const std::string& path_;
  const ArrayFile& file_;
  const SkinFile& skin_;
  const EventColumns columns_;
};

}  // namespace

absl::StatusOr<EventFrames> MakeEventFrames(const std::string& path,
                                            const ArrayFile& file,
                                            const SkinFile& skin,
                                            double rate_hz) {
  TACTUS_ASSIGN_OR_RETURN(const EventColumns columns, FindColumns(path, file));
  if (skin.two_planes && columns.value == kAbsent) {
    return TrialFileInvalid(path,
                            "has no value per event; \"polarity\": \"two "
                            "planes\" needs one");
  }
  if (columns.row != kAbsent && skin.placed) {
    return TrialFileInvalid(
        path, "has rows and columns; with taxel_positions name taxels");
  }
  const EventReader events(path, file, skin, columns);
  if (events.size() == 0) return TrialFileInvalid(path, "holds no event");
  TACTUS_ASSIGN_OR_RETURN(const Event first, events.Read(0));
  TACTUS_ASSIGN_OR_RETURN(const Event last, events.Read(events.size() - 1));
  const double most = std::min<double>(
      limits::kMaxFramesPerTrial,
      limits::kMaxTrialArrayBytes / sizeof(double) / skin.frame_size());
  const double span = std::floor((last.time - first.time) * rate_hz) + 1;
  if (span > most) {
    return TrialFileInvalid(
        path, absl::StrCat("lasts ", last.time - first.time, " s, ", span,
                           " frames; at most ", most, " are made"));
  }
  const size_t size = skin.frame_size();
  EventFrames frames;
  std::vector<double> level(size, 0);
  size_t next = 0;
  double before = first.time;
  for (size_t frame = 0; static_cast<double>(frame) < span; ++frame) {
    if (skin.events == EventRule::kCount) level.assign(size, 0);
    frames.time.push_back(first.time + static_cast<double>(frame) / rate_hz);
    for (; next < events.size(); ++next) {
      TACTUS_ASSIGN_OR_RETURN(const Event event, events.Read(next));
      if (event.time < before) {
        return events.Complain(next, "time is ", event.time,
                               " s, before that of the event before, ", before);
      }
      const double at = (event.time - first.time) * rate_hz;
      if (at >= static_cast<double>(frame + 1)) break;
      before = event.time;
      if (skin.events == EventRule::kCount) {
        level[event.taxel] += 1;
      } else if (skin.events == EventRule::kSum) {
        level[event.taxel] += event.value;
      } else {
        level[event.taxel] = event.value;
      }
    }
    frames.numbers.insert(frames.numbers.end(), level.begin(), level.end());
  }
  return frames;
}

}  // namespace tactus::internal
