#include "client/front/wrapped_driver.h"

#include <utility>

#include "client/front/skin_convert.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

class WrappedDriver : public SkinDriver {
 public:
  explicit WrappedDriver(std::unique_ptr<Driver> driver)
      : driver_(std::move(driver)) {}

  DriverStatistics Statistics() const override { return driver_->Statistics(); }

 protected:
  absl::StatusOr<SkinInfo> OnConfigure() override {
    TACTUS_ASSIGN_OR_RETURN(const Skin skin, driver_->Configure());
    TACTUS_ASSIGN_OR_RETURN(info_, ToSkinInfo(skin));
    return info_;
  }
  absl::Status OnActivate() override { return driver_->Activate(); }
  absl::Status OnDeactivate() override { return driver_->Deactivate(); }
  absl::Status OnFinalise() override { return driver_->Finalise(); }
  absl::StatusOr<ReadResult> OnRead(SkinFrame& frame) override {
    frame_.missing_before = 0;
    TACTUS_ASSIGN_OR_RETURN(const ReadResult result, driver_->Read(frame_));
    if (result == ReadResult::kFrame) {
      TACTUS_RETURN_IF_ERROR(ToSkinFrame(frame_, info_, frame));
    }
    return result;
  }

 private:
  const std::unique_ptr<Driver> driver_;
  SkinInfo info_;
  Frame frame_;
};

class ExposedDriver : public Driver {
 public:
  explicit ExposedDriver(std::shared_ptr<SkinDriver> driver)
      : driver_(std::move(driver)) {}

  absl::StatusOr<Skin> Configure() override {
    TACTUS_ASSIGN_OR_RETURN(info_, driver_->Configure());
    return ToSkin(info_);
  }
  absl::Status Activate() override { return driver_->Activate(); }
  absl::Status Deactivate() override { return driver_->Deactivate(); }
  absl::Status Finalise() override { return driver_->Finalise(); }
  absl::StatusOr<ReadResult> Read(Frame& frame) override {
    TACTUS_ASSIGN_OR_RETURN(const ReadResult result, driver_->Read(frame_));
    if (result == ReadResult::kFrame) ToFrame(frame_, info_, frame);
    return result;
  }
  DriverStatistics Statistics() const override { return driver_->Statistics(); }

 private:
  const std::shared_ptr<SkinDriver> driver_;
  SkinInfo info_;
  SkinFrame frame_;
};

}  // namespace

std::unique_ptr<SkinDriver> WrapDriver(std::unique_ptr<Driver> driver) {
  return std::make_unique<WrappedDriver>(std::move(driver));
}

std::unique_ptr<Driver> ExposeDriver(std::shared_ptr<SkinDriver> driver) {
  return std::make_unique<ExposedDriver>(std::move(driver));
}

}  // namespace tactus::internal::client
