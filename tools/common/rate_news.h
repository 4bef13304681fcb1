// File: rate_news.h
//
// What users read if frames come at another rate than the configured one.
//
//   if (rate_is_odd) Print(RateNews(/*measured_hz=*/50, /*stated_hz=*/100));
//
// Thread-safe: a free function without state.
#pragma once

#include <string>

namespace tactus::internal::client {

// A sentence that names both rates and what to do.
std::string RateNews(double measured_hz, double stated_hz);

}  // namespace tactus::internal::client
