// File: monitor.h
//
// Monitor: collects what a terminal shows (monitor_view.h) from a skin's frames
// and a server's answers.
//
//   Monitor monitor(info);
//   monitor.Started(stream->started());
//   monitor.Frame(frame, encoder.last_sequence(), now_ns);
//   monitor.Answer(answer, now_ns);
//   const MonitorState state = monitor.Snapshot(driver.Statistics());
//
// Thread-safe: answers come from a stream's thread.
#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <vector>

#include "client/drivers/driver_statistics.h"
#include "client/stream/skin_frame.h"
#include "core/skin/normal_loads.h"
#include "tactus/v1/contact.pb.h"
#include "tools/common/monitor_view.h"

namespace tactus::internal::client {

class Monitor {
 public:
  explicit Monitor(const SkinInfo& info);

  // The model and its classes.
  void Started(const v1::StreamStarted& started);
  // A frame that is sent with this sequence number at `now_ns`; 0: it is not
  // sent.
  void Frame(const SkinFrame& frame, uint64_t sequence, int64_t now_ns);
  void Answer(const v1::Answer& answer, int64_t now_ns);

  // The present state. The full scale follows the largest load at once, and
  // sinks slowly; it is at least twice the onset threshold.
  MonitorState Snapshot(const DriverStatistics& statistics);

 private:
  // Frames and answers that percentiles are of.
  static constexpr size_t kWindow = 512;

  struct Window {
    void Add(double value);
    // -1 if there are none.
    double Quantile(double p) const;

    std::array<double, kWindow> values = {};
    size_t count = 0;
  };

  const SkinInfo info_;
  std::mutex mutex_;
  NormalLoads loads_;
  // All axes of the last frame.
  std::vector<float> values_;
  v1::StreamStarted started_;
  MonitorState state_;
  double peak_ = 0;
  Window ages_ms_;
  Window answers_ms_;
  // By sequence number, modulo the size.
  struct Sent {
    uint64_t sequence = 0;
    int64_t time_ns = 0;
  };
  std::array<Sent, kWindow> sent_ = {};
};

}  // namespace tactus::internal::client
