#include "tools/fakeskin/xela_patch.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "client/drivers/icub_skin/board_messages.h"

namespace tactus::internal::client {
namespace {

constexpr int kBoard = 1;
constexpr uint32_t kFirstId = 0x710;
constexpr int64_t kBetweenTaxelsNs = 200'000;
// What an untouched taxel reads about.
constexpr int kUntouched = 36'000;
constexpr int kSide = 4;

}  // namespace

void XelaPatch::OnFrame(const CanFrame& frame, int64_t now_ns) {
  const auto start = icub::ReadTransmit(frame, kBoard);
  if (!start) return;
  if (*start && !sending_) next_ns_ = now_ns + 1'000'000;
  sending_ = *start;
  taxel_ = 0;
}

bool XelaPatch::Emit(int64_t now_ns, CanFrame& frame) {
  if (now_ns < NextNs()) return false;
  if (taxel_ == 0) {
    counts_.fill(0);
    source_(next_ns_, counts_);
  }
  std::array<uint8_t, 6> bytes;
  for (int axis = 0; axis < 3; ++axis) {
    const double count =
        kUntouched + 10 * taxel_ + 100 * axis + counts_[3 * taxel_ + axis];
    const auto value =
        static_cast<uint16_t>(std::lround(std::clamp(count, 0.0, 65535.0)));
    bytes[2 * axis] = static_cast<uint8_t>(value >> 8);
    bytes[2 * axis + 1] = static_cast<uint8_t>(value & 0xFF);
  }
  frame = MakeCanFrame(
      kFirstId + static_cast<uint32_t>(taxel_),
      {0, bytes[0], bytes[1], bytes[2], bytes[3], bytes[4], bytes[5]});
  frame.time_ns = next_ns_;
  do {
    next_ns_ += kBetweenTaxelsNs;
    if (++taxel_ == kTaxels) {
      taxel_ = 0;
      next_ns_ += kPeriodNs - kTaxels * kBetweenTaxelsNs;
    }
  } while (taxel_ == dead_taxel);
  return true;
}

void PressXela(int64_t time_ns, std::span<double> counts) {
  constexpr double kFirstS = 2;
  constexpr double kEveryS = 4;
  constexpr double kLengthS = 2;
  const double since_s = static_cast<double>(time_ns) / 1e9 - kFirstS;
  if (since_s < 0) return;
  const int press = static_cast<int>(since_s / kEveryS);
  const double at = (since_s - press * kEveryS) / kLengthS;
  if (at >= 1) return;
  // Rises in the first quarter and falls in the last.
  const double load = 1500 * std::min({1.0, 4 * at, 4 * (1 - at)});
  const double angle = 2 * std::numbers::pi * at;
  const int middle = press * 5 % XelaPatch::kTaxels;
  for (int taxel = 0; taxel < XelaPatch::kTaxels; ++taxel) {
    const int distance = std::abs(taxel / kSide - middle / kSide) +
                         std::abs(taxel % kSide - middle % kSide);
    if (distance > 1) continue;
    const double share = distance == 0 ? 1 : 0.4;
    double* xyz = &counts[3 * taxel];
    xyz[0] = 0.3 * share * load * std::cos(angle);
    xyz[1] = 0.3 * share * load * std::sin(angle);
    xyz[2] = share * load;
  }
}

}  // namespace tactus::internal::client
