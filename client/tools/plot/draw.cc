#include "client/tools/plot/draw.h"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::client {

absl::Status CheckSeriesCount(size_t count) {
  if (count < 1 || count > kMaxSeries) {
    return InvalidConfig("number of series", count,
                         absl::StrCat("1 to ", kMaxSeries));
  }
  return absl::OkStatus();
}

absl::StatusOr<DataRange> RangeOf(const std::vector<double>& values,
                                  const std::string& what) {
  if (values.empty()) return InvalidConfig(what, "nothing", "at least 1 value");
  for (double value : values) {
    if (!std::isfinite(value)) {
      return InvalidConfig(what, value, "finite values");
    }
  }
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return DataRange{*low, *high};
}

absl::StatusOr<std::string> EncodePng(const Figure& figure) {
  TACTUS_ASSIGN_OR_RETURN(
      const Canvas canvas,
      std::visit([](const auto& kind) { return Draw(kind); }, figure));
  return canvas.EncodePng();
}

absl::Status WritePng(const Figure& figure, const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(const std::string bytes, EncodePng(figure));
  std::ofstream file(path, std::ios::binary);
  file << bytes;
  file.flush();
  if (!file) return IoError(path, "cannot be written");
  return absl::OkStatus();
}

}  // namespace tactus::client
