// The examples of public headers, as their comments show them. They only have
// to compile; HouseTest.ExamplesAreCompiled compares the texts.
#include <string>

#include "client/drivers/buffered_driver.h"
#include "client/drivers/calibrated_driver.h"
#include "client/drivers/calibration/calibration_in_use.h"
#include "client/drivers/calibration/calibration_json.h"
#include "client/drivers/calibration/tare.h"
#include "client/drivers/can/can_error.h"
#include "client/drivers/can/gs_usb.h"
#include "client/drivers/can/gs_usb_protocol.h"
#include "client/drivers/can/socket_can.h"
#include "client/drivers/can_skin_driver.h"
#include "client/drivers/icub_skin/icub_skin.h"
#include "client/drivers/icub_skin/unroll.h"
#include "client/drivers/serial/low_latency.h"
#include "client/drivers/serial/serial_search.h"
#include "client/drivers/serial/serial_skin.h"
#include "client/drivers/xela/xela_skin.h"
#include "core/base/status_macros.h"
#include "core/skin/idle_thresholds.h"

namespace tactus::client::examples {

void Use(const CanFrame& frame);
void Use(const SkinFrame& frame);
void Use(const icub::TrianglePart& part);
void Use(const icub::SkinScan& scan);
void Use(const Eigen::Vector3d& position);
void Mask(int taxel);

void ClockExample() {
  Clock& clock = Clock::System();
  const int64_t deadline_ns = clock.NowNs() + 500'000'000;
  while (clock.NowNs() < deadline_ns) clock.SleepNs(1'000'000);
}

void CanFrameExample() {
  const CanFrame start = MakeCanFrame(0x201, {0x07, 0x00});
  if (CanFilter{.id = 0x400, .mask = 0x700}.Passes(start)) Use(start);
}

absl::Status CanBusExample(CanBus& bus) {
  const CanFilter skins[] = {{.id = 0x400, .mask = 0x700}};
  TACTUS_RETURN_IF_ERROR(bus.Open(skins));
  TACTUS_RETURN_IF_ERROR(bus.Send(MakeCanFrame(0x201, {0x07, 0x00})));
  CanFrame frame;
  TACTUS_ASSIGN_OR_RETURN(const bool received,
                          bus.Receive(frame, /*timeout_ns=*/100'000'000));
  return absl::OkStatus();
}

void Restart();
void Report(int error);

absl::Status SocketCanExample() {
  SocketCan bus("can0");
  TACTUS_RETURN_IF_ERROR(bus.Open({}));
  return absl::OkStatus();
}

void CanSocketsExample(std::span<const CanFilter> filters) {
  CanSockets& sockets = CanSockets::System();
  const int socket = sockets.Open("can0", filters);
  if (socket < 0) Report(-socket);
}

void CanErrorExample(uint32_t id, std::span<const uint8_t> data) {
  const CanError error = ReadCanError(id, data);
  if (error.bus_off) Restart();
}

absl::Status GsUsbExample() {
  GsUsb bus({.bit_rate = 1'000'000});
  TACTUS_RETURN_IF_ERROR(bus.Open({}));
  return absl::OkStatus();
}

absl::Status GsUsbProtocolExample(const gs_usb::BitConstants& constants,
                                  std::span<const uint8_t> bytes) {
  TACTUS_ASSIGN_OR_RETURN(
      const gs_usb::BitTiming timing,
      gs_usb::ChooseBitTiming(constants, /*bit_rate=*/1'000'000));
  const auto frame = gs_usb::ReadHostFrame(bytes, /*with_stamp=*/true);
  return absl::OkStatus();
}

absl::Status BufferedDriverExample(SkinDriver& can_skin_driver) {
  BufferedDriver driver(&can_skin_driver, {.frames = 64});
  TACTUS_ASSIGN_OR_RETURN(const SkinInfo info, driver.Configure());
  return absl::OkStatus();
}

void BoardMessagesExample() {
  const CanFrame discover = icub::Discover();
  const CanFrame rate =
      icub::MakeMessage(1, icub::BoardConfig{.period_ms = 50, .no_load = 245});
}

void TriangleFramesExample(const icub::TriangleReading& reading) {
  const auto [head, tail] = icub::EncodeTriangle(1, 0, reading);
  if (const auto part = icub::DecodePart(head)) Use(*part);
}

void ScanAssemblerExample(const CanFrame& frame) {
  icub::ScanAssembler assembler({{.address = 13}, {.address = 12}},
                                /*period_ns=*/20'000'000);
  icub::SkinScan scan;
  if (assembler.Take(frame, scan)) Use(scan);
}

absl::Status PositionFileExample(const std::string& text) {
  TACTUS_ASSIGN_OR_RETURN(const icub::TaxelPositions positions,
                          icub::ParsePositions(text));
  if (positions.values[17].present) Use(positions.values[17].position);
  return absl::OkStatus();
}

absl::Status SkinPatchExample(const icub::TaxelPositions& positions) {
  TACTUS_ASSIGN_OR_RETURN(const auto boards,
                          icub::ParseBoards("13,12:0-1+3+6+8-9+12-13"));
  TACTUS_ASSIGN_OR_RETURN(const icub::SkinPatch patch,
                          icub::PlacedPatch(boards, positions));
  return absl::OkStatus();
}

void UnrollExample(const std::vector<Eigen::Vector3d>& points,
                   const std::vector<Eigen::Vector3d>& normals) {
  const std::vector<Eigen::Vector3d> flat = icub::Unroll(points, normals);
}

void IcubSkinExample(CanBus& bus, const icub::SkinPatch& patch) {
  icub::IcubSkin skin(patch, {.period_ms = 20});
  CanSkinDriver driver(&bus, &skin, {});
}

absl::Status CanSkinProtocolExample(CanSkinProtocol& protocol, CanBus& bus,
                                    Clock& clock, const CanFrame& can_frame,
                                    SkinFrame& skin_frame) {
  TACTUS_RETURN_IF_ERROR(bus.Open(protocol.Filters()));
  TACTUS_ASSIGN_OR_RETURN(const SkinInfo info, protocol.Setup(bus, clock));
  TACTUS_RETURN_IF_ERROR(protocol.Start(bus));
  if (protocol.Take(can_frame, skin_frame)) Use(skin_frame);
  return absl::OkStatus();
}

void CanSkinDriverExample(CanBus& bus, const icub::SkinPatch& patch) {
  icub::IcubSkin skin(patch, {});
  CanSkinDriver driver(&bus, &skin, {});
}

void XelaSkinExample(CanBus& bus) {
  XelaSkin skin({.board = 1});
  CanSkinDriver driver(&bus, &skin, {});
}

absl::Status HardwareDriverExample(SkinDevice& device) {
  HardwareDriver driver(&device, {});
  TACTUS_ASSIGN_OR_RETURN(const SkinInfo info, driver.Configure());
  return absl::OkStatus();
}

absl::Status SkinDeviceExample(SkinDevice& device, Clock& clock,
                               SkinFrame& frame) {
  TACTUS_RETURN_IF_ERROR(device.Open());
  TACTUS_ASSIGN_OR_RETURN(const SkinInfo info, device.Setup(clock));
  TACTUS_RETURN_IF_ERROR(device.Start());
  TACTUS_ASSIGN_OR_RETURN(const bool whole,
                          device.Poll(frame, /*timeout_ns=*/100'000'000));
  return absl::OkStatus();
}

void Use(const std::vector<uint16_t>& taxels, int64_t time_ns);

void SerialFramesExample(std::span<const uint8_t> bytes, int64_t now_ns,
                         std::vector<uint16_t>& taxels, int64_t& time_ns) {
  SerialFrames frames(SerialFormat::kAscii, /*rows=*/12, /*columns=*/32);
  frames.Add(bytes, now_ns);
  while (frames.Next(taxels, time_ns)) Use(taxels, time_ns);
}

void LowLatencyExample(int file) {
  LowLatency latency(file);
  latency.ToText("/dev/ttyUSB0");  // "low latency is on; the adapter's ..."
}

absl::Status SerialPortExample() {
  SerialPort port("/dev/ttyUSB0", /*baud=*/2'000'000);
  TACTUS_RETURN_IF_ERROR(port.Open());
  uint8_t bytes[4096];
  TACTUS_ASSIGN_OR_RETURN(const size_t count,
                          port.Read(bytes, /*timeout_ns=*/100'000'000));
  return absl::OkStatus();
}

void SerialShapeExample(std::span<const uint8_t> bytes, int64_t now_ns,
                        void (*Use)(size_t rows, double rate_hz)) {
  SerialShapeFinder finder(SerialFormat::kAscii);
  finder.Add(bytes, now_ns);
  if (finder.shape()) Use(finder.shape()->rows, finder.shape()->rate_hz);
}

absl::Status SerialSearchExample(const SerialSkinOptions& options) {
  TACTUS_ASSIGN_OR_RETURN(const SerialFound found,
                          FindSerialSkin(SerialFormat::kAscii, {}));
  SerialSkin skin(found.path, options);
  return absl::OkStatus();
}

absl::Status SerialSkinExample() {
  TACTUS_ASSIGN_OR_RETURN(SkinLayout layout, LayoutPreset("vitac-12x32"));
  SerialSkin skin(
      "/dev/ttyUSB0",
      {.format = SerialFormat::kAscii, .layout = layout, .sample_rate_hz = 30});
  HardwareDriver driver(&skin, {});
  return absl::OkStatus();
}

void FrameMeterExample(SkinFrame& frame, Clock& clock,
                       DriverStatistics& statistics) {
  FrameMeter meter(/*period_ns=*/20'000'000);
  frame.missing_before = meter.Add(frame.capture_time_ns, clock.NowNs());
  meter.Write(statistics);
}

void StuckTaxelsExample(const SkinFrame& frame) {
  StuckTaxels stuck(/*frames=*/500);
  stuck.Add(frame.u16);
  for (int taxel : stuck.Taxels()) Mask(taxel);
}

void IdleThresholdsExample(const std::vector<float>& values) {
  const double median = IdleQuantile(values, 0.5);
  const double high = IdleQuantile(values, kIdleFraction);
  const IdleThresholds found = ThresholdsAbove(median, high, 1);
}

absl::Status IdleFramesExample(const SkinInfo& info, SkinDriver& driver,
                               SkinFrame& frame) {
  IdleFrames idle(info, /*frames=*/100);
  while (!idle.complete()) {
    TACTUS_ASSIGN_OR_RETURN(const ReadResult result, driver.Read(frame));
    if (result == ReadResult::kFrame) idle.Add(frame);
  }
  const std::vector<float> taxel = idle.Series(17);
  return absl::OkStatus();
}

absl::Status TareExample(const IdleFrames& idle) {
  TACTUS_ASSIGN_OR_RETURN(const std::vector<double> baseline,
                          Tare(idle, /*before=*/nullptr));
  return absl::OkStatus();
}

void Touch(int taxel);

void TaxelNoiseExample(const IdleFrames& idle,
                       const std::vector<double>& baseline, double value) {
  const std::vector<TaxelNoise> noise = NoiseOf(idle, baseline);
  if (value - baseline[17] >= noise[17].contact_threshold) Touch(17);
}

void TaxelFaultsExample(const IdleFrames& idle,
                        const std::vector<double>& baseline,
                        const std::vector<TaxelNoise>& noise) {
  const TaxelFaults faults = FindFaults(idle, baseline, noise);
  for (const int taxel : faults.All()) Mask(taxel);
}

absl::Status GainCurveExample() {
  TACTUS_ASSIGN_OR_RETURN(const GainCurve curve,
                          GainCurve::Make({{.reading = 40, .load = 0.5},
                                           {.reading = 120, .load = 2}}));
  const double newton = curve.Load(80);
  return absl::OkStatus();
}

void DriftTrackerExample(size_t taxels, std::span<const double> above_baseline,
                         std::span<const double> contact_thresholds,
                         std::span<const uint8_t> mask) {
  DriftTracker drift(taxels, {.time_s = 60, .sample_rate_hz = 100});
  drift.Step(above_baseline, contact_thresholds, mask);
  const double value = above_baseline[17] - drift.drift()[17];
}

absl::Status CalibrationExample(const IdleFrames& idle, const SkinInfo& info,
                                const std::string& device) {
  TACTUS_ASSIGN_OR_RETURN(
      const Calibration calibration,
      Calibrate(idle, {.device = "serial usb-Arduino_7523-if00"}));
  TACTUS_RETURN_IF_ERROR(CheckFits(calibration, device, info.layout));
  return absl::OkStatus();
}

absl::Status CalibrationJsonExample(const Calibration& calibration) {
  const std::string text = CalibrationToJson(calibration);
  TACTUS_ASSIGN_OR_RETURN(const Calibration again, CalibrationFromJson(text));
  return absl::OkStatus();
}

absl::Status CalibrationInUseExample(const CalibratedDriver& driver) {
  const std::string json = ToJson(driver.in_use());
  TACTUS_ASSIGN_OR_RETURN(const CalibrationInUse again,
                          CalibrationInUseFromJson(json));
  return absl::OkStatus();
}

absl::Status CalibratedDriverExample(SkinDriver& buffered_driver,
                                     const Calibration& calibration) {
  CalibratedDriver driver(&buffered_driver, {.device = "serial left-palm",
                                             .calibration = calibration,
                                             .tare_frames = 100});
  TACTUS_ASSIGN_OR_RETURN(const SkinInfo info, driver.Configure());
  return absl::OkStatus();
}

}  // namespace tactus::client::examples
