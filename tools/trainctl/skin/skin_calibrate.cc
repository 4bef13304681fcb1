// trainctl skin calibrate: measures an untouched skin.
#include <algorithm>
#include <chrono>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/drivers/calibration/calibration_json.h"
#include "client/drivers/calibration/press_sweep.h"
#include "client/drivers/calibration/tare.h"
#include "client/drivers/calibration/taxel_noise.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/files/draft_file.h"
#include "core/skin/layout_json.h"
#include "tools/common/measured_rate.h"
#include "tools/common/skin_source.h"
#include "tools/trainctl/command.h"
#include "tools/trainctl/skin/find_port.h"
#include "tools/trainctl/skin/gain_file.h"
#include "tools/trainctl/skin/load_file.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {
namespace {

using Clock = std::chrono::steady_clock;

// A skin that sends nothing for so long does not come back.
constexpr double kCalibrationSilenceS = 10;

struct CalibrateFlags {
  SkinSourceOptions source;
  size_t frames = 300;
  std::string before;
  std::string gains;
  std::string loads;
  double sweep_s = 0;
  double margin = 0;
  std::string out;
  std::string layout_out;
  bool json = false;
};

double SecondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

absl::Status ReadIdle(SkinDriver& driver, IdleFrames& idle,
                      MeasuredRate& rate) {
  const auto begin = Clock::now();
  double quiet_since_s = 0;
  SkinFrame frame;
  while (!idle.complete()) {
    TACTUS_ASSIGN_OR_RETURN(const ReadResult result, driver.Read(frame));
    if (result == ReadResult::kFrame) {
      idle.Add(frame);
      rate.Add(frame);
      quiet_since_s = SecondsSince(begin);
    }
    if (result == ReadResult::kEndOfData ||
        SecondsSince(begin) - quiet_since_s > kCalibrationSilenceS) {
      return IoError("skin", absl::StrCat("sent only ", idle.frames(),
                                          " of the frames to measure"));
    }
  }
  return absl::OkStatus();
}

// Frames of the next seconds, in which every place of the skin is pressed.
absl::Status Sweep(SkinDriver& driver, double seconds, PressSweep& sweep) {
  const auto begin = Clock::now();
  SkinFrame frame;
  while (SecondsSince(begin) < seconds) {
    TACTUS_ASSIGN_OR_RETURN(const ReadResult result, driver.Read(frame));
    if (result == ReadResult::kEndOfData) break;
    if (result == ReadResult::kFrame) sweep.Add(frame);
  }
  if (sweep.changed()) return absl::OkStatus();
  return InvalidTrainingData(
      "no taxel changed, not even while the skin was to be pressed; check "
      "that it has power and that its cable is in");
}

void AddDead(const std::vector<int>& unfelt, TaxelFaults& faults) {
  const std::vector<int> known = faults.All();
  for (const int taxel : unfelt) {
    if (!std::ranges::binary_search(known, taxel)) faults.dead.push_back(taxel);
  }
  std::ranges::sort(faults.dead);
}

std::string ListOr(const std::vector<int>& taxels) {
  return taxels.empty() ? "none" : absl::StrJoin(taxels, ", ");
}

struct Measured {
  Calibration calibration;
  double rate_hz = 0;
  double scale = 1;
  // With --loads.
  std::optional<LoadFile> known;
  std::vector<int> outstanding;
};

void Print(const CalibrateFlags& flags, const Measured& measured) {
  const Calibration& made = measured.calibration;
  const LayoutThresholds thresholds = ThresholdsFor(made, measured.scale);
  if (flags.json) {
    std::cout << JsonText(Json{
                     {"device", made.device},
                     {"frames", made.frames},
                     {"rate_hz", measured.rate_hz},
                     {"baseline_median", MedianOf(made.baseline)},
                     {"deviation_median", MedianOf(made.deviation)},
                     {"contact_threshold", thresholds.contact_threshold},
                     {"onset_threshold", thresholds.onset_threshold},
                     {"dead", made.faults.dead},
                     {"stuck", made.faults.stuck},
                     {"noisy", made.faults.noisy},
                     {"outstanding", measured.outstanding},
                     {"loads_residual", measured.known
                                            ? Json(measured.known->residual)
                                            : Json()}})
              << "\n";
    return;
  }
  std::cout << absl::StrFormat(
      "%s: %d frames\n"
      "baselines: median %.4g; deviations: median %.4g, largest %.4g\n"
      "dead taxels: %s; stuck: %s; noisy: %s\n"
      "\"contact_threshold\": %.4g, \"onset_threshold\": %.4g   of the layout: "
      "those of its taxels without faults\n",
      flags.out, made.frames, MedianOf(made.baseline), MedianOf(made.deviation),
      *std::ranges::max_element(made.deviation), ListOr(made.faults.dead),
      ListOr(made.faults.stuck), ListOr(made.faults.noisy),
      thresholds.contact_threshold, thresholds.onset_threshold);
  if (measured.known) {
    const AxisVector& residual = measured.known->residual;
    std::cout << absl::StrFormat(
        "loads of %d lines are fitted with an error (RMS) of %.3g, %.3g and "
        "%.3g %s along x, y and z\n",
        measured.known->lines, residual[0], residual[1], residual[2],
        made.layout.unit == TaxelUnit::kNewton ? "newtons" : "counts");
  }
  if (!measured.outstanding.empty()) {
    std::cout << "far above the others at rest, so look whether something lies "
                 "there: "
              << ListOr(measured.outstanding) << "\n";
  }
}

absl::StatusOr<Measured> Measure(const CalibrateFlags& flags,
                                 SkinDriver& driver) {
  std::optional<Calibration> before;
  if (!flags.before.empty()) {
    TACTUS_ASSIGN_OR_RETURN(before, ReadCalibration(flags.before));
  }
  Measured measured;
  TACTUS_ASSIGN_OR_RETURN(const SkinInfo info, driver.Configure());
  TACTUS_RETURN_IF_ERROR(CheckLoadFlags(flags.gains, flags.loads, info.layout));
  std::vector<std::optional<GainCurve>> gains;
  if (!flags.gains.empty()) {
    TACTUS_ASSIGN_OR_RETURN(gains,
                            ReadGains(flags.gains, info.layout.taxels()));
  }
  if (!flags.loads.empty()) {
    TACTUS_ASSIGN_OR_RETURN(measured.known,
                            ReadLoads(flags.loads, info.layout.taxels()));
  }
  TACTUS_RETURN_IF_ERROR(driver.Activate());
  const std::string device = DeviceId(flags.source);
  std::cerr << absl::StrFormat(
      "%s: %s, %d x %d taxels at %g Hz; measuring %d frames, nothing must "
      "touch the skin\n",
      device, info.layout.name, info.layout.rows, info.layout.columns,
      info.sample_rate_hz, flags.frames);
  if (const std::string remarks = driver.Statistics().remarks;
      !remarks.empty()) {
    std::cerr << remarks << "\n";
  }
  IdleFrames idle(info, flags.frames);
  MeasuredRate rate;
  TACTUS_RETURN_IF_ERROR(ReadIdle(driver, idle, rate));
  TACTUS_RETURN_IF_ERROR(rate.Check(info.sample_rate_hz));
  measured.rate_hz = rate.hz();
  measured.scale = info.scale;
  std::cerr << absl::StrFormat("measured rate: %.2f Hz\n", rate.hz());
  TACTUS_ASSIGN_OR_RETURN(
      measured.calibration,
      Calibrate(idle, {.device = device,
                       .before = before ? &*before : nullptr,
                       .pressed_later = flags.sweep_s > 0,
                       .least_margin = flags.margin,
                       .cross_axis = measured.known ? measured.known->cross_axis
                                                    : CrossAxes()}));
  Calibration& made = measured.calibration;
  made.created_ms = std::chrono::duration_cast<std::chrono::milliseconds>(
                        std::chrono::system_clock::now().time_since_epoch())
                        .count();
  const std::vector<int> faulty = made.faults.All();
  for (const int taxel : OutstandingTaxels(idle, made.baseline)) {
    // A stuck taxel is no load.
    if (!std::ranges::binary_search(faulty, taxel)) {
      measured.outstanding.push_back(taxel);
    }
  }
  made.gains = std::move(gains);
  if (flags.sweep_s > 0) {
    std::cerr << absl::StrFormat(
        "now press every place of the skin, for %g s\n", flags.sweep_s);
    PressSweep sweep(idle, made);
    TACTUS_RETURN_IF_ERROR(Sweep(driver, flags.sweep_s, sweep));
    AddDead(sweep.Unfelt(), made.faults);
  }
  TACTUS_RETURN_IF_ERROR(driver.Finalise());
  return measured;
}

absl::Status RunCalibrate(CalibrateFlags flags) {
  TACTUS_RETURN_IF_ERROR(CheckSkinFlags(flags.source));
  TACTUS_RETURN_IF_ERROR(FindPortAloud(flags.source));
  TACTUS_ASSIGN_OR_RETURN(const auto source, SkinSource::Make(flags.source));
  TACTUS_ASSIGN_OR_RETURN(const Measured measured,
                          Measure(flags, source->driver()));
  const Calibration& made = measured.calibration;
  TACTUS_RETURN_IF_ERROR(Validate(made));
  TACTUS_RETURN_IF_ERROR(WriteFileBytes(flags.out, CalibrationToJson(made)));
  if (!flags.layout_out.empty()) {
    SkinLayout layout = made.layout;
    const LayoutThresholds found = ThresholdsFor(made, measured.scale);
    layout.contact_threshold = found.contact_threshold;
    layout.onset_threshold = found.onset_threshold;
    TACTUS_RETURN_IF_ERROR(
        WriteFileBytes(flags.layout_out, LayoutToJson(layout) + "\n"));
  }
  Print(flags, measured);
  return absl::OkStatus();
}

}  // namespace

void AddSkinCalibrate(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<CalibrateFlags>();
  CLI::App& group =
      CommandGroup(app, "skin", "Learn about a skin", "estimate mine.h5");
  CLI::App* command =
      &AddVerb(group, "calibrate",
               "Measure a skin that nothing touches: offsets, "
               "noise, thresholds, faults",
               "calibrate --driver=serial --port=/dev/ttyUSB0 --out=cal.json");
  AddSkinFlags(*command, flags->source);
  AddDeviceFlag(*command, flags->source);
  command->add_option("--seed", flags->source.seed,
                      "Seed of the simulated contacts");
  command->add_option("--frames", flags->frames, "Frames to measure")
      ->check(CLI::Range(kMinTareFrames, size_t{10'000}))
      ->capture_default_str();
  command
      ->add_option("--before", flags->before,
                   "An earlier calibration of the skin, with which a touch "
                   "is known more surely")
      ->check(CLI::ExistingFile);
  command
      ->add_option("--gains", flags->gains,
                   "CSV file with columns taxel, reading and load "
                   "(docs/drivers.md), for a skin of one axis")
      ->check(CLI::ExistingFile);
  command
      ->add_option("--loads", flags->loads,
                   "CSV file with columns taxel, reading_x, reading_y, "
                   "reading_z, load_x, load_y and load_z (docs/drivers.md), "
                   "for a skin of three axes")
      ->check(CLI::ExistingFile);
  command
      ->add_option("--sweep", flags->sweep_s,
                   "Then press every place of the skin for so many "
                   "seconds; taxels that feel nothing are dead")
      ->check(CLI::Range(1.0, 600.0));
  command
      ->add_option("--margin", flags->margin,
                   "Counts that thresholds lie above the noise at least; "
                   "default: half of the noise's range, at least 1")
      ->check(CLI::Range(0.0, 65'535.0));
  command->add_option("--out", flags->out, "Calibration to write")->required();
  command->add_option("--layout-out", flags->layout_out,
                      "Layout to write, with the thresholds found");
  command->add_flag("--json", flags->json, "Print one JSON object on stdout");
  command->callback([=] { select([=] { return RunCalibrate(*flags); }); });
}

}  // namespace tactus::internal::client
