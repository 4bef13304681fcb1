// File: wilson_interval.h
//
// How well a fraction is known that was counted.
//
//   const Interval interval = WilsonInterval(/*successes=*/48, /*count=*/50);
//   interval.low;  // 0.865
//
// Plain data and a free function without state; thread-safe.
#pragma once

namespace tactus::internal {

struct Interval {
  double low = 0;
  double high = 1;
};

// The 95 % interval of a fraction of which `successes` out of `count` were
// seen: Wilson's score interval (JASA 22, 1927). [0, 1] for a count of 0.
Interval WilsonInterval(int successes, int count);

}  // namespace tactus::internal
