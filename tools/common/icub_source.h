// File: icub_source.h
//
// IcubSource: the iCub's skin as a program's flags describe it: bus,
// protocol, driver, and the thread that reads it.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const auto source,
//       IcubSource::Make({.interface = "can0", .boards = "forearm-v2"}));
//   LivePlayer player(channel, &source->driver(), ...);
//
// Not thread-safe.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/drivers/buffered_driver.h"
#include "client/drivers/can_skin_driver.h"
#include "client/drivers/icub_skin/icub_skin.h"

namespace tactus::internal::client {

struct IcubSourceOptions {
  // With libusb; else through the kernel's `interface`.
  bool usb = false;
  std::string interface = {};
  std::string usb_serial = {};
  std::string boards = "forearm-v2";
  // A position file; or a layout in JSON whose cells are the port's values in
  // their order. Without either, one triangle per row.
  std::string positions = {};
  std::string layout = {};
  int period_ms = 20;
  double scale = 1;
  // Taxels, row-major, to mask besides.
  std::vector<int> mask = {};
};

// Masks taxels, row-major, of a real skin: --mask. INVALID_CONFIG if one is not
// on the layout.
absl::Status AddMask(const std::vector<int>& taxels, SkinLayout& layout);

class IcubSource {
 public:
  // INVALID_CONFIG or IO; opens no bus.
  static absl::StatusOr<std::unique_ptr<IcubSource>> Make(
      const IcubSourceOptions& options,
      const HardwareDriverOptions& driver = {});

  SkinDriver& driver() { return buffered_; }
  const CanBus& bus() const { return *bus_; }

 private:
  IcubSource(std::unique_ptr<CanBus> bus, icub::SkinPatch patch,
             const icub::IcubSkinOptions& options,
             const HardwareDriverOptions& driver);

  // In the order of their use; the last ends first.
  const std::unique_ptr<CanBus> bus_;
  icub::IcubSkin skin_;
  CanSkinDriver driver_;
  BufferedDriver buffered_;
};

}  // namespace tactus::internal::client
