// File: icub_boards.h
//
// IcubBoards: the skin boards of an iCub, simulated on a CAN bus. They behave
// as the firmware does (docs/drivers.md): a board configuration switches all
// triangles off, a triangle configuration stops the board and takes the present
// readings for untouched, and configurations are not answered.
//
//   IcubBoards boards({{.address = 13}, {.address = 12}},
//                     [](int64_t t_ns, size_t board, std::span<double> counts)
//                     {
//                       counts[17] = t_ns > 2'000'000'000 ? 40 : 0;
//                     });
//   boards.fault(0).dead = true;
//
// Not thread-safe.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <vector>

#include "client/drivers/icub_skin/scan_assembler.h"
#include "tools/fakeskin/can_peer.h"

namespace tactus::internal::client {

// What may be wrong with a board.
struct IcubFault {
  // It neither sends nor answers, as without power. When that ends, it has lost
  // its configuration.
  bool dead = false;
  bool in_bootloader = false;
  // Bits of triangles whose converter does not answer or is not there.
  uint16_t no_answer = 0;
  uint16_t not_connected = 0;
  // Dots, 12 t + k, that always send this byte.
  std::map<int, uint8_t> stuck = {};
};

class IcubBoards : public CanPeer {
 public:
  // Writes by how many counts each of the board's 192 dots is pressed at a
  // time; all are 0 before.
  using Source = std::function<void(int64_t time_ns, size_t board,
                                    std::span<double> counts)>;

  // Only the triangles that are there can be switched on.
  IcubBoards(std::vector<icub::SkinBoard> boards, Source source);

  IcubFault& fault(size_t board) { return boards_[board].fault; }
  // True if the board sends scans.
  bool IsSending(size_t board) const { return boards_[board].sending; }
  // Scans that all boards have begun to send.
  uint64_t scans() const { return scans_; }

  void OnFrame(const CanFrame& frame, int64_t now_ns) override;
  int64_t NextNs() override;
  bool Emit(int64_t now_ns, CanFrame& frame) override;

 private:
  struct Board {
    icub::SkinBoard what;
    IcubFault fault;
    icub::BoardConfig config;
    uint16_t active = 0;
    bool sending = false;
    int64_t next_scan_ns = 0;
    std::array<double, icub::kBoardValues> untouched = {};
    // Frames of the present scan, and answers.
    std::deque<CanFrame> queue;
  };

  void LoseConfigurationIfDead(Board& board);
  std::array<double, icub::kBoardValues> Counts(size_t index,
                                                int64_t time_ns) const;
  void BeginScan(size_t index);

  const Source source_;
  std::vector<Board> boards_;
  uint64_t scans_ = 0;
};

}  // namespace tactus::internal::client
