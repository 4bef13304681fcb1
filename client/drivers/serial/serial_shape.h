// File: serial_shape.h
//
// SerialShapeFinder: finds out from the bytes of a serial line whether a skin
// sends frames, how large they are, and how often they come.
//
//   SerialShapeFinder finder(SerialFormat::kAscii);
//   finder.Add(bytes, now_ns);
//   if (finder.shape()) Use(finder.shape()->rows, finder.shape()->rate_hz);
//
// In ascii, rows and columns are those of the blocks of numbers between empty
// lines. In aa55, the distance of the sync words gives the number of taxels,
// and nothing gives rows and columns: ShapesOf lists those that are possible.
// A shape is found once five frames of it have come. Memory is bounded. Not
// thread-safe.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>

#include "client/drivers/serial/serial_frames.h"

namespace tactus::internal::client {

struct SerialShape {
  SerialFormat format = SerialFormat::kAscii;
  size_t taxels = 0;
  // 0 in aa55.
  size_t rows = 0;
  size_t columns = 0;
  // Frames of this shape that came one after another, and their rate.
  uint64_t frames = 0;
  double rate_hz = 0;
};

// For people: "12 x 32 taxels at 30.0 Hz in ascii".
std::string ToText(const SerialShape& shape);

// All shapes of so many taxels that a layout may have: "16 x 32, 32 x 16"; or
// "none".
std::string ShapesOf(size_t taxels);

class SerialShapeFinder {
 public:
  explicit SerialShapeFinder(SerialFormat format);

  // Takes bytes that were received at `now_ns`.
  void Add(std::span<const uint8_t> bytes, int64_t now_ns);
  std::optional<SerialShape> shape() const;

 private:
  // A sync word: number of its first byte, and when that was received.
  struct Sync {
    uint64_t at = 0;
    int64_t time_ns = 0;
  };

  void AddAscii(uint8_t byte, int64_t now_ns);
  void AddBinary(uint8_t byte, int64_t now_ns);
  void TakeSync(const Sync& sync);
  // The sync word at byte `at`; null if there was none.
  const Sync* Find(uint64_t at) const;

  const SerialFormat format_;
  // ascii: the numbers that came are parsed for a skin of one taxel.
  SerialFrames lines_;
  uint64_t blocks_ = 0;

  // aa55: the last sync words.
  std::deque<Sync> syncs_;
  uint64_t bytes_ = 0;
  uint8_t last_byte_ = 0;
  int64_t last_byte_ns_ = 0;
  // From one sync word to the next, and where the next must be; 0: unknown.
  uint64_t distance_ = 0;
  uint64_t next_ = 0;

  SerialShape shape_;
  // When the first and the last of its frames began.
  int64_t first_ns_ = 0;
  int64_t last_ns_ = 0;
};

}  // namespace tactus::internal::client
