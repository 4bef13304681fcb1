#include "tools/common/rate_news.h"

#include "absl/strings/str_format.h"

namespace tactus::internal::client {

std::string RateNews(double measured_hz, double stated_hz) {
  return absl::StrFormat(
      "the times of the frames are those of %.4g Hz, but the stream is "
      "configured for %g Hz: give the right rate, because a model sees frames "
      "and no times",
      measured_hz, stated_hz);
}

}  // namespace tactus::internal::client
