#include "client/drivers/skin_driver.h"

#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

absl::string_view Name(DriverState state) {
  switch (state) {
    case DriverState::kUnconfigured:
      return "unconfigured";
    case DriverState::kInactive:
      return "inactive";
    case DriverState::kActive:
      return "active";
    case DriverState::kFinalised:
      return "finalised";
  }
  return "unknown";
}

}  // namespace

absl::Status SkinDriver::Expect(DriverState state) const {
  if (state_ == state) return absl::OkStatus();
  return InvalidConfig("driver state", Name(state_), Name(state));
}

absl::StatusOr<SkinInfo> SkinDriver::Configure() {
  TACTUS_RETURN_IF_ERROR(Expect(DriverState::kUnconfigured));
  TACTUS_ASSIGN_OR_RETURN(SkinInfo info, OnConfigure());
  state_ = DriverState::kInactive;
  return info;
}

absl::Status SkinDriver::Activate() {
  TACTUS_RETURN_IF_ERROR(Expect(DriverState::kInactive));
  TACTUS_RETURN_IF_ERROR(OnActivate());
  state_ = DriverState::kActive;
  return absl::OkStatus();
}

absl::Status SkinDriver::Deactivate() {
  TACTUS_RETURN_IF_ERROR(Expect(DriverState::kActive));
  TACTUS_RETURN_IF_ERROR(OnDeactivate());
  state_ = DriverState::kInactive;
  return absl::OkStatus();
}

absl::StatusOr<ReadResult> SkinDriver::Read(SkinFrame& frame) {
  TACTUS_RETURN_IF_ERROR(Expect(DriverState::kActive));
  return OnRead(frame);
}

absl::Status SkinDriver::Finalise() {
  if (state_ == DriverState::kFinalised) return absl::OkStatus();
  absl::Status deactivated;
  if (state_ == DriverState::kActive) deactivated = OnDeactivate();
  state_ = DriverState::kFinalised;
  const absl::Status finalised = OnFinalise();
  return finalised.ok() ? deactivated : finalised;
}

}  // namespace tactus::internal::client
