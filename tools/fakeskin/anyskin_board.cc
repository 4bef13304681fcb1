#include "tools/fakeskin/anyskin_board.h"

#include <bit>
#include <cmath>
#include <utility>

namespace tactus::internal::client {
namespace {

// The chips are turned on the board. The public viewer turns what they send by
// these angles, with y downwards: -90, -90, 180, 90 and 0 degrees.
struct ChipTurn {
  int cosine;
  int sine;
};
constexpr ChipTurn kTurns[AnySkinBoard::kMagnets] = {
    {0, -1}, {0, -1}, {-1, 0}, {0, 1}, {1, 0}};
// Steps of the MLX90393 at its default gain, along x, y and z, and of its
// temperature.
constexpr double kStepUt[] = {0.15, 0.15, 0.242};
constexpr double kStepDegrees = 1 / 45.2;
constexpr double kColdDegrees = 25;
constexpr double kWarmingDegrees = 6;
// Fields at rest are up to so far from these.
constexpr double kRestUt[] = {0, 0, -1'000};
constexpr double kRestRangeUt = 300;
// The byte that is lost is one of a number, not of the end of the frame: the
// next frame is whole then.
constexpr uint64_t kNumberBytes = AnySkinBoard::kMagnets * 4 * sizeof(float);

float Rounded(double value, double step) {
  return static_cast<float>(std::round(value / step) * step);
}

void AppendFloat(float number, std::string& bytes) {
  const auto bits = std::bit_cast<uint32_t>(number);
  for (int shift = 0; shift < 32; shift += 8) {
    bytes.push_back(static_cast<char>(bits >> shift & 0xFF));
  }
}

}  // namespace

AnySkinBoard::AnySkinBoard(const AnySkinBoardOptions& options, Source source)
    : options_(options), source_(std::move(source)), random_(options.seed) {
  for (size_t magnet = 0; magnet < kMagnets; ++magnet) {
    std::array<double, 3> direction;
    double length = 0;
    for (size_t axis = 0; axis < 3; ++axis) {
      rest_ut_[3 * magnet + axis] =
          kRestUt[axis] + random_.Uniform(-kRestRangeUt, kRestRangeUt);
      direction[axis] = random_.Gaussian();
      length = std::hypot(length, direction[axis]);
    }
    const double drift_ut = options_.drift_ut * random_.Uniform(0.5, 1);
    for (size_t axis = 0; axis < 3; ++axis) {
      drift_ut_[3 * magnet + axis] = drift_ut * direction[axis] / length;
    }
  }
}

int64_t AnySkinBoard::NextNs() const {
  return options_.begin_ns +
         std::llround(static_cast<double>(due_) * 1e9 / options_.rate_hz);
}

void AnySkinBoard::Measure(int64_t time_ns) {
  field_ut_.fill(0);
  source_(time_ns, field_ut_);
  const double warm =
      1 - std::exp(-static_cast<double>(time_ns - options_.begin_ns) / 1e9 /
                   options_.drift_time_s);
  for (size_t i = 0; i < kValues; ++i) {
    field_ut_[i] += rest_ut_[i] + warm * drift_ut_[i] +
                    options_.noise_ut * random_.Gaussian();
  }
  for (size_t magnet = 0; magnet < kMagnets; ++magnet) {
    if (static_cast<int>(magnet) == fault.still_magnet) continue;
    const double* field = &field_ut_[3 * magnet];
    const ChipTurn& turn = kTurns[magnet];
    const double right = field[0];
    const double down = -field[1];
    readings_[magnet] = {
        Rounded(kColdDegrees + kWarmingDegrees * warm, kStepDegrees),
        Rounded(turn.cosine * right + turn.sine * down, kStepUt[0]),
        Rounded(-turn.sine * right + turn.cosine * down, kStepUt[1]),
        Rounded(field[2], kStepUt[2])};
  }
}

bool AnySkinBoard::Emit(int64_t now_ns, std::string& bytes) {
  // A board without power misses its frames.
  while (fault.dead && now_ns >= NextNs()) ++due_;
  const int64_t time_ns = NextNs();
  if (now_ns < time_ns) return false;
  Measure(time_ns);
  bytes.clear();
  for (const Reading& reading : readings_) {
    for (const float number : reading) AppendFloat(number, bytes);
  }
  bytes += "\r\n";
  ++due_;
  ++frames_;
  if (fault.lose_byte_every > 0 && frames_ % fault.lose_byte_every == 0) {
    bytes.erase(random_.Index(kNumberBytes), 1);
    ++damaged_;
  }
  return true;
}

}  // namespace tactus::internal::client
