// File: xela_patch.h
//
// XelaPatch: a XELA uSkin patch of 4 x 4 taxels on a CAN bus, simulated: it
// starts and stops with the messages of an iCub's board, and sends X, Y and Z
// of each taxel 100 times a second.
//
//   XelaPatch patch(PressXela);
//   patch.dead_taxel = 9;
//
// Not thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>

#include "tools/fakeskin/can_peer.h"

namespace tactus::internal::client {

class XelaPatch : public CanPeer {
 public:
  static constexpr int kTaxels = 16;
  static constexpr int kValues = 3 * kTaxels;
  static constexpr int64_t kPeriodNs = 10'000'000;

  // Writes by how many counts each value is above that of the untouched patch
  // at a time: x, y and z of taxel 0 first. All are 0 before.
  using Source = std::function<void(int64_t time_ns, std::span<double> counts)>;

  explicit XelaPatch(Source source) : source_(std::move(source)) {}

  // A taxel that sends nothing; -1 for none.
  int dead_taxel = -1;

  bool IsSending() const { return sending_; }

  void OnFrame(const CanFrame& frame, int64_t now_ns) override;
  int64_t NextNs() override { return sending_ ? next_ns_ : kNever; }
  bool Emit(int64_t now_ns, CanFrame& frame) override;

 private:
  const Source source_;
  bool sending_ = false;
  // The taxel that is sent next, and when.
  int taxel_ = 0;
  int64_t next_ns_ = 0;
  // The present scan.
  std::array<double, kValues> counts_ = {};
};

// Presses that come every 4 s and last 2 s: from the second second on, a taxel
// and its neighbours are pressed with a load that rises, holds and falls, while
// shear turns.
void PressXela(int64_t time_ns, std::span<double> counts);

}  // namespace tactus::internal::client
