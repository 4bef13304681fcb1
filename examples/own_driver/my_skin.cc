// A driver that tactus-stream loads: one touch that grows for a second.
#include <cstdlib>
#include <memory>

#include "tactus/driver.h"

namespace {

constexpr int kRows = 16;
constexpr int kColumns = 24;

class MySkin : public tactus::Driver {
 public:
  explicit MySkin(int steps) : steps_(steps) {}

  absl::StatusOr<tactus::Skin> Configure() override {
    return tactus::Skin{.name = "cody-forearm",
                        .rows = kRows,
                        .columns = kColumns,
                        .row_pitch_m = 0.0108,
                        .column_pitch_m = 0.01205324381427284,
                        .taxel_area_m2 = 81e-6,
                        .wrap_columns = true,
                        .contact_threshold = 0.01,
                        .onset_threshold = 0.02,
                        .scale = 0.001};  // The skin counts millinewtons.
  }

  absl::StatusOr<tactus::ReadResult> Read(tactus::Frame& frame) override {
    if (step_ == steps_) return tactus::ReadResult::kEndOfData;
    frame.capture_time_ns = 10'000'000L * step_;
    frame.values.assign(kRows * kColumns, 0);  // Read your skin here.
    for (const int taxel : {180, 181, 204, 205}) {
      frame.values[taxel] = 20.0F * static_cast<float>(step_);
    }
    ++step_;
    return tactus::ReadResult::kFrame;
  }

  tactus::DriverStatistics Statistics() const override {
    tactus::DriverStatistics statistics;
    statistics.frames = step_;
    statistics.connected = true;
    return statistics;
  }

 private:
  const int steps_;
  int step_ = 0;
};

absl::StatusOr<std::unique_ptr<tactus::Driver>> Make(
    const tactus::DriverOptions& options) {
  const auto steps = options.find("steps");
  if (steps == options.end()) {
    return absl::InvalidArgumentError("--driver-option=steps=N is missing");
  }
  return std::make_unique<MySkin>(std::atoi(steps->second.c_str()));
}

}  // namespace

TACTUS_DRIVER(Make)
