// File: can_skin_driver.h
//
// CanSkinDriver: HardwareDriver for skins on a CAN bus, with any adapter and
// any protocol.
//
//   icub::IcubSkin skin(patch, {});
//   CanSkinDriver driver(&bus, &skin, {});
//
// Not thread-safe.
#pragma once

#include <string>

#include "client/drivers/can_skin_protocol.h"
#include "client/drivers/hardware_driver.h"

namespace tactus::internal::client {

// A protocol on a bus; both outlive it.
class CanSkin : public SkinDevice {
 public:
  CanSkin(CanBus* bus, CanSkinProtocol* protocol)
      : bus_(bus), protocol_(protocol) {}

  std::string name() const override { return bus_->name(); }
  absl::Status Open() override { return bus_->Open(protocol_->Filters()); }
  void Close() override { bus_->Close(); }
  absl::StatusOr<SkinInfo> Setup(Clock& clock) override {
    return protocol_->Setup(*bus_, clock);
  }
  absl::Status Start() override { return protocol_->Start(*bus_); }
  absl::Status Stop() override { return protocol_->Stop(*bus_); }
  absl::StatusOr<bool> Poll(SkinFrame& frame, int64_t timeout_ns) override;
  int64_t period_ns() const override { return protocol_->period_ns(); }
  uint64_t incomplete() const override { return protocol_->incomplete(); }
  std::string Remarks() const override { return protocol_->Remarks(); }
  std::string Missing() const override { return protocol_->Missing(); }

 private:
  CanBus* const bus_;
  CanSkinProtocol* const protocol_;
};

class CanSkinDriver : public HardwareDriver {
 public:
  // `bus`, `protocol` and `clock` outlive the driver.
  CanSkinDriver(CanBus* bus, CanSkinProtocol* protocol,
                const HardwareDriverOptions& options,
                Clock* clock = &Clock::System())
      : HardwareDriver(&skin_, options, clock), skin_(bus, protocol) {}
  // Before skin_ ends.
  ~CanSkinDriver() override { Finalise().IgnoreError(); }

 private:
  CanSkin skin_;
};

}  // namespace tactus::internal::client
