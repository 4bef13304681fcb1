// File: icub_skin.h
//
// IcubSkin: the capacitive skin of the iCub on a CAN bus, as CanSkinDriver runs
// it.
//
//   icub::IcubSkin skin(patch, {.period_ms = 20});
//   CanSkinDriver driver(&bus, &skin, {});
//
// A taxel's value is the number of counts by which it is pressed: no_load minus
// what the board sends, at least 0. Setup discovers the boards, configures them
// and listens to a few scans; it masks triangles that are silent or faulty
// then, and says so in Remarks(). From then on a scan counts only with all
// other triangles. Configuring a board makes it take what it feels at that
// moment for untouched.
//
// Not thread-safe.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/drivers/can_skin_protocol.h"
#include "client/drivers/icub_skin/scan_assembler.h"
#include "client/drivers/icub_skin/skin_patch.h"

namespace tactus::internal::client::icub {

struct IcubSkinOptions {
  // 1 to 255. On one bus, 7 boards need more than 30.
  int period_ms = 20;
  uint8_t no_load = 245;
  uint8_t shift = 2;
  uint8_t compensation = 0;
  uint16_t converter_offset = 0x2200;
  // The layout's unit for each count.
  double scale = 1;
  // How long boards may take to answer a discovery, and to recalibrate.
  int64_t discovery_ns = 200'000'000;
  int64_t settling_ns = 500'000'000;
  // Scans that are listened to in Setup.
  int probe_scans = 10;
};

class IcubSkin : public CanSkinProtocol {
 public:
  // `patch` must be valid.
  IcubSkin(SkinPatch patch, const IcubSkinOptions& options);

  std::vector<CanFilter> Filters() const override;
  absl::StatusOr<SkinInfo> Setup(CanBus& bus, Clock& clock) override;
  absl::Status Start(CanBus& bus) override;
  absl::Status Stop(CanBus& bus) override;
  bool Take(const CanFrame& can, SkinFrame& frame) override;
  int64_t period_ns() const override {
    return int64_t{options_.period_ms} * 1'000'000;
  }
  uint64_t incomplete() const override;
  std::string Remarks() const override { return remarks_; }
  std::string Missing() const override;

  // What the last Setup found; null before.
  const ScanAssembler* assembler() const {
    return assembler_ ? &*assembler_ : nullptr;
  }

 private:
  absl::Status Discover(CanBus& bus, Clock& clock) const;
  absl::Status ConfigureBoards(CanBus& bus) const;
  absl::Status Probe(CanBus& bus, Clock& clock);
  absl::Status SendAll(CanBus& bus, bool start) const;
  SkinInfo MaskedInfo() const;

  const SkinPatch patch_;
  const IcubSkinOptions options_;
  std::optional<ScanAssembler> assembler_;
  // From before the last Setup.
  uint64_t earlier_incomplete_ = 0;
  std::string remarks_;
  SkinScan scan_;
};

}  // namespace tactus::internal::client::icub
