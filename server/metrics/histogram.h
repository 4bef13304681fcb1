// File: histogram.h
//
// Histogram: how often values fell between fixed bounds.
//
//   Histogram seconds(kFrameSeconds);
//   seconds.Observe(0.0003);
//   seconds.Read().sum;
//
// Thread-safe, lock-free; Observe allocates nothing.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

namespace tactus::internal::server {

// Bounds for the time that a frame takes and that its answer waits: 50 us to 1
// s.
inline constexpr std::array kFrameSeconds = {
    0.00005, 0.0001, 0.0002, 0.0005, 0.001, 0.002, 0.003,
    0.005,   0.01,   0.02,   0.05,   0.1,   0.3,   1.0};
// Bounds for the time from onset to a decision, and for calls.
inline constexpr std::array kCallSeconds = {0.005, 0.01, 0.02, 0.05, 0.1, 0.2,
                                            0.5,   1.0,  2.0,  5.0,  10.0};

class Histogram {
 public:
  struct Data {
    // One per bound: values at or below it; and of all values.
    std::vector<uint64_t> at_most;
    uint64_t count = 0;
    double sum = 0;

    // `other` has the same bounds.
    void Add(const Data& other);
  };

  // Rising; must outlive it.
  explicit Histogram(std::span<const double> bounds)
      : bounds_(bounds), counts_(bounds.size() + 1) {}

  void Observe(double value, uint64_t times = 1);
  Data Read() const;
  std::span<const double> bounds() const { return bounds_; }

 private:
  const std::span<const double> bounds_;
  // Between two bounds each; the last above all of them.
  std::vector<std::atomic<uint64_t>> counts_;
  std::atomic<double> sum_ = 0;
};

}  // namespace tactus::internal::server
