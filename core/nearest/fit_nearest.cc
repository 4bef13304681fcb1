#include "core/nearest/fit_nearest.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/ridge/history_kernels.h"

namespace tactus::internal {
namespace {

constexpr size_t kPartCount = kHistoryParts.size();
// A number that varies less than this does not count.
constexpr double kConstant = 1e-6;

using Samples = std::span<const HistorySample>;

// The numbers of all parts of all contacts, a row each.
std::vector<float> MakeRows(Samples samples, const FrameViews& views,
                            int view) {
  const size_t count =
      static_cast<size_t>(views.channels()) * kHistoryStretches;
  std::vector<float> rows(samples.size() * kPartCount * count);
  ViewStretches stretches(&views, view);
  float* row = rows.data();
  for (const HistorySample& sample : samples) {
    stretches.Reset();
    size_t t = 0;
    for (const double part : kHistoryParts) {
      for (const size_t end = EndOf(part, sample.frames.size()); t < end; ++t) {
        stretches.Step(sample.frames[t]);
      }
      stretches.Write({row, count});
      row += count;
    }
  }
  return rows;
}

// The gains that standardise the columns of the whole contacts.
std::vector<float> StandardGains(const std::vector<float>& rows,
                                 size_t numbers) {
  std::vector<double> sum(numbers);
  std::vector<double> square(numbers);
  size_t count = 0;
  for (size_t row = (kPartCount - 1) * numbers; row < rows.size();
       row += kPartCount * numbers) {
    ++count;
    for (size_t i = 0; i < numbers; ++i) {
      const double x = rows[row + i];
      sum[i] += x;
      square[i] += x * x;
    }
  }
  std::vector<float> gain(numbers);
  for (size_t i = 0; i < numbers; ++i) {
    const double mean = sum[i] / static_cast<double>(count);
    const double deviation = std::sqrt(
        std::max(square[i] / static_cast<double>(count) - mean * mean, 0.0));
    gain[i] = deviation > kConstant ? static_cast<float>(1 / deviation) : 0.0F;
  }
  return gain;
}

void Scale(const std::vector<float>& gain, std::vector<float>& rows) {
  for (size_t i = 0; i < rows.size(); i += gain.size()) {
    for (size_t j = 0; j < gain.size(); ++j) rows[i + j] *= gain[j];
  }
}

// How well the nearest whole contact of another group answers.
struct Fitness {
  int right = 0;
  // Mean of how much nearer the own class is than the others, -1 to 1.
  double margin = 0;
  // Median squared distance to the nearest contact.
  double distance = 0;

  bool operator<(const Fitness& other) const {
    return std::pair(right, margin) < std::pair(other.right, other.margin);
  }
};

Fitness Measure(Samples samples, const std::vector<float>& rows,
                size_t numbers) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const auto whole = [&](size_t s) {
    return std::span(rows).subspan(((s + 1) * kPartCount - 1) * numbers,
                                   numbers);
  };
  // The nearest of the own and of the other classes.
  std::vector<double> own(samples.size(), kNone);
  std::vector<double> other(samples.size(), kNone);
  for (size_t a = 0; a < samples.size(); ++a) {
    for (size_t b = 0; b < a; ++b) {
      if (samples[a].group == samples[b].group) continue;
      const double distance =
          static_cast<double>(SquaredDistance(whole(a), whole(b)));
      auto& nearest = samples[a].label == samples[b].label ? own : other;
      nearest[a] = std::min(nearest[a], distance);
      nearest[b] = std::min(nearest[b], distance);
    }
  }
  Fitness fitness;
  std::vector<double> nearest;
  for (size_t s = 0; s < samples.size(); ++s) {
    fitness.right += own[s] < other[s];
    const double least = std::min(own[s], other[s]);
    if (least < kNone) nearest.push_back(least);
    if (std::isfinite(own[s] + other[s]) && own[s] + other[s] > 0) {
      fitness.margin += (other[s] - own[s]) / (other[s] + own[s]);
    }
  }
  fitness.margin /= static_cast<double>(samples.size());
  if (nearest.empty()) return fitness;
  const auto middle =
      nearest.begin() + static_cast<ptrdiff_t>(nearest.size() / 2);
  std::ranges::nth_element(nearest, middle);
  fitness.distance = *middle;
  return fitness;
}

// Takes the best view of these into `best` if it is better than `fitness`.
absl::Status ChooseView(Samples samples, const FrameViews& views,
                        const NearestOptions& options, Fitness& fitness,
                        Nearest& best) {
  const size_t numbers =
      static_cast<size_t>(views.channels()) * kHistoryStretches;
  const size_t kept = samples.size() * kPartCount * numbers;
  if (kept > kMostNearestNumbers) {
    return InvalidTrainingData(absl::StrCat(
        samples.size(), " contacts of ", numbers,
        " numbers and three parts are ", kept,
        " numbers, but nearest neighbours keep at most ", kMostNearestNumbers));
  }
  for (int view = 0; view < kFrameViews; ++view) {
    const std::vector<float> as_they_are = MakeRows(samples, views, view);
    for (const bool standardised : {false, true}) {
      TACTUS_RETURN_IF_ERROR(options.go_on());
      std::vector<float> rows = as_they_are;
      std::vector<float> gain(numbers, 1.0F);
      if (standardised) {
        gain = StandardGains(rows, numbers);
        Scale(gain, rows);
      }
      const Fitness found = Measure(samples, rows, numbers);
      if (!(fitness < found)) continue;
      fitness = found;
      best.views = views;
      best.view = view;
      best.gain = std::move(gain);
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Nearest> FitNearest(Samples samples,
                                   const NearestOptions& options) {
  Nearest best;
  best.classes = options.classes;
  Fitness fitness{.right = -1};
  const TaxelShape loads = WithoutComponents(options.shape);
  TACTUS_RETURN_IF_ERROR(
      ChooseView(samples, FitViews(samples, loads), options, fitness, best));
  if (options.shape != loads) {
    TACTUS_RETURN_IF_ERROR(ChooseView(samples, FitViews(samples, options.shape),
                                      options, fitness, best));
  }
  const size_t numbers = best.numbers();
  // Equal contacts have a distance of 0.
  const double scale =
      fitness.distance > kConstant ? 1 / std::sqrt(fitness.distance) : 1;
  const std::vector<float> unit(numbers, static_cast<float>(scale));
  Scale(unit, best.gain);
  // In one step, as a scorer does it.
  best.sample = MakeRows(samples, best.views, best.view);
  Scale(best.gain, best.sample);
  for (const HistorySample& sample : samples) {
    best.label.insert(best.label.end(), kPartCount,
                      static_cast<uint32_t>(sample.label));
  }
  return best;
}

}  // namespace tactus::internal
