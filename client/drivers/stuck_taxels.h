// File: stuck_taxels.h
//
// StuckTaxels: finds taxels that read the same value above 0 for a long time.
// A touched taxel has noise; one whose value does not move is broken, and a
// contact on it never ends.
//
//   StuckTaxels stuck(/*frames=*/500);
//   stuck.Add(loads.Of(values));  // core/skin/normal_loads.h
//   for (int taxel : stuck.Taxels()) Mask(taxel);
//
// Allocates at the first frame only, but for Taxels(). Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tactus::internal::client {

class StuckTaxels {
 public:
  // A taxel is stuck after `frames` frames with one value.
  explicit StuckTaxels(uint32_t frames) : frames_(frames) {}

  // All frames have one size.
  void Add(std::span<const float> loads);
  // Row-major indices, rising.
  std::vector<int> Taxels() const;

 private:
  const uint32_t frames_;
  std::vector<float> loads_;
  // Frames for which each taxel has had its value.
  std::vector<uint32_t> runs_;
};

}  // namespace tactus::internal::client
