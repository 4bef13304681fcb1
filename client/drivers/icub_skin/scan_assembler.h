// File: scan_assembler.h
//
// ScanAssembler: makes whole scans of a skin from the frames of its boards.
//
//   icub::ScanAssembler assembler({{.address = 13}, {.address = 12}},
//                                 /*period_ns=*/20'000'000);
//   icub::SkinScan scan;
//   if (assembler.Take(frame, scan)) Use(scan);
//
// The protocol has neither sequence numbers nor time stamps, and each board
// runs on a separate clock. These rules replace them:
//
// - A board's scan is complete when head and tail of every expected triangle
//   have come, in any order. It counts only if no triangle reports a fault.
// - A frame belongs to the next scan of its board if its place in this scan is
//   taken, or if this scan began more than 0.9 periods ago. What this scan has
//   until then is dropped, never filled up from another scan.
// - A frame that equals the one before it from the same board is a repetition
//   by the bus, if less than half a period lies between them. It is dropped.
// - A skin's scan is complete when each board has completed a new one. If a
//   board completes two while another has completed none, the newer one counts.
//
// Only frames that come by less than 0.9 periods apart can be mixed, and only
// if exactly those of one scan are lost that came of the other. Memory is
// allocated by the constructor only. Not thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "client/drivers/icub_skin/triangle_frames.h"

namespace tactus::internal::client::icub {

struct SkinBoard {
  // kFirstBoard to kLastBoard.
  int address = 0;
  // Bit t: triangle t is there.
  uint16_t triangles = 0xFFFF;

  bool operator==(const SkinBoard&) const = default;
};

struct SkinScan {
  // When the first and the last of its frames were received.
  int64_t start_ns = 0;
  int64_t end_ns = 0;
  // [boards][kTriangles][kDots], as sent; 0 where no triangle is.
  std::vector<uint8_t> raw;
  // [boards][kTriangles], bit k for dot k.
  std::vector<uint16_t> out_of_range;

  bool operator==(const SkinScan&) const = default;
};

struct BoardCounters {
  // Scans of this board.
  uint64_t complete = 0;
  uint64_t incomplete = 0;
  // Complete scans that a newer one replaced, because another board had none.
  uint64_t superseded = 0;
  // Frames.
  uint64_t repeated = 0;
  uint64_t malformed = 0;
  uint64_t unexpected = 0;
  // Incomplete scans that lacked this triangle, or part of it.
  std::array<uint64_t, kTriangles> missing = {};
  // Scans in which this triangle reported no answer or not connected.
  std::array<uint64_t, kTriangles> faulty = {};
  // Bit t: triangle t has sent both parts without a fault since the last Reset,
  // and since the last complete scan of the skin.
  uint16_t heard = 0;
  uint16_t heard_recently = 0;
};

class ScanAssembler {
 public:
  // Boards in the order of their values on the port, at most 14 of different
  // addresses; a board without triangles is not waited for.
  ScanAssembler(std::vector<SkinBoard> boards, int64_t period_ns);

  // True if the frame completed a scan of the skin, which replaces `scan`.
  // Frames of other boards or classes are ignored.
  bool Take(const CanFrame& frame, SkinScan& scan);

  // Forgets all parts, after a break in the frames. Counters stay.
  void Reset();

  const std::vector<SkinBoard>& boards() const { return boards_; }
  // By place in boards().
  const BoardCounters& counters(size_t board) const {
    return states_[board].counters;
  }

 private:
  struct BoardScan {
    // Bit t: that part of triangle t is there.
    uint16_t heads = 0;
    uint16_t tails = 0;
    uint16_t faulty = 0;
    int64_t start_ns = 0;
    int64_t end_ns = 0;
    std::array<uint8_t, kBoardValues> raw = {};
    std::array<uint16_t, kTriangles> out_of_range = {};

    bool IsEmpty() const { return heads == 0 && tails == 0; }
    void Clear() { heads = tails = faulty = 0; }
  };
  struct BoardState {
    BoardScan current;
    BoardScan done;
    bool has_done = false;
    CanFrame last_frame;
    bool has_last_frame = false;
    BoardCounters counters;
  };

  bool IsRepetition(const CanFrame& frame, BoardState& state) const;
  void Place(const TrianglePart& part, int64_t time_ns, BoardScan& scan) const;
  // Counts what the current scan lacks and drops it.
  void DropCurrent(size_t board);
  void CompleteCurrent(size_t board);
  bool Join(SkinScan& scan);

  const std::vector<SkinBoard> boards_;
  const int64_t period_ns_;
  // By address: the board's place, or -1.
  std::array<int, 16> place_;
  std::vector<BoardState> states_;
};

}  // namespace tactus::internal::client::icub
