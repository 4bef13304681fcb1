#include "core/inputs/inputs.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace tactus::internal {
namespace {

constexpr double kLogOffsetFraction = 0.02;

// Median of the positive values of one feature; 1 if there is none.
double TypicalValue(const VariedContacts& contacts, Cue cue) {
  std::vector<double> values;
  LabelledContact made;
  for (size_t i = 0; i < contacts.size(); ++i) {
    const ContactFrames& frames = contacts.Get(i, made).frames;
    for (size_t t = 0; t < frames.size(); ++t) {
      const double value = frames.features(t)[static_cast<int>(cue)];
      if (frames.touched(t) && value > 0) values.push_back(value);
    }
  }
  if (values.empty()) return 1;
  const auto middle =
      values.begin() + static_cast<ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Range {
  double count = 0;
  double mean = 0;
  double squares = 0;
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();

  void Add(double value) {
    const double step = value - mean;
    count += 1;
    mean += step / count;
    squares += step * (value - mean);
    min = std::min(min, value);
    max = std::max(max, value);
  }
};

// The rounding of a cue's means, as a fraction of the cue. A cue that varies no
// more is constant.
constexpr double kRounding = 1e-12;

bool Varies(double spread, double low, double high) {
  return spread > kRounding * std::max(std::abs(low), std::abs(high));
}

// Quantiles are taken from at most so many steps, evenly chosen from all: 64 MB
// a cue.
constexpr size_t kMaxQuantileSteps = 8'000'000;

// Adds the inputs of a stretched cue. Sorts its `values`.
void AddStretches(Cue cue, int stretches, std::vector<double>& values,
                  std::vector<ModelInput>& inputs) {
  if (values.empty()) return;
  std::sort(values.begin(), values.end());
  const auto quantile = [&](int n) {
    return values[(values.size() - 1) * n / stretches];
  };
  for (int n = 0; n < stretches; ++n) {
    const double low = quantile(n);
    const double high = quantile(n + 1);
    if (Varies(high - low, low, high)) {
      inputs.push_back({.cue = cue,
                        .offset = (low + high) / 2,
                        .gain = 2 / (high - low),
                        .limit = 1});
    }
  }
}

}  // namespace

size_t CountSteps(const LabelledContact& contact, const StepIntervals& steps) {
  StepClock clock(steps);
  size_t count = 0;
  for (size_t i = 0; i < contact.frames.size(); ++i) {
    count += contact.frames.touched(i) && clock.Tick(i + 1);
  }
  return count;
}

CueGroups GroupsOf(std::span<const ModelInput> inputs) {
  CueGroups groups = 0;
  for (const ModelInput& input : inputs) groups |= GroupOf(input.cue);
  return groups;
}

void WalkCues(const LabelledContact& contact, const StepIntervals& steps,
              CueGroups groups, const TaxelEmbedding* embedding,
              absl::FunctionRef<void(CueTracker& cues, size_t frame)> visit) {
  CueTracker cues(contact.sample_rate_hz, groups, embedding);
  StepClock clock(steps);
  for (size_t i = 0; i < contact.frames.size(); ++i) {
    if (!contact.frames.touched(i)) continue;
    const uint64_t frames = i + 1;
    cues.Step(contact.frames[i].sample, frames);
    if (clock.Tick(frames)) visit(cues, i);
  }
}

std::vector<ModelInput> FitInputs(const VariedContacts& contacts,
                                  std::span<const Cue> cues,
                                  const InputOptions& options,
                                  const ParallelFor& parallel,
                                  CueTable* table) {
  std::vector<ModelInput> inputs;
  for (Cue cue : cues) {
    const bool raw = static_cast<int>(cue) < kFeatureCount;
    const double log_offset =
        options.log_features && raw
            ? kLogOffsetFraction * TypicalValue(contacts, cue)
            : 0;
    inputs.push_back(
        {.cue = cue, .log_offset = log_offset, .limit = options.limit});
  }
  std::vector<Range> ranges(inputs.size());
  const bool stretched = options.stretches > 0;
  std::vector<std::vector<double>> values(
      stretched ? options.stretched_cues.size() : 0);
  size_t stride = 1;
  if (stretched) {
    // At most: a copy has no more frames than its contact.
    size_t steps = 0;
    for (size_t c = 0; c < contacts.size(); ++c) {
      steps += CountSteps(contacts.Original(c), options.steps);
    }
    stride = 1 + steps / kMaxQuantileSteps;
    for (std::vector<double>& each : values) each.reserve(steps / stride + 1);
  }
  size_t step = 0;
  std::vector<Cue> walked(cues.begin(), cues.end());
  if (stretched) {
    std::ranges::copy(options.stretched_cues, std::back_inserter(walked));
  }
  CueTable made(contacts, walked,
                {.steps = options.steps,
                 .embedding = options.embedding,
                 .kept_bytes = table != nullptr ? options.kept_bytes : 0});
  made.Walk(parallel, [&](std::span<const double> row) {
    for (size_t i = 0; i < inputs.size(); ++i) {
      ranges[i].Add(TransformCue(row[i], inputs[i].log_offset));
    }
    if (step++ % stride != 0) return;
    for (size_t i = 0; i < values.size(); ++i) {
      values[i].push_back(row[inputs.size() + i]);
    }
  });
  if (table != nullptr) *table = std::move(made);
  for (size_t i = 0; i < inputs.size(); ++i) {
    const Range& range = ranges[i];
    const bool standard = options.scaling == Scaling::kStandard;
    const double spread = standard ? std::sqrt(range.squares / range.count)
                                   : range.max - range.min;
    inputs[i].offset = standard ? range.mean : range.min;
    inputs[i].gain = Varies(spread, range.min, range.max) ? 1 / spread : 1;
  }
  for (size_t i = 0; i < values.size(); ++i) {
    AddStretches(options.stretched_cues[i], options.stretches, values[i],
                 inputs);
  }
  return inputs;
}

void AppendSequence(const LabelledContact& contact,
                    std::span<const ModelInput> inputs,
                    const StepIntervals& steps, const TaxelEmbedding* embedding,
                    std::vector<double>& rows) {
  WalkCues(contact, steps, GroupsOf(inputs), embedding,
           [&](CueTracker& cues, size_t) {
             rows.resize(rows.size() + inputs.size());
             MakeInput(inputs, cues, std::span(rows).last(inputs.size()));
           });
}

std::vector<double> MakeSequence(const LabelledContact& contact,
                                 std::span<const ModelInput> inputs,
                                 const StepIntervals& steps,
                                 const TaxelEmbedding* embedding) {
  std::vector<double> rows;
  rows.reserve(CountSteps(contact, steps) * inputs.size());
  AppendSequence(contact, inputs, steps, embedding, rows);
  return rows;
}

}  // namespace tactus::internal
