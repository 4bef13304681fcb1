#include "client/tools/trainctl/text.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace tactus::client {

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

Json IntervalToJson(const Interval& interval) {
  return {interval.low, interval.high};
}

}  // namespace tactus::client
