// File: driver_cost.h
//
// What a driver costs, and how old its frames are when the program gets them.
// The skin numbers its scans in its first dot, so that the age is known from
// the scan itself and not only from the stamps of an adapter. Test-only.
//
//   NumberedScans scans;
//   IcubBoards boards(list, scans.Source());
//   ... // plays the boards on a bus; `driver` reads them
//   const auto cost = MeasureDriver(driver, scans, 1'000);
//   ASSERT_TRUE(cost.ok()) << cost.status();
//   std::printf("%s\n", cost->Text().c_str());
//
// NumberedScans is thread-safe. MeasureDriver belongs to one thread.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/str_format.h"
#include "client/drivers/buffered_driver.h"
#include "client/drivers/clock.h"
#include "core/base/status_macros.h"
#include "tests/client/drivers/thread_cpu.h"
#include "tools/common/percentile.h"
#include "tools/fakeskin/icub_boards.h"

namespace tactus::internal::client {

class NumberedScans {
 public:
  // For IcubBoards; outlived by this object.
  IcubBoards::Source Source() {
    return [this](int64_t time_ns, size_t board, std::span<double> counts) {
      if (board != 0 || !begun_) return;
      const size_t number = next_++ % kNumbers;
      times_[number] = time_ns;
      counts[0] = static_cast<double>(number + 1);
    };
  }

  // Until then the first dot is untouched, as it has to be when the boards are
  // configured.
  void Begin() { begun_ = true; }

  // When the skin began the scan in which the first dot had this value; 0 if
  // it had no number.
  int64_t BeginNs(uint16_t value) const {
    return value < 1 || value > kNumbers ? 0 : times_[value - 1].load();
  }

 private:
  // 2 s at 100 Hz.
  static constexpr int kNumbers = 200;

  std::atomic<bool> begun_ = false;
  // Used by the boards only.
  size_t next_ = 0;
  std::array<std::atomic<int64_t>, kNumbers> times_ = {};
};

struct DriverCost {
  int frames = 0;
  uint64_t missing = 0;
  uint64_t incomplete = 0;
  uint64_t overwritten = 0;
  // Frames measured; the first ones, which meet cold caches, are left out.
  int measured_frames = 0;
  double wall_s = 0;
  double cpu_s = 0;
  // The part in the kernel. Most kernels estimate it at their timer's ticks.
  double system_s = 0;
  // When the program gets a frame: since the skin began the scan, and since the
  // frame's capture time.
  std::vector<double> scan_ages_ms;
  std::vector<double> stamp_ages_ms;

  std::string Text() const {
    return absl::StrFormat(
        "%d frames, missing %d; driver %.2f %% of a core in %.1f s, %.0f us "
        "per frame; age since the scan began p50 %.2f, p99 %.2f, largest %.2f "
        "ms; since the frame's stamp p50 %.2f, p99 %.2f, largest %.2f ms",
        frames, missing, 100 * cpu_s / wall_s, wall_s,
        1e6 * cpu_s / measured_frames, Percentile(scan_ages_ms, 0.5),
        Percentile(scan_ages_ms, 0.99), Percentile(scan_ages_ms, 1),
        Percentile(stamp_ages_ms, 0.5), Percentile(stamp_ages_ms, 0.99),
        Percentile(stamp_ages_ms, 1));
  }
};

// Configures `driver`, reads `frames` frames of it in a separate thread, and
// finalises it. `scans` is what the skin behind it plays, with the value in the
// frame's first taxel.
inline absl::StatusOr<DriverCost> MeasureDriver(SkinDriver& driver,
                                                NumberedScans& scans,
                                                int frames) {
  constexpr int kColdFrames = 50;
  Clock& clock = Clock::System();
  ThreadCpu measured(&driver);
  BufferedDriver buffered(&measured, {});
  // The skin may not be there yet.
  auto info = buffered.Configure();
  for (int i = 0; i < 20 && !info.ok(); ++i) {
    clock.SleepNs(100'000'000);
    info = buffered.Configure();
  }
  TACTUS_RETURN_IF_ERROR(info.status());
  TACTUS_RETURN_IF_ERROR(buffered.Activate());
  scans.Begin();
  DriverCost cost;
  int64_t begin_ns = 0;
  double cpu_s = 0;
  double system_s = 0;
  SkinFrame frame;
  while (cost.frames < frames) {
    TACTUS_ASSIGN_OR_RETURN(const ReadResult result, buffered.Read(frame));
    if (result != ReadResult::kFrame) continue;
    const int64_t now_ns = clock.NowNs();
    if (++cost.frames == kColdFrames) {
      begin_ns = now_ns;
      cpu_s = measured.seconds();
      system_s = measured.system_seconds();
    }
    cost.missing += frame.missing_before;
    const auto age_ms = [&](int64_t then_ns) {
      return static_cast<double>(now_ns - then_ns) / 1e6;
    };
    cost.stamp_ages_ms.push_back(age_ms(frame.capture_time_ns));
    const int64_t scan_ns = scans.BeginNs(frame.u16[0]);
    if (scan_ns != 0) cost.scan_ages_ms.push_back(age_ms(scan_ns));
  }
  cost.measured_frames = frames - kColdFrames;
  cost.wall_s = static_cast<double>(clock.NowNs() - begin_ns) / 1e9;
  cost.cpu_s = measured.seconds() - cpu_s;
  cost.system_s = measured.system_seconds() - system_s;
  const DriverStatistics statistics = buffered.Statistics();
  cost.incomplete = statistics.incomplete;
  cost.overwritten = statistics.overwritten;
  TACTUS_RETURN_IF_ERROR(buffered.Finalise());
  return cost;
}

}  // namespace tactus::internal::client
