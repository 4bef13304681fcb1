#include "tools/fakeskin/icub_boards.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tactus::internal::client {
namespace {

using icub::kBoardValues;
using icub::kDots;
using icub::kTriangles;

// A frame of 8 bytes at 1 Mbit/s.
constexpr int64_t kFrameNs = 130'000;
constexpr int64_t kAnswerNs = 500'000;

}  // namespace

IcubBoards::IcubBoards(std::vector<icub::SkinBoard> boards, Source source)
    : source_(std::move(source)) {
  for (const icub::SkinBoard& board : boards) {
    boards_.emplace_back().what = board;
  }
}

void IcubBoards::LoseConfigurationIfDead(Board& board) {
  if (!board.fault.dead) return;
  board.sending = false;
  board.active = 0;
  board.config = {};
  board.queue.clear();
}

std::array<double, kBoardValues> IcubBoards::Counts(size_t index,
                                                    int64_t time_ns) const {
  std::array<double, kBoardValues> counts = {};
  source_(time_ns, index, counts);
  return counts;
}

void IcubBoards::OnFrame(const CanFrame& frame, int64_t now_ns) {
  for (size_t j = 0; j < boards_.size(); ++j) {
    Board& board = boards_[j];
    LoseConfigurationIfDead(board);
    if (board.fault.dead) continue;
    const int address = board.what.address;
    if (icub::IsDiscover(frame)) {
      CanFrame answer = icub::MakeReply(
          {.address = address,
           .application = !board.fault.in_bootloader,
           .type = static_cast<uint8_t>(icub::BoardType::kMtb4),
           .major = 1,
           .minor = 12,
           .build = static_cast<uint8_t>(board.fault.in_bootloader ? 0 : 3)});
      answer.time_ns = now_ns + kAnswerNs;
      board.queue.push_front(answer);
    }
    if (board.fault.in_bootloader) continue;
    if (const auto config = icub::ReadBoardConfig(frame, address)) {
      board.config = *config;
      board.active = 0;
    } else if (const auto triangles =
                   icub::ReadTriangleConfig(frame, address)) {
      for (int t = triangles->first; t <= triangles->last; ++t) {
        const auto bit =
            static_cast<uint16_t>((1U << t) & board.what.triangles);
        board.active = static_cast<uint16_t>(
            triangles->enabled ? board.active | bit : board.active & ~bit);
      }
      board.sending = false;
      board.untouched = Counts(j, now_ns);
    } else if (const auto start = icub::ReadTransmit(frame, address)) {
      if (*start && !board.sending) board.next_scan_ns = now_ns;
      board.sending = *start;
    }
  }
}

int64_t IcubBoards::NextNs() {
  int64_t next_ns = kNever;
  for (Board& board : boards_) {
    LoseConfigurationIfDead(board);
    if (!board.queue.empty()) {
      next_ns = std::min(next_ns, board.queue.front().time_ns);
    } else if (board.sending && board.active != 0) {
      next_ns = std::min(next_ns, board.next_scan_ns);
    }
  }
  return next_ns;
}

void IcubBoards::BeginScan(size_t index) {
  Board& board = boards_[index];
  const auto counts = Counts(index, board.next_scan_ns);
  int64_t time_ns = board.next_scan_ns;
  for (int t = 0; t < kTriangles; ++t) {
    if ((board.active >> t & 1) == 0) continue;
    icub::TriangleReading reading;
    for (int k = 0; k < kDots; ++k) {
      const int i = kDots * t + k;
      const auto stuck = board.fault.stuck.find(i);
      reading.dots[k] = stuck != board.fault.stuck.end()
                            ? stuck->second
                            : static_cast<uint8_t>(std::clamp(
                                  std::round(board.config.no_load - counts[i] +
                                             board.untouched[i]),
                                  0.0, 255.0));
    }
    reading.status.no_answer = (board.fault.no_answer >> t & 1) != 0;
    reading.status.not_connected = (board.fault.not_connected >> t & 1) != 0;
    const auto [head, tail] =
        icub::EncodeTriangle(board.what.address, t, reading);
    for (CanFrame frame : {head, tail}) {
      time_ns += kFrameNs;
      frame.time_ns = time_ns;
      board.queue.push_back(frame);
    }
  }
  board.next_scan_ns += int64_t{board.config.period_ms} * 1'000'000;
  ++scans_;
}

bool IcubBoards::Emit(int64_t now_ns, CanFrame& frame) {
  Board* first = nullptr;
  for (size_t j = 0; j < boards_.size(); ++j) {
    Board& board = boards_[j];
    LoseConfigurationIfDead(board);
    if (board.queue.empty() && board.sending && board.active != 0 &&
        board.next_scan_ns <= now_ns) {
      BeginScan(j);
    }
    if (board.queue.empty() || board.queue.front().time_ns > now_ns) continue;
    if (first == nullptr ||
        board.queue.front().time_ns < first->queue.front().time_ns) {
      first = &board;
    }
  }
  if (first == nullptr) return false;
  frame = first->queue.front();
  first->queue.pop_front();
  return true;
}

}  // namespace tactus::internal::client
