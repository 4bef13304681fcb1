// File: token_bucket.h
//
// TokenBucket: how often something may happen: at a steady rate, and in bursts.
//
//   TokenBucket pings({.per_second = 100, .burst = 1000});
//   if (!pings.Take(now_ns)) CloseConnection("too many pings");
//
// Holds two numbers; allocates nothing. Not thread-safe.
#pragma once

#include <cstdint>

namespace tactus::internal {

class TokenBucket {
 public:
  struct Rate {
    double per_second = 0;
    // Most that may happen at once after a silence.
    double burst = 0;
  };

  explicit TokenBucket(const Rate& rate) : rate_(rate), tokens_(rate.burst) {}

  // Takes one token; false if there is none. `now_ns` is of any monotonic
  // clock.
  bool Take(int64_t now_ns);

 private:
  const Rate rate_;
  double tokens_;
  int64_t last_ns_ = 0;
};

}  // namespace tactus::internal
