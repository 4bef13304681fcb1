// A skin that sends float32, as AnySkin, never had a stuck taxel listed: the
// check looked at the values of another type, which such a frame does not have.
#include "client/drivers/hardware_driver.h"
#include "core/base/random.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal::client {
namespace {

constexpr int kFloatTaxels = 6;
constexpr int kStuck = 4;
constexpr int64_t kPeriodNs = 10'000'000;
// Frames of more than the ten seconds after which a taxel is stuck.
constexpr int kFrames = 1'020;

// Each taxel is pressed and has noise, but one, which does not move.
class FloatSkin final : public SkinDevice {
 public:
  std::string name() const override { return "float skin"; }
  absl::Status Open() override { return absl::OkStatus(); }
  void Close() override {}
  absl::StatusOr<SkinInfo> Setup(Clock&) override {
    SkinInfo info;
    info.layout = {.name = "floats",
                   .rows = 2,
                   .columns = 3,
                   .unit = TaxelUnit::kCounts,
                   .contact_threshold = 10,
                   .axes = 3,
                   .signed_values = true};
    info.taxel_type = v1::TAXEL_TYPE_FLOAT32;
    info.sample_rate_hz = 1e9 / kPeriodNs;
    return info;
  }
  absl::Status Start() override { return absl::OkStatus(); }
  absl::Status Stop() override { return absl::OkStatus(); }
  absl::StatusOr<bool> Poll(SkinFrame& frame, int64_t) override {
    frame.f32.resize(3 * kFloatTaxels);
    for (int i = 0; i < kFloatTaxels; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        const double noise = i == kStuck ? 0 : random_.Gaussian();
        frame.f32[3 * i + axis] = static_cast<float>(-100 * axis + noise);
      }
    }
    frame.capture_time_ns = ++frames_ * kPeriodNs;
    return true;
  }
  int64_t period_ns() const override { return kPeriodNs; }
  uint64_t incomplete() const override { return 0; }
  std::string Remarks() const override { return ""; }
  std::string Missing() const override { return ""; }

 private:
  Random random_{1};
  int64_t frames_ = 0;
};

TEST(StuckTaxelOfFloatValuesTest, IsListed) {
  FloatSkin skin;
  HardwareDriver driver(&skin, {});
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  SkinFrame frame;
  for (int i = 0; i < kFrames; ++i) {
    ASSERT_EQ(*driver.Read(frame), ReadResult::kFrame);
  }
  EXPECT_THAT(driver.Statistics().stuck_taxels, ::testing::ElementsAre(kStuck));
}

}  // namespace
}  // namespace tactus::internal::client
