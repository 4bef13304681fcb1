// File: anyskin_board.h
//
// AnySkinBoard: the board of an AnySkin skin, simulated: it sends frames of
// five magnetometers at an even rate, as the public sketch does
// (client/drivers/anyskin/magnet_frames.h). Each magnetometer has another field
// at rest, noise, and a drift while the board warms up.
//
//   AnySkinBoard board({.rate_hz = 200}, source);
//   board.fault.lose_byte_every = 100;
//   std::string bytes;
//   while (board.Emit(clock.NowNs(), bytes)) line.Write(bytes);
//
// The seed fixes the numbers of all frames. Not thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "core/base/random.h"

namespace tactus::internal::client {

struct AnySkinBoardOptions {
  double rate_hz = 100;
  // Fields at rest, direction of the drift, and noise.
  uint64_t seed = 1;
  // Standard deviation of each number, in microtesla.
  double noise_ut = 2;
  // A magnetometer's field drifts by half of this to all of it, with the time
  // constant below, as the board's temperature rises. Over a minute it moves by
  // less than the driver's contact threshold, and in all by more.
  double drift_ut = 300;
  double drift_time_s = 600;
  // When the board gets power, on the clock of Emit.
  int64_t begin_ns = 0;
};

// What may be wrong with the board.
struct AnySkinFault {
  // It sends nothing.
  bool dead = false;
  // A magnetometer that does not answer: the sketch repeats its numbers; -1 for
  // none.
  int still_magnet = -1;
  // Every so many frames one byte of a number is lost; 0: never.
  uint64_t lose_byte_every = 0;
};

class AnySkinBoard {
 public:
  static constexpr size_t kMagnets = 5;
  static constexpr size_t kValues = 3 * kMagnets;
  // Where the magnetometers are, in the order of the frames: centre, left,
  // right, up and down; in pitches of 7 mm to the right and up.
  static constexpr std::array<std::array<int, 2>, kMagnets> kPlaces = {
      {{0, 0}, {-1, 0}, {1, 0}, {0, 1}, {0, -1}}};

  // Writes by how many microtesla the field at each magnetometer differs from
  // that of the untouched skin at a time: to the right, up and out of the skin,
  // centre first. All are 0 before.
  using Source =
      std::function<void(int64_t time_ns, std::span<double> field_ut)>;

  AnySkinBoard(const AnySkinBoardOptions& options, Source source);

  AnySkinFault fault;

  // When Emit has something to send next.
  int64_t NextNs() const;
  // True if a frame is due at `now_ns`; `bytes` are what it sends.
  bool Emit(int64_t now_ns, std::string& bytes);

  // Frames that were sent, and how many of them without one of their bytes.
  uint64_t frames() const { return frames_; }
  uint64_t damaged() const { return damaged_; }

 private:
  // Temperature, x, y and z, as a chip sends them.
  using Reading = std::array<float, 4>;

  // The present readings of all chips, in their own axes.
  void Measure(int64_t time_ns);

  const AnySkinBoardOptions options_;
  const Source source_;
  Random random_;
  std::array<double, kValues> rest_ut_ = {};
  // Microtesla at the end of the drift.
  std::array<double, kValues> drift_ut_ = {};
  std::array<double, kValues> field_ut_ = {};
  std::array<Reading, kMagnets> readings_ = {};
  // Frames that were due so far, also those of a dead board.
  int64_t due_ = 0;
  uint64_t frames_ = 0;
  uint64_t damaged_ = 0;
};

}  // namespace tactus::internal::client
