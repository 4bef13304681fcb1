// File: serial_frames.h
//
// SerialFrames: finds frames in the bytes that a skin sends on a serial line.
// Two formats, of skins that an Arduino reads:
//
//   ascii  (3D-ViTac) a line of whole numbers 0 to 65535 for each row of the
//          skin, separated by blanks or commas, then an empty line
//   aa55   (FlexiTac) AA 55, then a byte for each taxel, no checksum
//
//   SerialFrames frames(SerialFormat::kAscii, /*rows=*/12, /*columns=*/32);
//   frames.Add(bytes, now_ns);
//   while (frames.Next(taxels, time_ns)) Use(taxels, time_ns);
//
// A frame counts only if it is whole. In ascii a line that has another number
// of numbers, or anything else in it, spoils its frame; the next empty line
// begins another.
//
// In aa55 the frames begin where AA 55 comes in three periods running. A second
// place at which it comes as regularly is reported (Ambiguity()) and no frame
// counts, because two taxels that read AA 55 look like a header; unless the
// layout masks these taxels. A place with AA 55 in two of the three periods
// keeps the search going, because a byte that was lost can hide the header.
// Then a frame counts once the AA 55 of the next one follows, because a lost
// byte would shift all taxels after it; so it is read one period late, with the
// time at which it began. Memory is bounded. Not thread-safe.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tactus::internal::client {

enum class SerialFormat { kAscii, kAa55 };

struct SerialCounters {
  uint64_t frames = 0;
  // Frames that were begun and not whole.
  uint64_t spoiled = 0;
  // Bytes outside of frames.
  uint64_t skipped_bytes = 0;
  // Whole frames that nobody took in time.
  uint64_t overwritten = 0;
  // Frames of the right shape with a number that the format does not take; they
  // are in `spoiled` too.
  uint64_t out_of_range = 0;
};

class SerialFrames {
 public:
  // `mask`: as in SkinLayout; taxels of 0 may read AA 55 for ever.
  SerialFrames(SerialFormat format, int rows, int columns,
               std::vector<uint8_t> mask = {});

  // Takes bytes that were received at `now_ns`.
  void Add(std::span<const uint8_t> bytes, int64_t now_ns);
  // True if a frame was there, row-major; `time_ns` is when its first byte was
  // received.
  bool Next(std::vector<uint16_t>& taxels, int64_t& time_ns);
  // Forgets what has come, after a break.
  void Reset();

  const SerialCounters& counters() const { return counters_; }
  // Rows and columns of the last block of numbers between two empty lines, of
  // any shape; zeros if there was none. Only in ascii.
  struct Shape {
    size_t rows = 0;
    size_t columns = 0;
    // When the block began, and how many there were so far.
    int64_t time_ns = 0;
    uint64_t blocks = 0;
  };
  const Shape& seen_shape() const { return seen_shape_; }
  // For people; empty if there is nothing to say since Reset().
  // Which numbers came that the format does not take.
  std::string OutOfRange() const;
  // At which places AA 55 comes in every period, if at more than one.
  std::string Ambiguity() const;

 private:
  struct Frame {
    std::vector<uint16_t> taxels;
    int64_t time_ns = 0;
  };

  void AddAscii(uint8_t byte, int64_t now_ns);
  void EndLine();
  void EndAsciiFrame();
  void AddBinary(uint8_t byte, int64_t now_ns);
  // Bytes from one header of aa55 to the next.
  size_t period() const;
  bool IsHeader(size_t at) const;
  // Both return false if more bytes are needed.
  bool FindHeader();
  bool TakeBinary();
  // Among places with AA 55, the one whose rivals are masked taxels; nothing if
  // there is none, or several.
  std::optional<size_t> Explained(const std::vector<size_t>& places) const;
  void Drop(size_t bytes);
  void Deliver(Frame frame);

  const SerialFormat format_;
  const size_t rows_;
  const size_t columns_;
  const std::vector<uint8_t> mask_;
  SerialCounters counters_;
  std::deque<Frame> whole_;

  // ascii: the line, the values of the frame so far, and whether they are good.
  std::string line_;
  Frame current_;
  size_t lines_ = 0;
  // False until the first empty line, and after a mistake.
  bool good_ = false;
  // The frame so far has the right shape and only numbers, and one of them is
  // out of range.
  bool right_shape_ = false;
  bool unfit_ = false;
  // What was out of range, and whether a frame was refused for it.
  bool refused_ = false;
  double least_ = 0;
  double most_ = 0;
  std::string unfit_word_;
  bool long_line_ = false;
  // The block began after an empty line; numbers of each of its lines, 0 if
  // they differ.
  bool whole_block_ = false;
  size_t block_columns_ = 0;
  Shape seen_shape_;

  // aa55: bytes from a header on, or in which one is looked for, each with its
  // time.
  bool found_ = false;
  std::vector<uint8_t> bytes_;
  std::vector<int64_t> times_;
  // Places in a period with AA 55 in each of them, if several.
  std::vector<size_t> places_;
};

}  // namespace tactus::internal::client
