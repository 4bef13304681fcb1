#include "core/data/touch.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/limits.h"
#include "core/base/text.h"

namespace tactus::internal {
namespace {

std::string TextsFault(const Touch& touch) {
  const struct {
    absl::string_view name;
    const std::string& value;
  } texts[] = {{"label", touch.label},
               {"object", touch.object},
               {"material", touch.material}};
  for (const auto& text : texts) {
    const std::string fault = TextFault(text.value, limits::kMaxTrialTextBytes);
    if (!fault.empty()) return absl::StrCat(text.name, ": ", fault);
  }
  return "";
}

std::string NumbersFault(const Touch& touch) {
  // Written so that a NaN fails.
  if (!(touch.stiffness >= 0 && std::isfinite(touch.stiffness))) {
    return absl::StrCat("stiffness is ", touch.stiffness,
                        " N/m; it must be finite and at least 0");
  }
  if (!touch.centre) return "";
  const SkinPoint& centre = *touch.centre;
  if (!(centre.row >= 0 && centre.row <= limits::kMaxRows)) {
    return absl::StrCat("row is ", centre.row, "; it must be 0 to ",
                        limits::kMaxRows);
  }
  if (!(centre.column >= 0 && centre.column <= limits::kMaxColumns)) {
    return absl::StrCat("column is ", centre.column, "; it must be 0 to ",
                        limits::kMaxColumns);
  }
  return "";
}

std::string TimesFault(const Touch& touch, double earliest_s,
                       const std::vector<double>& time) {
  if (!(touch.begin_s >= earliest_s && touch.begin_s <= time.back())) {
    return absl::StrCat("begin_s is ", touch.begin_s, " s; it must be ",
                        earliest_s, " to ", time.back(),
                        " s: within the trial, and not before the begin of "
                        "the touch before");
  }
  if (!(touch.end_s >= touch.begin_s && touch.end_s <= time.back())) {
    return absl::StrCat("end_s is ", touch.end_s, " s; it must be begin_s, ",
                        touch.begin_s, ", to ", time.back(), " s");
  }
  return "";
}

std::string MotionFault(const Touch& touch, const std::vector<double>& time) {
  const std::vector<double>& motion = touch.object_motion;
  if (motion.empty()) return "";
  const auto frames = std::upper_bound(time.begin(), time.end(), touch.end_s) -
                      std::lower_bound(time.begin(), time.end(), touch.begin_s);
  if (static_cast<size_t>(frames) != motion.size()) {
    return absl::StrCat("object_motion has ", motion.size(),
                        " entries; it must have one per time from begin_s to "
                        "end_s, ",
                        frames);
  }
  for (size_t i = 0; i < motion.size(); ++i) {
    if (!(std::abs(motion[i]) <= limits::kMaxPositionM)) {
      return absl::StrCat("entry ", i, " of object_motion is ", motion[i],
                          "; it must be finite and at most 1e6 m from 0");
    }
  }
  return "";
}

}  // namespace

std::string TouchName(size_t index) { return absl::StrFormat("%02d", index); }

std::string TouchesFault(const std::vector<Touch>& touches,
                         const std::vector<double>& time) {
  if (touches.size() > limits::kMaxTouchesPerTrial) {
    return absl::StrCat("there are ", touches.size(), "; at most ",
                        limits::kMaxTouchesPerTrial, " are allowed");
  }
  double earliest_s = time.front();
  for (size_t i = 0; i < touches.size(); ++i) {
    std::string fault = TimesFault(touches[i], earliest_s, time);
    if (fault.empty()) fault = TextsFault(touches[i]);
    if (fault.empty()) fault = NumbersFault(touches[i]);
    if (fault.empty()) fault = MotionFault(touches[i], time);
    if (!fault.empty()) return absl::StrCat(i, ": ", fault);
    earliest_s = touches[i].begin_s;
  }
  return "";
}

}  // namespace tactus::internal
