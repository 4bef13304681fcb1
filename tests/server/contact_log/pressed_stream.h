// File: pressed_stream.h
//
// A recorded stream of the skin "cody-forearm" at 100 Hz: it is pressed and let
// go as the test says.
//
//   PressedStream stream;
//   stream.Quiet(100);
//   stream.Press(30);
//   stream.Quiet(60);
//   stream.kept().at(0).recording.frames_size();
//
// Test-only.
#pragma once

#include <algorithm>
#include <vector>

#include "tests/server/contact_log/recorded_streams.h"
#include "tests/server/support/requests.h"

namespace tactus::internal::server {

inline v1::StreamConfig PressedConfig() {
  v1::StreamConfig config = testing::ConfigRequest().config();
  config.clear_never_release();
  config.set_client_id("arm");
  return config;
}

// Neighbours in a row from (row, column) on, pressed at 2 newton.
inline testing::Counts PressedAt(int row, int column) {
  testing::Counts counts = testing::Untouched();
  for (int i = 0; i < 3; ++i) {
    counts[row * 24 + column + i] = static_cast<uint16_t>(2 / testing::kStep);
  }
  return counts;
}

inline testing::Counts Both(const testing::Counts& a,
                            const testing::Counts& b) {
  testing::Counts sum = a;
  for (size_t i = 0; i < sum.size(); ++i) sum[i] = std::max(a[i], b[i]);
  return sum;
}

class PressedStream {
 public:
  explicit PressedStream(size_t chunks = 100, bool with_recorder = true)
      : rig(PressedConfig(), SmallPinned(), chunks, with_recorder) {}

  // One message.
  void Send(const std::vector<testing::Counts>& frames) {
    rig.Send(testing::DenseU16(next, frames).frames());
    next += frames.size();
  }
  // `frames` messages of one frame each.
  void Same(int frames, const testing::Counts& counts) {
    for (int i = 0; i < frames; ++i) Send({counts});
  }
  void Quiet(int frames) { Same(frames, testing::Untouched()); }
  void Press(int frames) { Same(frames, PressedAt(5, 7)); }
  // Quiet until `count` recordings are finished.
  void QuietUntil(size_t count) {
    for (int i = 0; i < 100 && kept().size() < count; ++i) Quiet(1);
    ASSERT_EQ(kept().size(), count);
  }

  const std::vector<KeptRecordings::Kept>& kept() { return rig.sink().kept; }

  RecordedStreamRig rig;
  // The next frame's sequence number.
  uint64_t next = 1;
};

}  // namespace tactus::internal::server
