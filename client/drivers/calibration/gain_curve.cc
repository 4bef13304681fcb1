#include "client/drivers/calibration/gain_curve.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"

namespace tactus::internal::client {

absl::StatusOr<GainCurve> GainCurve::Make(std::vector<GainPoint> points) {
  if (points.empty()) {
    return InvalidConfig("gain curve", "empty", "one point or more");
  }
  GainPoint before;
  for (const GainPoint& point : points) {
    const bool rises =
        point.reading > before.reading && point.load > before.load;
    if (!rises || !std::isfinite(point.reading) || !std::isfinite(point.load)) {
      return InvalidConfig(
          "gain curve",
          absl::StrCat("load ", point.load, " at reading ", point.reading,
                       " after load ", before.load, " at reading ",
                       before.reading),
          "finite, with readings and loads that rise");
    }
    before = point;
  }
  return GainCurve(std::move(points));
}

double GainCurve::Load(double reading) const {
  const auto above = std::ranges::find_if(points_, [&](const GainPoint& point) {
    return point.reading >= reading;
  });
  // The last two points if the reading is beyond them.
  const auto end = above == points_.end() ? above - 1 : above;
  const GainPoint begin = end == points_.begin() ? GainPoint{} : *(end - 1);
  const double slope =
      (end->load - begin.load) / (end->reading - begin.reading);
  return begin.load + (reading - begin.reading) * slope;
}

}  // namespace tactus::internal::client
