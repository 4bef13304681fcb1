// File: xela_skin.h
//
// XelaSkin: a XELA uSkin patch of 4 x 4 magnetic taxels on a CAN bus, as
// CanSkinDriver runs it.
//
//   XelaSkin skin({.board = 1});
//   CanSkinDriver driver(&bus, &skin, {});
//
// Every 10 ms the patch sends a frame for each taxel, id 0x710 + taxel, with a
// byte of status and X, Y and Z as big-endian numbers of 16 bits. It starts and
// stops with the messages of an iCub's board. A taxel's values are how far X, Y
// and Z are above their means in Setup, as int16; beyond its limits they are
// cut off. So nothing must touch the patch in Setup. A layout of one axis gets
// Z alone, at least 0, as uint16. A scan counts if all 16 taxels have come
// within 0.9 periods; the rules are those of icub::ScanAssembler.
//
// Ids and bytes are those of public code (o2as/ur-o2as); they were not verified
// with a patch. Not thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "client/drivers/can_skin_protocol.h"
#include "core/skin/layout.h"

namespace tactus::internal::client {

// 4 x 4 taxels 4.7 mm apart of three axes, the load being Z, in counts, with
// nominal thresholds.
SkinLayout XelaLayout();

struct XelaSkinOptions {
  int board = 1;
  // 4 x 4, of three signed axes with Z as the normal one, or of one axis.
  SkinLayout layout = XelaLayout();
  double scale = 1;
  // Scans whose mean is an untouched patch.
  int baseline_scans = 50;
};

class XelaSkin : public CanSkinProtocol {
 public:
  static constexpr int kTaxels = 16;
  static constexpr int64_t kPeriodNs = 10'000'000;

  explicit XelaSkin(const XelaSkinOptions& options) : options_(options) {}

  std::vector<CanFilter> Filters() const override;
  absl::StatusOr<SkinInfo> Setup(CanBus& bus, Clock& clock) override;
  absl::Status Start(CanBus& bus) override;
  absl::Status Stop(CanBus& bus) override;
  bool Take(const CanFrame& can, SkinFrame& frame) override;
  int64_t period_ns() const override { return kPeriodNs; }
  uint64_t incomplete() const override { return incomplete_; }
  std::string Remarks() const override { return ""; }
  std::string Missing() const override;

 private:
  static constexpr int kAxes = 3;
  static constexpr int kZ = 2;

  // True if the frame completed scan_.
  bool Collect(const CanFrame& can);
  // How far a value is above its baseline.
  double Above(int value) const { return scan_[value] - baseline_[value]; }

  const XelaSkinOptions options_;
  // X, Y and Z of each taxel.
  std::array<uint16_t, kAxes* kTaxels> scan_ = {};
  std::array<double, kAxes* kTaxels> baseline_ = {};
  // Bit i: taxel i has come.
  uint16_t heard_ = 0;
  // Since the last whole scan.
  uint16_t heard_recently_ = 0;
  int64_t start_ns_ = 0;
  CanFrame last_;
  uint64_t incomplete_ = 0;
};

}  // namespace tactus::internal::client
