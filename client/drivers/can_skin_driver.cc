#include "client/drivers/can_skin_driver.h"

#include "core/base/status_macros.h"

namespace tactus::internal::client {

absl::StatusOr<bool> CanSkin::Poll(SkinFrame& frame, int64_t timeout_ns) {
  CanFrame can;
  TACTUS_ASSIGN_OR_RETURN(const bool received, bus_->Receive(can, timeout_ns));
  return received && protocol_->Take(can, frame);
}

}  // namespace tactus::internal::client
