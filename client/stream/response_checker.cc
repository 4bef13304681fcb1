#include "client/stream/response_checker.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::client {
namespace {

using google::protobuf::RepeatedField;

// How far the sum of probabilities may be from 1.
constexpr double kSumTolerance = 1e-3;

absl::Status CheckRange(absl::string_view field, double value, double low,
                        double high) {
  if (value >= low && value <= high) return absl::OkStatus();
  return InvalidResponse(field, value, absl::StrCat(low, " to ", high));
}

absl::Status CheckFinite(absl::string_view field, double value) {
  if (std::isfinite(value)) return absl::OkStatus();
  return InvalidResponse(field, value, "finite");
}

absl::Status CheckCount(absl::string_view field, int got, int want) {
  if (got == want) return absl::OkStatus();
  return InvalidResponse(absl::StrCat("size of ", field), got,
                         absl::StrCat(want, ", one per class"));
}

absl::Status CheckDistribution(absl::string_view field,
                               const RepeatedField<double>& values,
                               int classes) {
  TACTUS_RETURN_IF_ERROR(CheckCount(field, values.size(), classes));
  double sum = 0;
  for (const double value : values) {
    TACTUS_RETURN_IF_ERROR(CheckRange(field, value, 0, 1));
    sum += value;
  }
  return CheckRange(absl::StrCat("sum of ", field), sum, 1 - kSumTolerance,
                    1 + kSumTolerance);
}

// A class whose models exclude the contact has the logarithm of 0.
absl::Status CheckLogLikelihood(const RepeatedField<double>& values,
                                int classes) {
  constexpr absl::string_view kField = "posterior.log_likelihood";
  TACTUS_RETURN_IF_ERROR(CheckCount(kField, values.size(), classes));
  for (const double value : values) {
    if (std::isnan(value) || value == std::numeric_limits<double>::infinity()) {
      return InvalidResponse(kField, value, "finite or -inf");
    }
  }
  return absl::OkStatus();
}

absl::Status CheckDecision(const v1::Posterior& posterior, int classes) {
  if (!posterior.has_decision()) return absl::OkStatus();
  const v1::Decision& decision = posterior.decision();
  TACTUS_RETURN_IF_ERROR(CheckRange("posterior.decision.class_index",
                                    decision.class_index(), 0, classes - 1));
  if (decision.sequence() > posterior.sequence()) {
    return InvalidResponse(
        "posterior.decision.sequence", decision.sequence(),
        absl::StrCat("at most posterior.sequence, ", posterior.sequence()));
  }
  if (decision.time_since_onset_ns() < 0) {
    return InvalidResponse("posterior.decision.time_since_onset_ns",
                           decision.time_since_onset_ns(), "at least 0");
  }
  return absl::OkStatus();
}

absl::Status CheckFeatures(const v1::Posterior& posterior, int taxels) {
  if (!posterior.has_features()) return absl::OkStatus();
  const v1::ContactFeatures& features = posterior.features();
  for (const double value :
       {features.max_force(), features.area_m2(), features.motion_m(),
        features.centroid_row(), features.centroid_column()}) {
    TACTUS_RETURN_IF_ERROR(CheckFinite("posterior.features", value));
  }
  TACTUS_RETURN_IF_ERROR(CheckRange("posterior.features.area_taxels",
                                    features.area_taxels(), 0, taxels));
  return CheckRange("posterior.features.region_count", features.region_count(),
                    0, taxels);
}

absl::Status CheckObject(const v1::Posterior& posterior) {
  if (!posterior.has_object()) return absl::OkStatus();
  const v1::ObjectEstimate& object = posterior.object();
  for (const double value : {object.log10_stiffness(), object.moved_m()}) {
    TACTUS_RETURN_IF_ERROR(CheckFinite("posterior.object", value));
  }
  for (const double value :
       {object.log10_stiffness_deviation(), object.moved_deviation_m()}) {
    TACTUS_RETURN_IF_ERROR(CheckRange("posterior.object's deviations", value, 0,
                                      std::numeric_limits<double>::max()));
  }
  return absl::OkStatus();
}

}  // namespace

void ResponseChecker::OnSent(const v1::ClassifyContactRequest& request) {
  if (request.has_frames()) {
    const v1::FrameBatch& frames = request.frames();
    const uint64_t last = frames.first_sequence() + frames.frame_count() - 1;
    sent_sequence_ = std::max<uint64_t>(sent_sequence_, last);
  } else if (request.has_end_of_trial()) {
    ++trials_ended_;
  }
}

absl::Status ResponseChecker::Check(
    const v1::ClassifyContactResponse& response) {
  if (response.has_started()) return CheckStarted(response.started());
  if (classes_ == 0) {
    return InvalidResponse("first response", "not `started`", "`started`");
  }
  if (response.has_posterior()) return CheckPosterior(response.posterior());
  return absl::OkStatus();
}

absl::Status ResponseChecker::CheckStarted(const v1::StreamStarted& started) {
  if (classes_ != 0) {
    return InvalidResponse("number of `started` responses", 2, "1");
  }
  TACTUS_RETURN_IF_ERROR(CheckRange("number of started.class_names",
                                    started.class_names_size(), 1,
                                    limits::kMaxClasses));
  for (const std::string& name : started.class_names()) {
    if (name.empty() || name.size() > limits::kMaxNameBytes) {
      return InvalidResponse("length of a name in started.class_names",
                             name.size(),
                             absl::StrCat("1 to ", limits::kMaxNameBytes));
    }
  }
  const v1::SensorGeometry& geometry = started.geometry();
  TACTUS_RETURN_IF_ERROR(CheckRange("started.geometry.rows", geometry.rows(), 1,
                                    limits::kMaxRows));
  TACTUS_RETURN_IF_ERROR(CheckRange(
      "started.geometry.columns", geometry.columns(), 1, limits::kMaxColumns));
  classes_ = started.class_names_size();
  taxels_ = static_cast<int>(geometry.rows() * geometry.columns());
  return absl::OkStatus();
}

absl::Status ResponseChecker::CheckPosterior(const v1::Posterior& posterior) {
  TACTUS_RETURN_IF_ERROR(CheckOrder(posterior));
  if (posterior.contact_state() < v1::CONTACT_STATE_NO_CONTACT ||
      posterior.contact_state() > v1::CONTACT_STATE_RELEASED) {
    return InvalidResponse("posterior.contact_state",
                           static_cast<int>(posterior.contact_state()),
                           "a value of ContactState");
  }
  if (posterior.time_since_onset_ns() < 0) {
    return InvalidResponse("posterior.time_since_onset_ns",
                           posterior.time_since_onset_ns(), "at least 0");
  }
  TACTUS_RETURN_IF_ERROR(
      CheckLogLikelihood(posterior.log_likelihood(), classes_));
  TACTUS_RETURN_IF_ERROR(CheckDistribution("posterior.probability",
                                           posterior.probability(), classes_));
  TACTUS_RETURN_IF_ERROR(CheckDistribution(
      "posterior.hmm_probability", posterior.hmm_probability(), classes_));
  if (!posterior.lstm_probability().empty()) {
    TACTUS_RETURN_IF_ERROR(CheckDistribution(
        "posterior.lstm_probability", posterior.lstm_probability(), classes_));
  }
  TACTUS_RETURN_IF_ERROR(
      CheckRange("posterior.unknown", posterior.unknown(), 0, 1));
  TACTUS_RETURN_IF_ERROR(
      CheckRange("posterior.stability", posterior.stability(), 0, 1));
  TACTUS_RETURN_IF_ERROR(CheckDecision(posterior, classes_));
  TACTUS_RETURN_IF_ERROR(CheckFeatures(posterior, taxels_));
  return CheckObject(posterior);
}

absl::Status ResponseChecker::CheckOrder(const v1::Posterior& posterior) {
  const uint64_t sequence = posterior.sequence();
  const uint64_t sent = sent_sequence_;
  if (sequence > sent) {
    return InvalidResponse(
        "posterior.sequence", sequence,
        absl::StrCat("at most ", sent, ", the last frame that was sent"));
  }
  if (posterior.onset_sequence() > sequence) {
    return InvalidResponse(
        "posterior.onset_sequence", posterior.onset_sequence(),
        absl::StrCat("at most posterior.sequence, ", sequence));
  }
  if (!posterior.is_final()) {
    if (sequence <= last_sequence_) {
      return InvalidResponse("posterior.sequence", sequence,
                             absl::StrCat("above ", last_sequence_));
    }
    last_sequence_ = sequence;
    return absl::OkStatus();
  }
  if (sequence < last_sequence_) {
    return InvalidResponse("sequence of a final posterior", sequence,
                           absl::StrCat("at least ", last_sequence_));
  }
  last_sequence_ = sequence;
  // The end of a stream may end one trial more.
  const uint64_t most = trials_ended_ + 1;
  if (++finals_ > most) {
    return InvalidResponse("number of final posteriors", finals_,
                           absl::StrCat("at most ", most));
  }
  return absl::OkStatus();
}

}  // namespace tactus::client
