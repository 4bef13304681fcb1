// A driver that tactus-stream loads: one touch that grows for a second.
#include <memory>
#include <string>

#include "client/drivers/driver_plugin.h"

namespace {

using tactus::client::DriverOptions;
using tactus::client::DriverStatistics;
using tactus::client::ReadResult;
using tactus::client::SkinDriver;
using tactus::client::SkinFrame;
using tactus::client::SkinInfo;

class MySkin : public SkinDriver {
 public:
  explicit MySkin(int steps) : steps_(steps) {}

  DriverStatistics Statistics() const override {
    DriverStatistics statistics;
    statistics.frames = step_;
    statistics.connected = true;
    return statistics;
  }

 private:
  absl::StatusOr<SkinInfo> OnConfigure() override {
    SkinInfo info;
    info.layout = {.name = "cody-forearm",
                   .rows = 16,
                   .columns = 24,
                   .row_pitch_m = 0.0108,
                   .column_pitch_m = 0.01205324381427284,
                   .taxel_area_m2 = 81e-6,
                   .wrap_columns = true,
                   .contact_threshold = 0.01,
                   .onset_threshold = 0.02};
    info.scale = 0.001;  // The skin counts millinewtons.
    return info;
  }

  absl::StatusOr<ReadResult> OnRead(SkinFrame& frame) override {
    if (step_ == steps_) return ReadResult::kEndOfData;
    frame.capture_time_ns = 10'000'000L * step_;
    frame.u16.assign(16 * 24, 0);  // Read your skin here.
    for (const int taxel : {180, 181, 204, 205}) frame.u16[taxel] = 20 * step_;
    ++step_;
    return ReadResult::kFrame;
  }

  const int steps_;
  int step_ = 0;
};

absl::StatusOr<std::unique_ptr<SkinDriver>> Make(const DriverOptions& options) {
  const auto steps = options.find("steps");
  if (steps == options.end()) {
    return absl::InvalidArgumentError("--driver-option=steps=N is missing");
  }
  return std::make_unique<MySkin>(std::stoi(steps->second));
}

}  // namespace

TACTUS_SKIN_DRIVER(Make)
