#include "tools/common/icub_source.h"

#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/drivers/can/gs_usb.h"
#include "client/drivers/can/socket_can.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/data/trial_layout.h"
#include "core/files/file_bytes.h"

namespace tactus::internal::client {
namespace {

constexpr size_t kMaxPositionFileBytes = 4 * 1024 * 1024;

absl::StatusOr<icub::SkinPatch> MakePatch(const IcubSourceOptions& options) {
  TACTUS_ASSIGN_OR_RETURN(const std::vector<icub::SkinBoard> boards,
                          icub::ParseBoards(options.boards));
  if (!options.positions.empty()) {
    TACTUS_ASSIGN_OR_RETURN(
        const std::string text,
        ReadFileBytes(options.positions, kMaxPositionFileBytes));
    const auto positions = icub::ParsePositions(text);
    if (!positions.ok()) {
      return Annotate(positions.status(), options.positions);
    }
    return icub::PlacedPatch(boards, *positions);
  }
  if (options.layout.empty()) return icub::PortPatch(boards);
  icub::SkinPatch patch;
  patch.boards = boards;
  TACTUS_ASSIGN_OR_RETURN(patch.layout, ReadLayoutFile(options.layout));
  patch.cells.resize(boards.size() * icub::kBoardValues);
  std::iota(patch.cells.begin(), patch.cells.end(), 0);
  const absl::Status fits = icub::Validate(patch);
  if (!fits.ok()) return Annotate(fits, options.layout);
  return patch;
}

}  // namespace

absl::Status AddMask(const std::vector<int>& taxels, SkinLayout& layout) {
  if (taxels.empty()) return absl::OkStatus();
  if (layout.mask.empty()) layout.mask.assign(layout.taxels(), 1);
  for (const int taxel : taxels) {
    if (taxel < 0 || taxel >= layout.taxels()) {
      return InvalidConfig("--mask", taxel,
                           absl::StrCat("0 to ", layout.taxels() - 1));
    }
    layout.mask[taxel] = 0;
  }
  return absl::OkStatus();
}

IcubSource::IcubSource(std::unique_ptr<CanBus> bus, icub::SkinPatch patch,
                       const icub::IcubSkinOptions& options,
                       const HardwareDriverOptions& driver)
    : bus_(std::move(bus)),
      skin_(std::move(patch), options),
      driver_(bus_.get(), &skin_, driver),
      buffered_(&driver_, {}) {}

absl::StatusOr<std::unique_ptr<IcubSource>> IcubSource::Make(
    const IcubSourceOptions& options, const HardwareDriverOptions& driver) {
  TACTUS_ASSIGN_OR_RETURN(icub::SkinPatch patch, MakePatch(options));
  TACTUS_RETURN_IF_ERROR(AddMask(options.mask, patch.layout));
  std::unique_ptr<CanBus> bus;
  if (options.usb) {
    bus = std::make_unique<GsUsb>(GsUsbOptions{.serial = options.usb_serial});
  } else {
    bus = std::make_unique<SocketCan>(options.interface);
  }
  return std::unique_ptr<IcubSource>(new IcubSource(
      std::move(bus), std::move(patch),
      {.period_ms = options.period_ms, .scale = options.scale}, driver));
}

}  // namespace tactus::internal::client
