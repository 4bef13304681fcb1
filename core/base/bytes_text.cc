#include "core/base/bytes_text.h"

#include "absl/strings/str_format.h"

namespace tactus::internal {

std::string BytesText(int64_t bytes) {
  const char* const units[] = {"B", "kB", "MB", "GB", "TB"};
  auto value = static_cast<double>(bytes);
  int unit = 0;
  for (; value >= 999.5 && unit < 4; ++unit) value /= 1000;
  return absl::StrFormat("%.3g %s", value, units[unit]);
}

}  // namespace tactus::internal
