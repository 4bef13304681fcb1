// File: text.h
//
// How trainctl words numbers for people: fractions with their denominator and
// their 95 % interval.
//
//   Percent(0.8965)              "89.65 %"
//   WithCommas(1453)             "1,453"
//   ClockText(65)                "1:05"
//   TimeText(0)                  "1970-01-01 00:00:00"
//   PercentOf(1413, 1453)        "97.25 % (95 % interval 96.28 to 97.97 %)"
//   FeltContacts(1453, 1835)     "1,453 felt contacts; 382 of 1,835 were never
//                                felt"
//
// Thread-safe: free functions without state.
#pragma once

#include <cstdint>
#include <string>

#include "core/eval/metrics.h"
#include "core/skin/layout.h"
#include "tools/common/json.h"

namespace tactus::internal::client {

std::string Percent(double fraction);

// `count` >= 0, with a comma before every third digit from the right.
std::string WithCommas(int count);

// Minutes and seconds, and hours if there are any; rounded up.
std::string ClockText(double seconds);

// The UTC time that is `ms` milliseconds after the beginning of 1970.
std::string TimeText(int64_t ms);

// The fraction `right` of `count`, with its interval.
std::string PercentOf(int right, int count);

// The denominator of an accuracy: the contacts that the skin felt, and how many
// of all trials it never felt.
std::string FeltContacts(int felt, int trials);

// One line on a skin: its name, shape, unit and thresholds. Ends with a
// newline.
std::string SkinText(const SkinLayout& skin);

// [low, high], as JSON.
Json IntervalToJson(const Interval& interval);

}  // namespace tactus::internal::client
