// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
#include <memory>
#include <string>

#include "client/drivers/anyskin/anyskin.h"
#include "client/drivers/buffered_driver.h"
#include "client/drivers/calibrated_driver.h"
#include "client/drivers/calibration/calibration_in_use.h"
#include "client/drivers/calibration/calibration_json.h"
#include "client/drivers/calibration/cross_axis.h"
#include "client/drivers/calibration/drift_tracker.h"
#include "client/drivers/calibration/press_sweep.h"
#include "client/drivers/calibration/tare.h"
#include "client/drivers/calibration/taxel_noise.h"
#include "client/drivers/calibration/touch_thresholds.h"
#include "client/drivers/can/can_error.h"
#include "client/drivers/can/gs_usb.h"
#include "client/drivers/can/gs_usb_protocol.h"
#include "client/drivers/can/socket_can.h"
#include "client/drivers/can_skin_driver.h"
#include "client/drivers/icub_skin/icub_skin.h"
#include "client/drivers/icub_skin/unroll.h"
#include "client/drivers/one_axis.h"
#include "client/drivers/serial/low_latency.h"
#include "client/drivers/serial/serial_search.h"
#include "client/drivers/serial/serial_skin.h"
#include "client/drivers/xela/xela_skin.h"
#include "core/base/status_macros.h"
#include "core/skin/idle_thresholds.h"

namespace tactus::internal::client::examples {

void Use(const CanFrame& frame);
void Use(const SkinFrame& frame);
void Use(const icub::TrianglePart& part);
void Use(const icub::SkinScan& scan);
void Use(const Eigen::Vector3d& position);
void Mask(int taxel);

static void ClockExample() {
#include "client/drivers/clock.h.inc"
}

static void CanFrameExample() {
#include "client/drivers/can/can_frame.h.inc"
}

static absl::Status CanBusExample(CanBus& bus) {
#include "client/drivers/can/can_bus.h.inc"
  return absl::OkStatus();
}

void Restart();
void Report(int error);

static absl::Status SocketCanExample() {
#include "client/drivers/can/socket_can.h.inc"
  return absl::OkStatus();
}

static void CanSocketsExample(std::span<const CanFilter> filters) {
#include "client/drivers/can/can_sockets.h.inc"
}

static void CanErrorExample(uint32_t id, std::span<const uint8_t> data) {
#include "client/drivers/can/can_error.h.inc"
}

static absl::Status GsUsbExample() {
#include "client/drivers/can/gs_usb.h.inc"
  return absl::OkStatus();
}

static absl::Status GsUsbProtocolExample(const gs_usb::BitConstants& constants,
                                         std::span<const uint8_t> bytes) {
#include "client/drivers/can/gs_usb_protocol.h.inc"
  return absl::OkStatus();
}

static absl::Status BufferedDriverExample(SkinDriver& can_skin_driver) {
#include "client/drivers/buffered_driver.h.inc"
  return absl::OkStatus();
}

static void BoardMessagesExample() {
#include "client/drivers/icub_skin/board_messages.h.inc"
}

static void TriangleFramesExample(const icub::TriangleReading& reading) {
#include "client/drivers/icub_skin/triangle_frames.h.inc"
}

static void ScanAssemblerExample(const CanFrame& frame) {
#include "client/drivers/icub_skin/scan_assembler.h.inc"
}

static absl::Status PositionFileExample(const std::string& text) {
#include "client/drivers/icub_skin/position_file.h.inc"
  return absl::OkStatus();
}

static absl::Status SkinPatchExample(const icub::TaxelPositions& positions) {
#include "client/drivers/icub_skin/skin_patch.h.inc"
  return absl::OkStatus();
}

static void UnrollExample(const std::vector<Eigen::Vector3d>& points,
                          const std::vector<Eigen::Vector3d>& normals) {
#include "client/drivers/icub_skin/unroll.h.inc"
}

static void IcubSkinExample(CanBus& bus, const icub::SkinPatch& patch) {
#include "client/drivers/icub_skin/icub_skin.h.inc"
}

static absl::Status CanSkinProtocolExample(CanSkinProtocol& protocol,
                                           CanBus& bus, Clock& clock,
                                           const CanFrame& can_frame,
                                           SkinFrame& skin_frame) {
#include "client/drivers/can_skin_protocol.h.inc"
  return absl::OkStatus();
}

static void CanSkinDriverExample(CanBus& bus, const icub::SkinPatch& patch) {
#include "client/drivers/can_skin_driver.h.inc"
}

static void XelaSkinExample(CanBus& bus) {
#include "client/drivers/xela/xela_skin.h.inc"
}

static absl::Status HardwareDriverExample(SkinDevice& device) {
#include "client/drivers/hardware_driver.h.inc"
  return absl::OkStatus();
}

static absl::Status SkinDeviceExample(SkinDevice& device, Clock& clock,
                                      SkinFrame& frame) {
#include "client/drivers/skin_device.h.inc"
  return absl::OkStatus();
}

void Use(const std::vector<float>& field_ut, int64_t time_ns);

static void MagnetFramesExample(std::span<const uint8_t> bytes, int64_t now_ns,
                                std::vector<float>& field_ut,
                                int64_t& time_ns) {
#include "client/drivers/anyskin/magnet_frames.h.inc"
}

static void AnySkinExample() {
#include "client/drivers/anyskin/anyskin.h.inc"
}

void Use(const std::vector<uint16_t>& taxels, int64_t time_ns);

static void SerialFramesExample(std::span<const uint8_t> bytes, int64_t now_ns,
                                std::vector<uint16_t>& taxels,
                                int64_t& time_ns) {
#include "client/drivers/serial/serial_frames.h.inc"
}

static void LowLatencyExample(int file) {
#include "client/drivers/serial/low_latency.h.inc"
}

static absl::Status SerialPortExample() {
#include "client/drivers/serial/serial_port.h.inc"
  return absl::OkStatus();
}

static void SerialShapeExample(std::span<const uint8_t> bytes, int64_t now_ns,
                               void (*Use)(size_t rows, double rate_hz)) {
#include "client/drivers/serial/serial_shape.h.inc"
}

static absl::Status SerialSearchExample(const SerialSkinOptions& options) {
#include "client/drivers/serial/serial_search.h.inc"
  return absl::OkStatus();
}

static absl::Status SerialSkinExample() {
#include "client/drivers/serial/serial_skin.h.inc"
  return absl::OkStatus();
}

static void FrameMeterExample(SkinFrame& frame, Clock& clock,
                              DriverStatistics& statistics) {
#include "client/drivers/driver_statistics.h.inc"
}

static absl::Status OneAxisExample(const SkinLayout& layout) {
#include "client/drivers/one_axis.h.inc"
  return absl::OkStatus();
}

static void StuckTaxelsExample(NormalLoads& loads,
                               std::span<const float> values) {
#include "client/drivers/stuck_taxels.h.inc"
}

static void IdleThresholdsExample(const std::vector<float>& values) {
#include "core/skin/idle_thresholds.h.inc"
}

static absl::Status IdleFramesExample(const SkinInfo& info, SkinDriver& driver,
                                      SkinFrame& frame) {
#include "client/drivers/calibration/idle_frames.h.inc"
  return absl::OkStatus();
}

static absl::Status TareExample(const IdleFrames& idle) {
#include "client/drivers/calibration/tare.h.inc"
  return absl::OkStatus();
}

void Touch(int taxel);

static void TaxelNoiseExample(const IdleFrames& idle,
                              const std::vector<double>& baseline,
                              const SkinLayout& layout,
                              const CrossAxes& cross_axis, double load) {
#include "client/drivers/calibration/taxel_noise.h.inc"
}

static void TaxelFaultsExample(const IdleFrames& idle,
                               const std::vector<double>& baseline,
                               const std::vector<ValueNoise>& noise) {
#include "client/drivers/calibration/taxel_faults.h.inc"
}

static absl::Status GainCurveExample() {
#include "client/drivers/calibration/gain_curve.h.inc"
  return absl::OkStatus();
}

static void DriftTrackerExample(size_t values,
                                std::span<const double> above_baseline,
                                const Calibration& calibration,
                                std::span<const uint8_t> mask) {
#include "client/drivers/calibration/drift_tracker.h.inc"
}

static absl::Status CrossAxisExample(std::span<const KnownLoad> known) {
#include "client/drivers/calibration/cross_axis.h.inc"
  return absl::OkStatus();
}

static void AxisLoadsExample(const SkinLayout& layout,
                             const Calibration& calibration,
                             std::span<const double> readings,
                             double contact_threshold) {
#include "client/drivers/calibration/axis_loads.h.inc"
}

void Freeze();

static void TouchThresholdsExample(const Calibration& calibration,
                                   std::span<const double> readings) {
#include "client/drivers/calibration/touch_thresholds.h.inc"
}

bool Pressing();

static void PressSweepExample(const IdleFrames& idle,
                              const Calibration& calibration,
                              const SkinFrame& frame) {
#include "client/drivers/calibration/press_sweep.h.inc"
}

static absl::Status CalibrationExample(const IdleFrames& idle,
                                       const SkinInfo& info,
                                       const std::string& device) {
#include "client/drivers/calibration/calibration.h.inc"
  return absl::OkStatus();
}

static absl::Status CalibrationJsonExample(const Calibration& calibration) {
#include "client/drivers/calibration/calibration_json.h.inc"
  return absl::OkStatus();
}

static absl::Status CalibrationInUseExample(const CalibratedDriver& driver) {
#include "client/drivers/calibration/calibration_in_use.h.inc"
  return absl::OkStatus();
}

static absl::Status CalibratedDriverExample(SkinDriver& buffered_driver,
                                            const Calibration& calibration) {
#include "client/drivers/calibrated_driver.h.inc"
  return absl::OkStatus();
}

}  // namespace tactus::internal::client::examples
