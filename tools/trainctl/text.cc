#include "tools/trainctl/text.h"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/data/trial.h"

namespace tactus::internal::client {

std::string Percent(double fraction) {
  return absl::StrFormat("%.2f %%", 100 * fraction);
}

std::string WithCommas(int count) {
  std::string text = absl::StrCat(count);
  for (int place = static_cast<int>(text.size()) - 3; place > 0; place -= 3) {
    text.insert(place, 1, ',');
  }
  return text;
}

std::string ClockText(double seconds) {
  const auto all = static_cast<int64_t>(std::ceil(seconds));
  const int64_t hours = all / 3600;
  const int64_t minutes = all / 60 % 60;
  if (hours == 0) return absl::StrFormat("%d:%02d", minutes, all % 60);
  return absl::StrFormat("%d:%02d:%02d", hours, minutes, all % 60);
}

std::string TimeText(int64_t ms) {
  const std::time_t seconds = ms / 1000;
  std::tm utc = {};
  gmtime_r(&seconds, &utc);
  char text[32];
  return std::string(
      text, std::strftime(text, sizeof(text), "%Y-%m-%d %H:%M:%S", &utc));
}

std::string PercentOf(int right, int count) {
  const Interval interval = WilsonInterval(right, count);
  return absl::StrFormat(
      "%s (95 %% interval %.2f to %.2f %%)",
      Percent(count > 0 ? static_cast<double>(right) / count : 0),
      100 * interval.low, 100 * interval.high);
}

std::string FeltContacts(int felt, int trials) {
  return absl::StrFormat("%s felt contacts; %s of %s were never felt",
                         WithCommas(felt), WithCommas(trials - felt),
                         WithCommas(trials));
}

std::string SkinText(const SkinLayout& skin) {
  const auto masked = std::count(skin.mask.begin(), skin.mask.end(), 0);
  return absl::StrFormat(
      "skin %s: %d x %d taxels%s%s%s, %s; contact from %g, onset from %g\n",
      skin.name, skin.rows, skin.columns,
      skin.axes > 1 ? absl::StrFormat(" of %d axes", skin.axes) : "",
      skin.wrap_columns ? ", columns wrapped" : "",
      masked > 0 ? absl::StrFormat(", %d masked", masked) : "",
      UnitText(skin.unit), skin.contact_threshold, skin.onset_threshold);
}

Json IntervalToJson(const Interval& interval) {
  return {interval.low, interval.high};
}

}  // namespace tactus::internal::client
