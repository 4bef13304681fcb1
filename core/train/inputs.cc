#include "core/train/inputs.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tactus {
namespace {

constexpr double kLogOffsetFraction = 0.02;

// Median of the positive values of one feature; 1 if there is none.
double TypicalValue(const VariedContacts& contacts, Cue cue) {
  std::vector<double> values;
  LabelledContact made;
  for (size_t i = 0; i < contacts.size(); ++i) {
    for (const ContactFrame& frame : contacts.Get(i, made).frames) {
      const double value = frame.sample.features[static_cast<int>(cue)];
      if (frame.touched && value > 0) values.push_back(value);
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

double Inverse(double spread) { return spread > 0 ? 1 / spread : 1; }

}  // namespace

void WalkCues(const LabelledContact& contact, const StepIntervals& steps,
              absl::FunctionRef<void(CueTracker& cues, size_t frame)> visit) {
  CueTracker cues(contact.sample_rate_hz);
  StepClock clock(steps);
  for (size_t i = 0; i < contact.frames.size(); ++i) {
    if (!contact.frames[i].touched) continue;
    const uint64_t frames = i + 1;
    cues.Step(contact.frames[i].sample, frames);
    if (clock.Tick(frames)) visit(cues, i);
  }
}

std::vector<ModelInput> FitInputs(const VariedContacts& contacts,
                                  std::span<const Cue> cues,
                                  const InputOptions& options) {
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
  LabelledContact made;
  for (size_t c = 0; c < contacts.size(); ++c) {
    WalkCues(contacts.Get(c, made), options.steps,
             [&](CueTracker& tracker, size_t) {
               for (size_t i = 0; i < inputs.size(); ++i) {
                 ranges[i].Add(TransformCue(tracker.value(inputs[i].cue),
                                            inputs[i].log_offset));
               }
             });
  }
  for (size_t i = 0; i < inputs.size(); ++i) {
    const Range& range = ranges[i];
    if (options.scaling == Scaling::kStandard) {
      inputs[i].offset = range.mean;
      inputs[i].gain = Inverse(std::sqrt(range.squares / range.count));
    } else {
      inputs[i].offset = range.min;
      inputs[i].gain = Inverse(range.max - range.min);
    }
  }
  return inputs;
}

std::vector<ModelInput> FitStretches(const VariedContacts& contacts,
                                     std::span<const Cue> cues, int stretches,
                                     const StepIntervals& steps) {
  std::vector<std::vector<double>> values(cues.size());
  LabelledContact made;
  for (size_t c = 0; c < contacts.size(); ++c) {
    WalkCues(contacts.Get(c, made), steps, [&](CueTracker& tracker, size_t) {
      for (size_t i = 0; i < cues.size(); ++i) {
        values[i].push_back(tracker.value(cues[i]));
      }
    });
  }
  std::vector<ModelInput> inputs;
  for (size_t i = 0; i < cues.size() && !values[i].empty(); ++i) {
    std::sort(values[i].begin(), values[i].end());
    auto quantile = [&](int n) {
      return values[i][(values[i].size() - 1) * n / stretches];
    };
    for (int n = 0; n < stretches; ++n) {
      const double low = quantile(n);
      const double high = quantile(n + 1);
      if (high > low) {
        inputs.push_back({.cue = cues[i],
                          .offset = (low + high) / 2,
                          .gain = 2 / (high - low),
                          .limit = 1});
      }
    }
  }
  return inputs;
}

std::vector<double> MakeSequence(const LabelledContact& contact,
                                 std::span<const ModelInput> inputs,
                                 const StepIntervals& steps) {
  std::vector<double> sequence;
  std::vector<double> row(inputs.size());
  WalkCues(contact, steps, [&](CueTracker& cues, size_t) {
    MakeInput(inputs, cues, row);
    sequence.insert(sequence.end(), row.begin(), row.end());
  });
  return sequence;
}

std::vector<float> MakeLstmSequence(const LabelledContact& contact,
                                    std::span<const ModelInput> inputs,
                                    const StepIntervals& steps) {
  std::vector<float> sequence;
  std::vector<double> row(inputs.size());
  WalkCues(contact, steps, [&](CueTracker& cues, size_t) {
    MakeInput(inputs, cues, row);
    for (double value : row) sequence.push_back(static_cast<float>(value));
  });
  return sequence;
}

}  // namespace tactus
