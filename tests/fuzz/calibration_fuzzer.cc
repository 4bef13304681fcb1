// Any text as a calibration of one or three axes, as what a recording keeps of
// one, and as gain curves and cross-axis matrices within them. What is read
// must be valid, and come back with the same bits.
//
// Its corpus, tests/fuzz/corpus/calibration, begins with good texts. With
// TACTUS_SEEDS=FOLDER the empty input writes them there.
#include "client/drivers/calibration/calibration_in_use.h"
#include "client/drivers/calibration/calibration_json.h"
#include "tests/fuzz/damaged.h"
#include "tests/support/flat_layout.h"

namespace {

using namespace tactus::internal;
using namespace tactus::internal::client;

Calibration GoodCalibration(bool gains) {
  Calibration good;
  good.device = "serial \"left\"";
  good.layout = testing::FlatLayout("s", 2, 2, TaxelUnit::kCounts, 10, 20);
  good.frames = 100;
  good.sample_rate_hz = 30;
  good.baseline = {1, 2.5, 0, 1e-3};
  good.deviation = {1, 0, 2, 1};
  good.contact_threshold = {3, 3, 3, 3};
  good.onset_threshold = {4, 4, 4, 5.5};
  good.faults = {.dead = {1}, .stuck = {}, .noisy = {2}};
  if (gains) {
    good.gains.resize(4);
    good.gains[2] = *GainCurve::Make({{1, 0.5}, {3, 7}});
  }
  return good;
}

// A calibration of three axes, with a matrix per taxel that counts, or one for
// all.
Calibration GoodThreeAxes(bool one_matrix) {
  Calibration good = GoodCalibration(false);
  good.layout.axes = 3;
  good.layout.normal_axis = 2;
  good.layout.signed_values = true;
  good.baseline = {1, -2.5, 0, 1e-3, 5, -6, 7, 8, 9, -1e9, 11, 12};
  good.deviation.assign(12, 0.25);
  const CrossAxis matrix = {
      {{{0.01, -1e-3, 0}, {2e-3, 0.02, -0.0}, {-3, 1e-4, 5e-3}}}};
  good.cross_axis.assign(one_matrix ? 1 : 4, matrix);
  if (!one_matrix) good.cross_axis[1].reset();
  return good;
}

// True if it is one of the two.
bool Read(const std::string& text) {
  const auto calibration = CalibrationFromJson(text);
  fuzz::RequireReason(calibration.status());
  if (calibration.ok()) {
    REQUIRE(Validate(*calibration).ok());
    const auto again = CalibrationFromJson(CalibrationToJson(*calibration));
    REQUIRE(again.ok() && *again == *calibration);
  }
  const auto in_use = CalibrationInUseFromJson(text);
  fuzz::RequireReason(in_use.status());
  if (in_use.ok()) {
    const auto again = CalibrationInUseFromJson(ToJson(*in_use));
    REQUIRE(again.ok() && *again == *in_use);
  }
  return calibration.ok() || in_use.ok();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  if (size == 0) {
    // The good texts are good.
    int number = 0;
    for (const Calibration& good :
         {GoodCalibration(false), GoodCalibration(true), GoodThreeAxes(false),
          GoodThreeAxes(true)}) {
      const CalibrationInUse in_use = {
          .device = good.device,
          .calibration = good,
          .tare = good.baseline,
          .drift_time_s = good.gains.empty() ? 0 : 0.5};
      for (const std::string& text :
           {CalibrationToJson(good), ToJson(in_use)}) {
        REQUIRE(Read(text));
        if (const char* folder = std::getenv("TACTUS_SEEDS")) {
          std::ofstream(std::string(folder) + "/good" +
                        std::to_string(number++) + ".json")
              << text;
        }
      }
    }
    return 0;
  }
  Read(std::string(reinterpret_cast<const char*>(bytes), size));
  return 0;
}
