#include "core/ridge/touch_history.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/ridge/ridge_samples.h"
#include "tests/support/allocation_counter.h"

namespace tactus::internal {
namespace {

using testing::Frames;
using testing::RandomFrames;
using testing::RandomSpec;

// The numbers of a contact, in double and from all of its frames at once.
class PlainHistory {
 public:
  PlainHistory(const HistorySpec& spec, const Frames& frames) : spec_(spec) {
    for (const auto& frame : frames) series_.push_back(Channels(frame));
  }

  std::vector<double> Numbers() const {
    std::vector<double> numbers;
    const size_t channels = series_.front().size();
    const auto frames = static_cast<double>(series_.size());
    std::vector<std::vector<double>> statistics(kHistoryStatistics);
    for (size_t c = 0; c < channels; ++c) {
      double sum = 0;
      double steps = 0;
      double active = 0;
      double largest = -std::numeric_limits<double>::infinity();
      double smallest = std::numeric_limits<double>::infinity();
      double means[2] = {};
      for (size_t t = 0; t < series_.size(); ++t) {
        const double x = series_[t][c];
        sum += x;
        active += x != 0;
        largest = std::max(largest, x);
        smallest = std::min(smallest, x);
        if (t > 0) steps += std::abs(x - series_[t - 1][c]);
        const double windows[] = {8, 32};
        for (int m = 0; m < 2; ++m) {
          const double window =
              std::min(static_cast<double>(t + 1), windows[m]);
          means[m] += (x - means[m]) / window;
        }
      }
      const double mean = sum / frames;
      double square = 0;
      for (const auto& row : series_) {
        square += (row[c] - mean) * (row[c] - mean);
      }
      const double all[] = {mean,           std::sqrt(square / frames),
                            largest,        smallest,
                            steps / frames, active / frames,
                            means[0],       means[1]};
      for (int s = 0; s < kHistoryStatistics; ++s) {
        statistics[s].push_back(all[s]);
      }
    }
    for (const auto& of : statistics) {
      numbers.insert(numbers.end(), of.begin(), of.end());
    }
    for (int j = 0; j < kHistoryStretches; ++j) {
      for (size_t c = 0; c < channels; ++c) numbers.push_back(Stretch(j, c));
    }
    AddKernels(numbers);
    return numbers;
  }

 private:
  std::vector<double> Channels(const std::vector<TaxelLoad>& frame) const {
    const size_t cells = spec_.cells();
    std::vector<double> raw(cells + 1);
    for (const TaxelLoad& load : frame) {
      const double value = static_cast<double>(load.root) * load.root;
      const auto row = static_cast<int>(load.taxel) / spec_.columns;
      const auto column = static_cast<int>(load.taxel) % spec_.columns;
      raw[row / spec_.block * spec_.CellColumns() + column / spec_.block] +=
          value;
      raw[cells] += value;
    }
    std::vector<double> channels;
    for (const double x : raw) channels.push_back(x * spec_.scale[0]);
    for (const double x : raw) {
      channels.push_back(std::sqrt(x) * spec_.scale[1]);
    }
    for (size_t i = 0; i < cells; ++i) {
      channels.push_back(std::sqrt(raw[i] / raw[cells]) * spec_.scale[2]);
    }
    channels.push_back(std::log(raw[cells]) * spec_.scale[2]);
    return channels;
  }

  // The mean over a stretch whose borders may lie within the blocks that a
  // contact of this length has.
  double Stretch(int j, size_t channel) const {
    size_t length = 1;
    while (series_.size() / length >= 20) length *= 2;
    const double stretch =
        static_cast<double>(series_.size()) / kHistoryStretches;
    double sum = 0;
    for (size_t begin = 0; begin < series_.size(); begin += length) {
      const size_t end = std::min(begin + length, series_.size());
      double mean = 0;
      for (size_t t = begin; t < end; ++t) mean += series_[t][channel];
      mean /= static_cast<double>(end - begin);
      const double shared =
          std::min((j + 1) * stretch, static_cast<double>(end)) -
          std::max(j * stretch, static_cast<double>(begin));
      if (shared > 0) sum += shared * mean;
    }
    return sum / stretch;
  }

  void AddKernels(std::vector<double>& numbers) const {
    const size_t channels = series_.front().size() / kFrameViews;
    for (int view = 0; view < kFrameViews; ++view) {
      for (int d = 0; d < kMiniDilationCount; ++d) {
        for (int threshold = 0; threshold < kMiniThresholds; ++threshold) {
          for (int k = 0; k < kMiniKernels; ++k) {
            const size_t row =
                (static_cast<size_t>(view) * kMiniDilationCount + d) *
                    kMiniThresholds +
                threshold;
            const float limit = spec_.threshold[row * kMiniKernels + k];
            double above = 0;
            for (size_t t = 0; t < series_.size(); ++t) {
              above += Kernel(view, k, t, kMiniDilations[d], channels) > limit;
            }
            numbers.push_back(above / static_cast<double>(series_.size()));
          }
        }
      }
    }
  }

  double Kernel(int view, int kernel, size_t t, int dilation,
                size_t channels) const {
    double sum = 0;
    for (int tap = 0; tap < kMiniTaps; ++tap) {
      const size_t back = static_cast<size_t>(tap) * dilation;
      if (back > t) break;
      sum += kTaps.weight[tap][kernel] *
             Mixed(view, kernel, series_[t - back], channels);
    }
    return sum;
  }

  double Mixed(int view, int kernel, const std::vector<double>& values,
               size_t channels) const {
    double sum = 0;
    const size_t first =
        (static_cast<size_t>(view) * kMiniKernels + kernel) * kMiniMixed;
    for (int m = 0; m < kMiniMixed && spec_.mixed_weight[first + m] != 0; ++m) {
      sum += spec_.mixed_weight[first + m] *
             values[view * channels + spec_.mixed_channel[first + m]];
    }
    return sum;
  }

  const HistorySpec& spec_;
  std::vector<std::vector<double>> series_;
};

std::vector<float> NumbersOf(const HistorySpec& spec, const Frames& frames) {
  TouchHistory history(&spec);
  for (const auto& frame : frames) history.Step(frame);
  std::vector<float> numbers(spec.numbers());
  history.Write(numbers);
  return numbers;
}

TEST(TouchHistoryTest, AgreesWithAllFramesAtOnce) {
  Random random(1);
  const HistorySpec small = RandomSpec(3, 4, random);
  // Its cells are blocks of two by two taxels, at the borders fewer.
  const HistorySpec large = RandomSpec(31, 33, random);
  EXPECT_EQ(large.block, 2);
  for (const HistorySpec* spec : {&small, &large}) {
    for (const size_t count : {1, 2, 9, 10, 19, 20, 21, 39, 40, 87, 300}) {
      if (spec == &large && count > 40) continue;
      SCOPED_TRACE(::testing::Message()
                   << spec->rows << " rows, " << count << " frames");
      const Frames frames = RandomFrames(*spec, count, random);
      const std::vector<float> got = NumbersOf(*spec, frames);
      const std::vector<double> want = PlainHistory(*spec, frames).Numbers();
      ASSERT_EQ(got.size(), want.size());
      size_t at_thresholds = 0;
      const size_t kernels = size_t{kFrameViews} * kMiniDilationCount *
                             kMiniThresholds * kMiniKernels;
      for (size_t i = 0; i < got.size(); ++i) {
        const double error = std::abs(got[i] - want[i]);
        if (i < got.size() - kernels) {
          ASSERT_LE(error, 2e-5 * std::max(1.0, std::abs(want[i]))) << i;
        } else {
          // A value next to a threshold may fall on either side.
          at_thresholds += error > 1e-6;
          ASSERT_LE(error, 1.01 / static_cast<double>(count)) << i;
        }
      }
      EXPECT_LE(at_thresholds, kernels / 1000);
    }
  }
}

TEST(TouchHistoryTest, KeepsItsPrecisionOverAMillionFrames) {
  Random random(2);
  const HistorySpec spec = RandomSpec(1, 2, random);
  TouchHistory history(&spec);
  constexpr int kFrames = 1'000'000;
  double sum = 0;
  double square = 0;
  double last_tenth = 0;
  for (int t = 0; t < kFrames; ++t) {
    const auto root = static_cast<float>(30 + random.Gaussian());
    const TaxelLoad load = {1, root};
    history.Step({&load, 1});
    const double x = static_cast<double>(root) * root * spec.scale[0];
    sum += x;
    square += x * x;
    if (t >= kFrames / 10 * 9) last_tenth += x;
  }
  std::vector<float> numbers(spec.numbers());
  history.Write(numbers);
  const double mean = sum / kFrames;
  const size_t channels = 3 * kFrameViews;
  EXPECT_NEAR(numbers[1], mean, 1e-4 * mean);
  EXPECT_NEAR(numbers[channels + 1], std::sqrt(square / kFrames - mean * mean),
              1e-3);
  EXPECT_NEAR(numbers[(kHistoryStatistics + 9) * channels + 1],
              last_tenth / (kFrames / 10), 1e-4 * mean);
}

TEST(TouchHistoryTest, ForgetsAndAllocatesNothing) {
  Random random(3);
  const HistorySpec spec = RandomSpec(3, 4, random);
  const Frames first = RandomFrames(spec, 60, random);
  const Frames second = RandomFrames(spec, 45, random);
  TouchHistory history(&spec);
  std::vector<float> numbers(spec.numbers());
  const testing::AllocationCounter counter;
  for (const auto& frame : first) history.Step(frame);
  history.Reset();
  history.Write(numbers);
  const bool forgotten =
      std::ranges::all_of(numbers, [](float x) { return x == 0; });
  for (const auto& frame : second) history.Step(frame);
  history.Write(numbers);
  EXPECT_EQ(counter.count(), 0);
  EXPECT_TRUE(forgotten);
  EXPECT_EQ(numbers, NumbersOf(spec, second));
}

TEST(HistorySpecTest, WrongPartsAreNamed) {
  Random random(4);
  const HistorySpec good = RandomSpec(3, 4, random);
  EXPECT_TRUE(Validate(good).ok());
  const auto refused = [&](const auto& change, const char* what) {
    HistorySpec spec = good;
    change(spec);
    EXPECT_THAT(Validate(spec).message(), ::testing::HasSubstr(what));
  };
  refused([](auto& s) { s.rows = 0; }, "rows and columns");
  refused([](auto& s) { s.columns = 1 << 30; }, "rows and columns");
  refused([](auto& s) { s.block = 2; }, "block");
  refused([](auto& s) { s.scale[1] = std::nanf(""); }, "scale");
  refused([](auto& s) { s.scale[2] = 0; }, "scale");
  refused([](auto& s) { s.mixed_channel.pop_back(); }, "mixed channels");
  refused([](auto& s) { s.mixed_channel[5] = 13; }, "mixed channel");
  refused([](auto& s) { s.mixed_weight[5] = std::nanf(""); }, "mixed weight");
  refused([](auto& s) { s.threshold.pop_back(); }, "thresholds");
  refused([](auto& s) { s.threshold[9] = HUGE_VALF; }, "threshold");
}

}  // namespace
}  // namespace tactus::internal
