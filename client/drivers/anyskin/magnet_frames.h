// File: magnet_frames.h
//
// MagnetFrames: finds frames in the bytes that AnySkin and ReSkin send on a
// serial line. A frame has, for each magnetometer, four little-endian floats
// (temperature in degrees Celsius, then x, y and z in microtesla), and "\r\n"
// at its end. There is no header and no checksum.
//
//   MagnetFrames frames(/*magnets=*/5, /*period_ns=*/10'000'000);
//   frames.Add(bytes, now_ns);
//   while (frames.Next(field_ut, time_ns)) Use(field_ut, time_ns);
//
// A frame counts if it lies between two "\r\n" and if its numbers are such as
// the sketch computes: finite, 0 or of at least 1e-6, temperatures of at most
// 1000 degrees and fields of at most 1 T on either side of 0. Floats that are
// read from the wrong byte on are hardly ever all of that size. So a byte that
// is lost or added spoils its frame, at its end also the next one, and the
// frame after that counts. A changed byte is not noticed if the number is still
// of that size.
//
// A host reads several frames at once if it is late. The frames of one Add are
// taken to be a period apart, the last of them at `now_ns` or up to a period
// earlier, whichever follows the frame before most evenly. Frames whose bytes
// came and were spoiled are counted between them. So waiting for the host is
// not taken for a loss. A gap without a trace among the bytes is known from two
// periods on.
//
// Memory is bounded. Add and Next allocate nothing once all vectors have their
// size. Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tactus::internal::client {

struct MagnetCounters {
  uint64_t frames = 0;
  // Frames that were begun and not whole, or that had other numbers.
  uint64_t spoiled = 0;
  // Those of them that were whole and had other numbers.
  uint64_t out_of_range = 0;
  // Bytes outside of frames.
  uint64_t skipped_bytes = 0;
  // Whole frames that nobody took in time.
  uint64_t overwritten = 0;
};

class MagnetFrames {
 public:
  // Both are above 0.
  MagnetFrames(size_t magnets, int64_t period_ns);

  // Takes bytes that were received at `now_ns`, which does not fall.
  void Add(std::span<const uint8_t> bytes, int64_t now_ns);
  // True if a frame was there: x, y and z of each magnetometer. `time_ns` is
  // when its last byte was received; it rises from frame to frame.
  bool Next(std::vector<float>& field_ut, int64_t& time_ns);
  // Forgets what has come, after a break.
  void Reset();

  // Bytes of a frame.
  size_t frame_bytes() const;
  const MagnetCounters& counters() const { return counters_; }
  // For people: which number of a whole frame was refused since Reset(); empty
  // if none was.
  std::string Refused() const;
  // Magnetometers that the distance of one "\r\n" from the next stands for, if
  // it was the same several times; else 0.
  size_t seen_magnets() const;

 private:
  struct Frame {
    std::vector<float> field_ut;
    int64_t time_ns = 0;
    // Frames that its bytes say were lost before it.
    int64_t lost = 0;
  };
  struct BadNumber {
    size_t magnet = 0;
    // 0: the temperature; 1 to 3: x, y and z.
    size_t number = 0;
    float value = 0;
  };

  bool IsEnd(size_t at) const;
  // False if more bytes are needed.
  bool Take();
  // False, with bad_, if some number is none of a chip.
  bool Read(std::vector<float>& field_ut);
  void Deliver();
  void Drop(size_t bytes);
  // Gives times to the frames that the last Add completed.
  void Stamp(int64_t now_ns);
  // Counts the distances of "\r\n", wherever frames begin.
  void WatchEnds(uint8_t byte);

  const size_t magnets_;
  const int64_t period_ns_;
  MagnetCounters counters_;
  // From a "\r\n" on, or in which one is looked for.
  std::vector<uint8_t> bytes_;
  // The frame before was whole, so bytes_ begins with its end.
  bool in_step_ = false;
  // Bytes dropped since the last frame.
  uint64_t dropped_ = 0;
  // Numbers of the frame that is read.
  std::vector<float> reading_;

  // A ring: `waiting_` frames from `first_` on, of which the last `fresh_` are
  // of the present Add.
  std::vector<Frame> ring_;
  size_t first_ = 0;
  size_t waiting_ = 0;
  size_t fresh_ = 0;
  std::optional<int64_t> last_ns_;

  std::optional<BadNumber> bad_;
  // Frames with such numbers since the last good one, and whether one of them
  // was surely a frame.
  uint64_t misfits_ = 0;
  bool refused_ = false;

  uint8_t last_byte_ = 0;
  uint64_t since_end_ = 0;
  uint64_t distance_ = 0;
  uint64_t equal_distances_ = 0;
};

}  // namespace tactus::internal::client
