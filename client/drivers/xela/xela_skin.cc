#include "client/drivers/xela/xela_skin.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "client/drivers/icub_skin/board_messages.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::client {
namespace {

constexpr uint32_t kFirstId = 0x710;
// A byte of status and three numbers.
constexpr size_t kFrameBytes = 7;
constexpr size_t kZ = 5;
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
          .onset_threshold = 200};
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
  if (options_.board < icub::kFirstBoard || options_.board > icub::kLastBoard ||
      options_.baseline_scans < 1) {
    return InvalidConfig(
        "board and baseline_scans",
        absl::StrCat(options_.board, " and ", options_.baseline_scans),
        "1 to 14, and at least 1");
  }
  TACTUS_RETURN_IF_ERROR(Start(bus));
  std::array<double, kTaxels> sum = {};
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
    for (int i = 0; i < kTaxels; ++i) sum[i] += z_[i];
  }
  TACTUS_RETURN_IF_ERROR(Stop(bus));
  if (scans < options_.baseline_scans) {
    return IoError(bus.name(), absl::StrCat("XELA patch: ", Missing()));
  }
  for (int i = 0; i < kTaxels; ++i) baseline_[i] = sum[i] / scans;
  SkinInfo info;
  info.layout = options_.layout;
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
  z_[taxel] = static_cast<uint16_t>(can.data[kZ] << 8 | can.data[kZ + 1]);
  if (heard_ != kAll) return false;
  heard_ = heard_recently_ = 0;
  return true;
}

bool XelaSkin::Take(const CanFrame& can, SkinFrame& frame) {
  if (!Collect(can)) return false;
  frame.capture_time_ns = start_ns_;
  frame.f32.clear();
  frame.u16.resize(kTaxels);
  for (int i = 0; i < kTaxels; ++i) {
    frame.u16[i] = static_cast<uint16_t>(
        std::clamp(std::round(z_[i] - baseline_[i]), 0.0, 65535.0));
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

}  // namespace tactus::client
