#include "tests/server/support/bad_input.h"

#include <cstring>
#include <functional>
#include <limits>
#include <utility>

#include "core/base/limits.h"
#include "tests/server/support/requests.h"

namespace tactus::internal::testing {
namespace {

using absl::StatusCode;
using Request = v1::ClassifyContactRequest;

constexpr StatusCode kInvalid = StatusCode::kInvalidArgument;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

class Table {
 public:
  void Add(std::string name, std::vector<Request> requests, StatusCode code,
           std::string reason) {
    rows_.push_back(
        {std::move(name), std::move(requests), code, std::move(reason)});
  }

  // A configuration with one change.
  void Config(std::string name, std::function<void(v1::StreamConfig*)> change,
              StatusCode code, std::string reason) {
    Request config = ConfigRequest();
    change(config.mutable_config());
    Add(std::move(name), {config}, code, std::move(reason));
  }

  // A message of two frames with one change, after one good message that
  // ended at sequence 10.
  void Frames(std::string name, std::function<void(v1::FrameBatch*)> change,
              StatusCode code, std::string reason,
              Request batch = DenseU16(11, {Touch(1), Touch(1)}),
              Request config = ConfigRequest(),
              Request before = DenseU16(10, {Touch(1)})) {
    change(batch.mutable_frames());
    Add(std::move(name),
        {std::move(config), std::move(before), std::move(batch)}, code,
        std::move(reason));
  }

  std::vector<BadInput> Take() { return std::move(rows_); }
  std::vector<BadInput>& rows() { return rows_; }

 private:
  std::vector<BadInput> rows_;
};

Request FloatConfig() {
  Request config = ConfigRequest();
  config.mutable_config()->set_taxel_type(v1::TAXEL_TYPE_FLOAT32);
  config.mutable_config()->set_scale(1);
  return config;
}

Request PoseConfig() {
  Request config = ConfigRequest();
  config.mutable_config()->set_with_poses(true);
  return config;
}

Request PosedBatch(uint64_t sequence, int frames) {
  Request request = DenseU16(sequence, std::vector<Counts>(frames, Touch(1)));
  for (int i = 0; i < frames; ++i) AddPose(Pose(), request.mutable_frames());
  return request;
}

void SetFloat(int taxel, float value, v1::FrameBatch* batch) {
  std::memcpy(batch->mutable_taxels()->data() + 4 * taxel, &value, 4);
}

void SetIndex(int entry, uint16_t taxel, v1::FrameBatch* batch) {
  std::memcpy(batch->mutable_sparse()->mutable_indices()->data() + 2 * entry,
              &taxel, 2);
}

void AddOrderRows(Table& t) {
  t.Add("FramesBeforeConfig", {DenseU16(1, {Touch(1)})}, kInvalid,
        "CONFIG_REQUIRED");
  t.Add("EndOfTrialBeforeConfig", {EndOfTrialRequest()}, kInvalid,
        "CONFIG_REQUIRED");
  t.Add("EmptyFirst", {Request()}, kInvalid, "EMPTY_REQUEST");
  t.Add("EmptyLater", {ConfigRequest(), Request()}, kInvalid, "EMPTY_REQUEST");
  t.Add("ConfigTwice", {ConfigRequest(), ConfigRequest()}, kInvalid,
        "CONFIG_REPEATED");
  t.Add("ConfigAfterFrames",
        {ConfigRequest(), DenseU16(1, {Touch(1)}), ConfigRequest()}, kInvalid,
        "CONFIG_REPEATED");
  t.Add("HalfCloseFirst", {}, kInvalid, "CONFIG_REQUIRED");
  t.rows().back().half_close = true;
}

void AddGeometryRows(Table& t) {
  const auto shape = [](v1::StreamConfig* c) {
    v1::SensorGeometry* g = c->mutable_geometry();
    g->set_layout("mine");
    g->set_rows(8);
    g->set_columns(8);
    g->set_row_pitch_m(0.01);
    g->set_column_pitch_m(0.01);
    g->set_taxel_area_m2(1e-4);
    g->set_unit(v1::TAXEL_UNIT_NEWTON);
    g->set_contact_threshold(0.1);
    g->set_onset_threshold(0.2);
    return g;
  };
  const auto bad_shape = [&](std::string name, auto change) {
    t.Config(
        std::move(name), [=](v1::StreamConfig* c) { change(shape(c)); },
        kInvalid, "INVALID_CONFIG");
  };
  t.Config(
      "NoGeometry", [](auto* c) { c->clear_geometry(); }, kInvalid,
      "INVALID_CONFIG");
  t.Config(
      "EmptyGeometry", [](auto* c) { c->mutable_geometry()->clear_layout(); },
      kInvalid, "INVALID_CONFIG");
  t.Config(
      "UnknownLayout",
      [](auto* c) { c->mutable_geometry()->set_layout("left-pinky"); },
      kInvalid, "UNKNOWN_LAYOUT");
  t.Config(
      "LayoutNameTooLong",
      [](auto* c) { c->mutable_geometry()->set_layout(std::string(129, 'x')); },
      kInvalid, "INVALID_CONFIG");
  t.Config(
      "PresetWithPitch",
      [](auto* c) { c->mutable_geometry()->set_row_pitch_m(0.01); }, kInvalid,
      "INVALID_CONFIG");
  t.Config(
      "PresetWithNanThreshold",
      [](auto* c) { c->mutable_geometry()->set_contact_threshold(kNan); },
      kInvalid, "INVALID_CONFIG");
  bad_shape("NoColumns", [](auto* g) { g->set_columns(0); });
  bad_shape("TooManyRows", [](auto* g) { g->set_rows(65); });
  bad_shape("HugeColumns", [](auto* g) { g->set_columns(4294967295U); });
  bad_shape("ZeroPitch", [](auto* g) { g->set_row_pitch_m(0); });
  bad_shape("InfinitePitch", [](auto* g) { g->set_column_pitch_m(kInfinity); });
  bad_shape("NegativeArea", [](auto* g) { g->set_taxel_area_m2(-1e-4); });
  bad_shape("NoUnit", [](auto* g) { g->clear_unit(); });
  bad_shape("UnknownUnit",
            [](auto* g) { g->set_unit(static_cast<v1::TaxelUnit>(9)); });
  bad_shape("NoThreshold", [](auto* g) { g->set_contact_threshold(0); });
  bad_shape("OnsetBelowContact", [](auto* g) { g->set_onset_threshold(0.05); });
  bad_shape("MaskBeyondSkin", [](auto* g) { g->add_masked_taxels(64); });
  bad_shape("MaskOfEverything", [](auto* g) {
    for (int i = 0; i < 64; ++i) g->add_masked_taxels(i);
  });
  bad_shape("UnknownConnectivity", [](auto* g) {
    g->set_connectivity(static_cast<v1::Connectivity>(6));
  });
}

void AddConfigRows(Table& t) {
  const auto bad = [&](std::string name, auto change) {
    t.Config(std::move(name), change, kInvalid, "INVALID_CONFIG");
  };
  bad("NoTaxelType", [](auto* c) { c->clear_taxel_type(); });
  bad("UnknownTaxelType",
      [](auto* c) { c->set_taxel_type(static_cast<v1::TaxelType>(7)); });
  bad("NegativeScale", [](auto* c) { c->set_scale(-1); });
  bad("NanScale", [](auto* c) { c->set_scale(kNan); });
  bad("NegativeRate", [](auto* c) { c->set_sample_rate_hz(-100); });
  bad("NanRate", [](auto* c) { c->set_sample_rate_hz(kNan); });
  bad("RateTooHigh", [](auto* c) { c->set_sample_rate_hz(10'001); });
  bad("RateOffTheModels", [](auto* c) { c->set_sample_rate_hz(50); });
  bad("UnknownCadence",
      [](auto* c) { c->set_cadence(static_cast<v1::ResultCadence>(99)); });
  bad("NoInterval",
      [](auto* c) { c->set_cadence(v1::RESULT_CADENCE_EVERY_N_FRAMES); });
  bad("IntervalTooLong", [](auto* c) {
    c->set_cadence(v1::RESULT_CADENCE_EVERY_N_FRAMES);
    c->set_result_interval_frames(10'001);
  });
  bad("ThresholdOfHalf", [](auto* c) { c->set_decision_threshold(0.5); });
  bad("ThresholdAboveOne", [](auto* c) { c->set_decision_threshold(1.01); });
  bad("NanThreshold", [](auto* c) { c->set_decision_threshold(kNan); });
  bad("DecisionFramesTooMany", [](auto* c) { c->set_decision_frames(10'001); });
  bad("NoScale", [](auto* c) { c->set_scale(0); });
  bad("NoRate", [](auto* c) { c->set_sample_rate_hz(0); });
  bad("NoDecisionFrames", [](auto* c) { c->set_decision_frames(0); });
  bad("NoRelease", [](auto* c) {
    c->clear_never_release();
    c->set_release_after_ms(0);
  });
  bad("ReleaseThatNeverComes", [](auto* c) {
    c->set_never_release(true);
    c->set_release_after_ms(100);
  });
  bad("NoContacts", [](auto* c) { c->set_max_contacts(0); });
  bad("TooManyContacts", [](auto* c) { c->set_max_contacts(9); });
  bad("UnknownEffort",
      [](auto* c) { c->set_effort(static_cast<v1::Effort>(9)); });
  bad("ReleaseTooLate", [](auto* c) {
    c->clear_never_release();
    c->set_release_after_ms(60'001);
  });
  bad("ClientIdTooLong",
      [](auto* c) { c->set_client_id(std::string(129, 'x')); });
  bad("ModelNameTooLong", [](auto* c) { c->set_model(std::string(129, 'x')); });
  t.Config(
      "UnknownModel", [](auto* c) { c->set_model("models/none"); },
      StatusCode::kNotFound, "MODEL_NOT_FOUND");
  t.Config(
      "ModelOfAnotherSkin", [](auto* c) { c->set_model("models/vitac"); },
      StatusCode::kFailedPrecondition, "GEOMETRY_MISMATCH");
}

void AddFrameRows(Table& t) {
  const auto size = [&](std::string name, auto change) {
    t.Frames(std::move(name), change, kInvalid, "FRAME_SIZE_MISMATCH");
  };
  size("NoTaxels", [](auto* b) { b->clear_taxels(); });
  size("OneByteShort", [](auto* b) { b->mutable_taxels()->pop_back(); });
  size("OneByteLong", [](auto* b) { b->mutable_taxels()->push_back(0); });
  size("CountAboveTaxels", [](auto* b) { b->set_frame_count(3); });
  size("DenseAndSparse", [](auto* b) { b->mutable_sparse(); });
  const auto count = [&](std::string name, uint32_t value) {
    t.Frames(
        std::move(name), [=](auto* b) { b->set_frame_count(value); }, kInvalid,
        "FRAME_COUNT_OUT_OF_RANGE");
  };
  count("NoFrames", 0);
  count("SixtyFiveFrames", 65);
  count("HugeFrameCount", 4294967295U);
  t.Frames(
      "MessageTooLarge",
      [](auto* b) { b->mutable_taxels()->resize(limits::kMaxMessageBytes); },
      kInvalid, "MESSAGE_TOO_LARGE");
  t.Config(
      "ConfigTooLarge",
      [](auto* c) { c->set_client_id(std::string(70'000, 'x')); }, kInvalid,
      "MESSAGE_TOO_LARGE");

  const auto range = [&](std::string name, auto change, std::string reason) {
    t.Frames(std::move(name), change, StatusCode::kOutOfRange,
             std::move(reason));
  };
  range(
      "SequenceRepeated", [](auto* b) { b->set_first_sequence(10); },
      "SEQUENCE_REGRESSION");
  range(
      "SequenceBack", [](auto* b) { b->set_first_sequence(3); },
      "SEQUENCE_REGRESSION");
  range(
      "TimeRepeated",
      [](auto* b) { b->set_first_capture_time_ns(100'000'000); },
      "TIME_REGRESSION");
  range(
      "TimeBack", [](auto* b) { b->set_first_capture_time_ns(-5); },
      "TIME_REGRESSION");
  t.Frames(
      "SequenceAtTheEnd",
      [](auto* b) {
        b->set_first_sequence(std::numeric_limits<uint64_t>::max());
      },
      kInvalid, "SEQUENCE_REGRESSION");
  t.Frames(
      "TimeAtTheEnd",
      [](auto* b) {
        b->set_first_capture_time_ns(std::numeric_limits<int64_t>::max());
      },
      kInvalid, "TIME_REGRESSION");
  t.Add("SequenceBackAcrossTrials",
        {ConfigRequest(), DenseU16(5, {Touch(1)}), EndOfTrialRequest(),
         DenseU16(1, {Touch(1)})},
        StatusCode::kOutOfRange, "SEQUENCE_REGRESSION");
}

void AddValueRows(Table& t) {
  const auto value = [&](std::string name, float taxel, std::string reason) {
    t.Frames(
        std::move(name), [=](auto* b) { SetFloat(400, taxel, b); }, kInvalid,
        std::move(reason), DenseF32(11, {Touch(1), Touch(1)}), FloatConfig(),
        DenseF32(10, {Touch(1)}));
  };
  value("NanTaxel", kNan, "NON_FINITE_TAXEL");
  value("InfiniteTaxel", kInfinity, "NON_FINITE_TAXEL");
  value("MinusInfiniteTaxel", -kInfinity, "NON_FINITE_TAXEL");
  value("NegativeTaxel", -0.001F, "NEGATIVE_TAXEL");
  value("TaxelTooLarge", 2e12F, "NON_FINITE_TAXEL");
  Request config = ConfigRequest();
  config.mutable_config()->set_scale(1e300);
  t.Add("ScaleBeyondFloat", {config, DenseU16(1, {Touch(1)})}, kInvalid,
        "NON_FINITE_TAXEL");
}

void AddSparseRows(Table& t) {
  const auto sparse = [&](std::string name, auto change, std::string reason) {
    t.Frames(std::move(name), change, kInvalid, std::move(reason),
             SparseU16(11, {Touch(1), Touch(1)}));
  };
  sparse(
      "SparseIndexBeyondSkin", [](auto* b) { SetIndex(7, kCodyTaxels, b); },
      "INVALID_SPARSE_INDEX");
  sparse(
      "SparseIndexRepeated", [](auto* b) { SetIndex(1, 5 * 24 + 7, b); },
      "INVALID_SPARSE_INDEX");
  sparse(
      "SparseIndexBack", [](auto* b) { SetIndex(5, 0, b); },
      "INVALID_SPARSE_INDEX");
  sparse(
      "SparseCountsShort",
      [](auto* b) { b->mutable_sparse()->mutable_counts()->RemoveLast(); },
      "FRAME_SIZE_MISMATCH");
  sparse(
      "SparseCountsHuge",
      [](auto* b) { b->mutable_sparse()->set_counts(1, 4294967295U); },
      "FRAME_SIZE_MISMATCH");
  sparse(
      "SparseIndicesOdd",
      [](auto* b) { b->mutable_sparse()->mutable_indices()->push_back(1); },
      "FRAME_SIZE_MISMATCH");
  sparse(
      "SparseValuesShort",
      [](auto* b) { b->mutable_sparse()->mutable_values()->pop_back(); },
      "FRAME_SIZE_MISMATCH");
}

void AddPoseRows(Table& t) {
  const auto pose = [&](std::string name, auto change) {
    t.Frames(std::move(name), change, kInvalid, "INVALID_POSE",
             PosedBatch(11, 2), PoseConfig(), PosedBatch(10, 1));
  };
  pose("PoseMissing", [](auto* b) { b->clear_poses(); });
  pose("PoseShort", [](auto* b) { b->mutable_poses()->RemoveLast(); });
  pose("PoseNan", [](auto* b) { b->set_poses(8, kNan); });
  pose("PoseTooFar", [](auto* b) { b->set_poses(7, 1e7); });
  pose("PoseQuaternionZero", [](auto* b) { b->set_poses(13, 0); });
  pose("PoseQuaternionLong", [](auto* b) { b->set_poses(13, 1.01); });
  pose("PoseQuaternionOverflows", [](auto* b) { b->set_poses(13, 1e200); });
  t.Frames(
      "PoseNotAnnounced", [](auto* b) { AddPose(Pose(), b); }, kInvalid,
      "INVALID_POSE");
}

// A skin of 2 x 2 taxels of three signed axes, in int16.
Request AxesConfig() {
  Request request = ConfigRequest();
  v1::StreamConfig* config = request.mutable_config();
  v1::SensorGeometry* g = config->mutable_geometry();
  g->set_layout("mine");
  g->set_rows(2);
  g->set_columns(2);
  g->set_row_pitch_m(0.01);
  g->set_column_pitch_m(0.01);
  g->set_taxel_area_m2(1e-4);
  g->set_unit(v1::TAXEL_UNIT_NEWTON);
  g->set_contact_threshold(0.01);
  g->set_onset_threshold(0.02);
  g->set_axes(3);
  g->set_normal_axis(2);
  g->set_signed_values(true);
  config->set_taxel_type(v1::TAXEL_TYPE_INT16);
  return request;
}

void AddAxesRows(Table& t) {
  const auto config = [&](std::string name, auto change, std::string reason) {
    Request request = AxesConfig();
    change(request.mutable_config());
    t.Add(std::move(name), {request}, kInvalid, std::move(reason));
  };
  config(
      "AxesTwo", [](auto* c) { c->mutable_geometry()->set_axes(2); },
      "INVALID_CONFIG");
  config(
      "NormalAxisThree",
      [](auto* c) { c->mutable_geometry()->set_normal_axis(3); },
      "INVALID_CONFIG");
  config(
      "SignedTypeOfUnsignedSkin",
      [](auto* c) { c->mutable_geometry()->set_signed_values(false); },
      "INVALID_CONFIG");
  // Twelve values a frame.
  const auto batch = [](uint64_t sequence, size_t bytes) {
    Request request;
    request.mutable_frames()->set_first_sequence(sequence);
    request.mutable_frames()->set_first_capture_time_ns(
        static_cast<int64_t>(sequence) * 10'000'000);
    request.mutable_frames()->set_frame_count(1);
    request.mutable_frames()->mutable_taxels()->assign(bytes, '\xff');
    return request;
  };
  t.Add("OneAxisOfThree", {AxesConfig(), batch(1, 24), batch(2, 8)}, kInvalid,
        "FRAME_SIZE_MISMATCH");
  Request sparse = batch(2, 0);
  sparse.mutable_frames()->mutable_sparse()->add_counts(1);
  sparse.mutable_frames()->mutable_sparse()->mutable_values()->assign(2, '\1');
  sparse.mutable_frames()->mutable_sparse()->mutable_indices()->assign("\x0c\0",
                                                                       2);
  t.Add("SparseIndexBeyondTheAxes", {AxesConfig(), batch(1, 24), sparse},
        kInvalid, "INVALID_SPARSE_INDEX");
  Request floats = AxesConfig();
  floats.mutable_config()->set_scale(1);
  floats.mutable_config()->set_taxel_type(v1::TAXEL_TYPE_FLOAT32);
  Request low = batch(1, 0);
  for (int i = 0; i < 12; ++i)
    low.mutable_frames()->mutable_taxels()->append(std::string(4, '\0'));
  SetFloat(7, -2e12F, low.mutable_frames());
  t.Add("SignedTooLow", {floats, low}, kInvalid, "NON_FINITE_TAXEL");
  floats.mutable_config()->mutable_geometry()->set_signed_values(false);
  SetFloat(7, -0.5F, low.mutable_frames());
  t.Add("NegativeOfUnsignedAxes", {floats, low}, kInvalid, "NEGATIVE_TAXEL");
}

}  // namespace

std::vector<BadInput> BadInputs() {
  Table table;
  AddOrderRows(table);
  AddGeometryRows(table);
  AddConfigRows(table);
  AddFrameRows(table);
  AddValueRows(table);
  AddSparseRows(table);
  AddPoseRows(table);
  AddAxesRows(table);
  return table.Take();
}

}  // namespace tactus::internal::testing
