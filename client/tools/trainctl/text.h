// File: text.h
//
// How trainctl words numbers for people: fractions with their denominator and
// their 95 % interval.
//
//   Percent(0.8965)              "89.65 %"
//   WithCommas(1453)             "1,453"
//   PercentOf(1413, 1453)        "97.25 % (95 % interval 96.28 to 97.97 %)"
//   FeltContacts(1453, 1835)     "1,453 felt contacts; 382 of 1,835 were never
//                                felt"
//
// Thread-safe: free functions without state.
#pragma once

#include <string>

#include "client/tools/json.h"
#include "core/eval/metrics.h"

namespace tactus::client {

std::string Percent(double fraction);

// `count` >= 0, with a comma before every third digit from the right.
std::string WithCommas(int count);

// The fraction `right` of `count`, with its interval.
std::string PercentOf(int right, int count);

// The denominator of an accuracy: the contacts that the skin felt, and how many
// of all trials it never felt.
std::string FeltContacts(int felt, int trials);

// [low, high], as JSON.
Json IntervalToJson(const Interval& interval);

}  // namespace tactus::client
