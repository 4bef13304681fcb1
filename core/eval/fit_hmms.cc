#include "core/eval/fit_hmms.h"

#include <algorithm>
#include <cmath>

#include "core/base/status_macros.h"
#include "core/classify/feature_input.h"
#include "core/hmm/train_mixture.h"

namespace tactus {
namespace {

// The logarithm is taken of feature + this share of the feature's typical
// (median positive) value, so that sensor noise around zero stays small.
constexpr double kLogOffsetShare = 0.02;

// Median of the positive values of one feature; 1 if there is none.
double TypicalValue(const std::vector<const Contact*>& contacts,
                    Feature feature) {
  std::vector<double> values;
  for (const Contact* contact : contacts) {
    for (const ContactFrame& frame : contact->frames) {
      const double value = frame.features[static_cast<int>(feature)];
      if (frame.touched && value > 0) values.push_back(value);
    }
  }
  if (values.empty()) return 1;
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Standard scores over all frames (paper, eq. for S_f).
FeatureScaling StandardScaling(const std::vector<const Contact*>& contacts,
                               const FeatureSpec& spec, size_t index) {
  double count = 0;
  double mean = 0;
  double squares = 0;
  for (const Contact* contact : contacts) {
    for (const ContactFrame& frame : contact->frames) {
      if (!frame.touched) continue;
      const double value = TransformFeature(spec, index, frame.features);
      const double step = value - mean;
      count += 1;
      mean += step / count;
      squares += step * (value - mean);
    }
  }
  const double deviation = std::sqrt(squares / count);
  return {mean, deviation > 0 ? 1 / deviation : 1};
}

FeatureSpec FitFeatureSpec(const std::vector<const Contact*>& contacts,
                           const FitOptions& options) {
  FeatureSpec spec;
  spec.features = options.features;
  spec.sample_rate_hz = contacts.front()->sample_rate_hz;
  for (size_t i = 0; i < spec.features.size(); ++i) {
    spec.log_offset.push_back(options.log_features
                                  ? kLogOffsetShare *
                                        TypicalValue(contacts, spec.features[i])
                                  : 0.0);
    spec.hmm_scaling.push_back(StandardScaling(contacts, spec, i));
  }
  return spec;
}

// Scaled inputs of one contact's touched frames, frames x features, row-major.
std::vector<double> MakeSequence(const Contact& contact,
                                 const FeatureSpec& spec) {
  std::vector<double> sequence;
  std::vector<double> input(spec.features.size());
  for (const ContactFrame& frame : contact.frames) {
    if (!frame.touched) continue;
    MakeInput(spec, spec.hmm_scaling, frame.features, input);
    sequence.insert(sequence.end(), input.begin(), input.end());
  }
  return sequence;
}

absl::StatusOr<HmmMixture> FitClass(const std::vector<const Contact*>& contacts,
                                    const std::string& name,
                                    const FeatureSpec& spec,
                                    const FitOptions& options) {
  std::vector<std::vector<double>> sequences;
  for (const Contact* contact : contacts) {
    if (contact->label == name) {
      sequences.push_back(MakeSequence(*contact, spec));
    }
  }
  const int dimensions = static_cast<int>(spec.features.size());
  std::vector<SequenceView> views;
  for (const auto& sequence : sequences) {
    views.push_back({sequence.data(),
                     static_cast<int>(sequence.size()) / dimensions,
                     dimensions});
  }
  TrainMixtureOptions training;
  training.components = options.hmms_per_class;
  training.states = options.states;
  training.baum_welch.max_iterations = options.max_iterations;
  training.baum_welch.covariance_floor = options.covariance_floor;
  training.baum_welch.seed = options.seed;
  TACTUS_ASSIGN_OR_RETURN(TrainedMixture trained,
                          TrainMixture(views, training));
  return std::move(trained.mixture);
}

}  // namespace

absl::StatusOr<Model> FitHmms(const std::vector<const Contact*>& contacts,
                              const std::vector<std::string>& class_names,
                              const FitOptions& options) {
  Model model;
  model.class_names = class_names;
  model.features = FitFeatureSpec(contacts, options);
  model.hmm_score = options.score;
  model.layout = contacts.front()->layout;
  for (const std::string& name : class_names) {
    TACTUS_ASSIGN_OR_RETURN(HmmMixture mixture,
                            FitClass(contacts, name, model.features, options));
    model.hmms.push_back(std::move(mixture));
  }
  Calibration& c = model.calibration;
  c.frames = {1};
  c.hmm_temperature = {1};
  c.evidence_mean = {0};
  c.evidence_deviation = {1};
  c.prior.assign(class_names.size(),
                 1.0 / static_cast<double>(class_names.size()));
  return model;
}

}  // namespace tactus
