#include "client/drivers/xela/xela_skin.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "client/drivers/icub_skin/board_messages.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

constexpr uint32_t kFirstId = 0x710;
// A byte of status and three numbers.
constexpr size_t kFrameBytes = 7;
constexpr size_t kFirstNumber = 1;
constexpr uint16_t kAll = 0xFFFF;

}  // namespace

SkinLayout XelaLayout() {
  return {.name = "xela-4x4",
          .rows = 4,
          .columns = 4,
          .row_pitch_m = 0.0047,
          .column_pitch_m = 0.0047,
          .taxel_area_m2 = 0.0047 * 0.0047,
          .unit = TaxelUnit::kCounts,
          .contact_threshold = 100,
          .onset_threshold = 200,
          .axes = 3,
          .normal_axis = 2,
          .signed_values = true};
}

std::vector<CanFilter> XelaSkin::Filters() const {
  return {{.id = kFirstId, .mask = 0x7F0}};
}

absl::StatusOr<SkinInfo> XelaSkin::Setup(CanBus& bus, Clock& clock) {
  TACTUS_RETURN_IF_ERROR(Validate(options_.layout));
  if (options_.layout.rows * options_.layout.columns != kTaxels) {
    return InvalidConfig("taxels of the layout", options_.layout.taxels(),
                         "16");
  }
  const SkinLayout& layout = options_.layout;
  const bool three =
      layout.axes == kAxes && layout.normal_axis == kZ && layout.signed_values;
  if (!three && (layout.axes != 1 || layout.signed_values)) {
    return InvalidConfig(
        "axes of the layout",
        absl::StrCat(layout.axes, layout.signed_values ? ", signed" : ""),
        "3 with signed_values and normal_axis 2, or 1 without a sign");
  }
  if (options_.board < icub::kFirstBoard || options_.board > icub::kLastBoard ||
      options_.baseline_scans < 1) {
    return InvalidConfig(
        "board and baseline_scans",
        absl::StrCat(options_.board, " and ", options_.baseline_scans),
        "1 to 14, and at least 1");
  }
  TACTUS_RETURN_IF_ERROR(Start(bus));
  std::array<double, kAxes* kTaxels> sum = {};
  int scans = 0;
  // Half of the scans may be lost.
  const int64_t end_ns =
      clock.NowNs() + 2 * (options_.baseline_scans + 1) * kPeriodNs;
  for (int64_t now_ns = clock.NowNs();
       now_ns < end_ns && scans < options_.baseline_scans;
       now_ns = clock.NowNs()) {
    CanFrame can;
    TACTUS_ASSIGN_OR_RETURN(const bool received,
                            bus.Receive(can, end_ns - now_ns));
    if (!received || !Collect(can)) continue;
    ++scans;
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += scan_[i];
  }
  TACTUS_RETURN_IF_ERROR(Stop(bus));
  if (scans < options_.baseline_scans) {
    return IoError(bus.name(), absl::StrCat("XELA patch: ", Missing()));
  }
  for (size_t i = 0; i < sum.size(); ++i) baseline_[i] = sum[i] / scans;
  SkinInfo info;
  info.layout = options_.layout;
  if (three) info.taxel_type = v1::TAXEL_TYPE_INT16;
  info.scale = options_.scale;
  info.sample_rate_hz = 1e9 / kPeriodNs;
  return info;
}

absl::Status XelaSkin::Start(CanBus& bus) {
  heard_ = heard_recently_ = 0;
  last_ = {};
  return bus.Send(icub::MakeTransmit(options_.board, true));
}

absl::Status XelaSkin::Stop(CanBus& bus) {
  return bus.Send(icub::MakeTransmit(options_.board, false));
}

bool XelaSkin::Collect(const CanFrame& can) {
  if (can.extended || can.remote || can.id < kFirstId ||
      can.id >= kFirstId + kTaxels || can.size < kFrameBytes) {
    return false;
  }
  if (can.SameAs(last_) && can.time_ns - last_.time_ns < kPeriodNs / 2) {
    return false;
  }
  last_ = can;
  const auto taxel = can.id - kFirstId;
  const auto bit = static_cast<uint16_t>(1U << taxel);
  const bool late =
      heard_ != 0 && can.time_ns - start_ns_ > kPeriodNs - kPeriodNs / 10;
  if ((heard_ & bit) != 0 || late) {
    ++incomplete_;
    heard_ = 0;
  }
  if (heard_ == 0) start_ns_ = can.time_ns;
  heard_ |= bit;
  heard_recently_ |= bit;
  for (size_t axis = 0; axis < kAxes; ++axis) {
    const size_t at = kFirstNumber + 2 * axis;
    scan_[kAxes * taxel + axis] =
        static_cast<uint16_t>(can.data[at] << 8 | can.data[at + 1]);
  }
  if (heard_ != kAll) return false;
  heard_ = heard_recently_ = 0;
  return true;
}

bool XelaSkin::Take(const CanFrame& can, SkinFrame& frame) {
  if (!Collect(can)) return false;
  frame.capture_time_ns = start_ns_;
  frame.f32.clear();
  if (options_.layout.axes == kAxes) {
    frame.u16.clear();
    frame.i16.resize(scan_.size());
    for (size_t i = 0; i < scan_.size(); ++i) {
      frame.i16[i] = static_cast<int16_t>(std::clamp(
          std::round(Above(static_cast<int>(i))), -32768.0, 32767.0));
    }
    return true;
  }
  frame.i16.clear();
  frame.u16.resize(kTaxels);
  for (int i = 0; i < kTaxels; ++i) {
    frame.u16[i] = static_cast<uint16_t>(
        std::clamp(std::round(Above(kAxes * i + kZ)), 0.0, 65535.0));
  }
  return true;
}

std::string XelaSkin::Missing() const {
  if (heard_recently_ == 0) return "it sends nothing";
  std::string missing;
  for (int i = 0; i < kTaxels; ++i) {
    if ((heard_recently_ >> i & 1) == 0) absl::StrAppend(&missing, " ", i);
  }
  if (missing.empty()) return "scans are incomplete";
  return "nothing comes from taxels" + missing;
}

}  // namespace tactus::internal::client
