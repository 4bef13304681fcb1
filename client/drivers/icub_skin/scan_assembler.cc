#include "client/drivers/icub_skin/scan_assembler.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace tactus::internal::client::icub {

ScanAssembler::ScanAssembler(std::vector<SkinBoard> boards, int64_t period_ns)
    : boards_(std::move(boards)),
      period_ns_(period_ns),
      states_(boards_.size()) {
  place_.fill(-1);
  for (size_t j = 0; j < boards_.size(); ++j) {
    place_[boards_[j].address & 0xF] = static_cast<int>(j);
  }
}

bool ScanAssembler::Take(const CanFrame& frame, SkinScan& scan) {
  if (!IsSkinData(frame)) return false;
  const int place = place_[frame.id >> 4 & 0xF];
  if (place < 0) return false;
  const auto board = static_cast<size_t>(place);
  BoardState& state = states_[board];
  const auto part = DecodePart(frame);
  if (!part) {
    ++state.counters.malformed;
    return false;
  }
  const auto bit = static_cast<uint16_t>(1U << part->triangle);
  if ((boards_[board].triangles & bit) == 0) {
    ++state.counters.unexpected;
    return false;
  }
  if (IsRepetition(frame, state)) {
    ++state.counters.repeated;
    return false;
  }
  BoardScan& current = state.current;
  const uint16_t taken = part->tail ? current.tails : current.heads;
  const bool late = !current.IsEmpty() && frame.time_ns - current.start_ns >
                                              period_ns_ - period_ns_ / 10;
  if ((taken & bit) != 0 || late) DropCurrent(board);
  Place(*part, frame.time_ns, current);
  if (part->status.IsValid() && (current.heads & current.tails & bit) != 0 &&
      (current.faulty & bit) == 0) {
    state.counters.heard |= bit;
    state.counters.heard_recently |= bit;
  }
  if (current.heads != boards_[board].triangles ||
      current.tails != boards_[board].triangles) {
    return false;
  }
  CompleteCurrent(board);
  return Join(scan);
}

bool ScanAssembler::IsRepetition(const CanFrame& frame,
                                 BoardState& state) const {
  const bool repeated =
      state.has_last_frame && frame.SameAs(state.last_frame) &&
      frame.time_ns - state.last_frame.time_ns < period_ns_ / 2;
  state.last_frame = frame;
  state.has_last_frame = true;
  return repeated;
}

void ScanAssembler::Place(const TrianglePart& part, int64_t time_ns,
                          BoardScan& scan) const {
  if (scan.IsEmpty()) scan.start_ns = time_ns;
  scan.end_ns = time_ns;
  const auto bit = static_cast<uint16_t>(1U << part.triangle);
  const int begin = part.tail ? kHeadDots : 0;
  const int end = part.tail ? kDots : kHeadDots;
  std::copy(part.dots.begin() + begin, part.dots.begin() + end,
            scan.raw.begin() + part.triangle * kDots + begin);
  if (!part.tail) {
    scan.heads |= bit;
    return;
  }
  scan.tails |= bit;
  scan.out_of_range[part.triangle] = part.status.out_of_range;
  if (!part.status.IsValid()) scan.faulty |= bit;
}

void ScanAssembler::DropCurrent(size_t board) {
  BoardState& state = states_[board];
  ++state.counters.incomplete;
  for (int t = 0; t < kTriangles; ++t) {
    const auto bit = static_cast<uint16_t>(1U << t);
    if ((state.current.faulty & bit) != 0) ++state.counters.faulty[t];
    if ((boards_[board].triangles & bit) == 0) continue;
    if ((state.current.heads & state.current.tails & bit) == 0) {
      ++state.counters.missing[t];
    }
  }
  state.current.Clear();
}

void ScanAssembler::CompleteCurrent(size_t board) {
  BoardState& state = states_[board];
  // All parts are there, so that only faults are counted.
  if (state.current.faulty != 0) return DropCurrent(board);
  ++state.counters.complete;
  if (state.has_done) ++state.counters.superseded;
  state.has_done = true;
  state.done = state.current;
  state.current.Clear();
}

bool ScanAssembler::Join(SkinScan& scan) {
  for (size_t j = 0; j < boards_.size(); ++j) {
    if (boards_[j].triangles != 0 && !states_[j].has_done) return false;
  }
  scan.start_ns = std::numeric_limits<int64_t>::max();
  scan.end_ns = std::numeric_limits<int64_t>::min();
  scan.raw.assign(boards_.size() * kBoardValues, 0);
  scan.out_of_range.assign(boards_.size() * kTriangles, 0);
  for (size_t j = 0; j < boards_.size(); ++j) {
    if (boards_[j].triangles == 0) continue;
    const BoardScan& done = states_[j].done;
    states_[j].has_done = false;
    states_[j].counters.heard_recently = 0;
    scan.start_ns = std::min(scan.start_ns, done.start_ns);
    scan.end_ns = std::max(scan.end_ns, done.end_ns);
    for (int t = 0; t < kTriangles; ++t) {
      if ((boards_[j].triangles >> t & 1) == 0) continue;
      std::copy_n(done.raw.begin() + t * kDots, kDots,
                  scan.raw.begin() +
                      static_cast<ptrdiff_t>(j * kBoardValues + t * kDots));
      scan.out_of_range[j * kTriangles + t] = done.out_of_range[t];
    }
  }
  return true;
}

void ScanAssembler::Reset() {
  for (BoardState& state : states_) {
    state.current.Clear();
    state.has_done = false;
    state.has_last_frame = false;
    state.counters.heard = 0;
    state.counters.heard_recently = 0;
  }
}

}  // namespace tactus::internal::client::icub
