// Drives a StreamSession with messages of arbitrary bytes and with frame
// batches whose fields are arbitrary, while the reader comes and goes. Every
// posterior must be a probability distribution, every end have a reason, the
// queue stay bounded.
#include <fuzzer/FuzzedDataProvider.h>

#include <cmath>
#include <cstring>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "google/protobuf/io/zero_copy_stream_impl_lite.h"
#include "server/session/stream_session.h"
#include "tests/server/support/test_models.h"

namespace {

using tactus::server::StreamSession;
using Request = tactus::v1::ClassifyContactRequest;

#define REQUIRE(condition) \
  if (!(condition)) __builtin_trap()

// A small skin, so that few bytes make a frame.
constexpr int kSide = 3;

Request Config(FuzzedDataProvider& data) {
  Request request;
  auto* config = request.mutable_config();
  auto* geometry = config->mutable_geometry();
  geometry->set_layout("fuzz");
  geometry->set_rows(kSide);
  geometry->set_columns(kSide);
  geometry->set_row_pitch_m(0.01);
  geometry->set_column_pitch_m(0.01);
  geometry->set_taxel_area_m2(1e-4);
  geometry->set_wrap_columns(data.ConsumeBool());
  geometry->set_unit(tactus::v1::TAXEL_UNIT_NEWTON);
  geometry->set_contact_threshold(0.1);
  geometry->set_onset_threshold(0.2);
  config->set_taxel_type(data.ConsumeBool() ? tactus::v1::TAXEL_TYPE_UINT16
                                            : tactus::v1::TAXEL_TYPE_FLOAT32);
  config->set_scale(data.ConsumeBool() ? 0.001 : 0);
  config->set_with_poses(data.ConsumeBool());
  config->set_with_features(data.ConsumeBool());
  config->set_release_after_ms(data.ConsumeIntegralInRange(-1, 50));
  config->set_cadence(static_cast<tactus::v1::ResultCadence>(
      data.ConsumeIntegralInRange(0, 4)));
  config->set_result_interval_frames(data.ConsumeIntegralInRange(1, 4));
  config->set_model_parts(
      static_cast<tactus::v1::ModelParts>(data.ConsumeIntegralInRange(0, 2)));
  return request;
}

Request Frames(FuzzedDataProvider& data, uint64_t sequence) {
  Request request;
  auto* batch = request.mutable_frames();
  const auto count = data.ConsumeIntegralInRange<uint32_t>(0, 5);
  batch->set_first_sequence(sequence + data.ConsumeIntegralInRange(0, 300));
  batch->set_first_capture_time_ns(
      data.ConsumeBool() ? static_cast<int64_t>(sequence) * 10'000'000
                         : data.ConsumeIntegral<int64_t>());
  batch->set_frame_count(count);
  const size_t taxels = count * kSide * kSide;
  if (data.ConsumeBool()) {
    batch->set_taxels(
        data.ConsumeBytesAsString(taxels * (data.ConsumeBool() ? 2 : 4)));
  } else {
    auto* sparse = batch->mutable_sparse();
    size_t entries = 0;
    for (uint32_t i = 0; i < count; ++i) {
      sparse->add_counts(data.ConsumeIntegralInRange(0, kSide * kSide));
      entries += sparse->counts(static_cast<int>(i));
    }
    sparse->set_indices(data.ConsumeBytesAsString(2 * entries));
    sparse->set_values(
        data.ConsumeBytesAsString(entries * (data.ConsumeBool() ? 2 : 4)));
  }
  if (data.ConsumeBool()) {
    for (uint32_t i = 0; i < count; ++i) {
      for (int k = 0; k < 3; ++k) {
        batch->add_poses(data.ConsumeFloatingPoint<double>());
      }
      for (double q : {0.0, 0.0, 0.0, 1.0}) batch->add_poses(q);
    }
  }
  return request;
}

void CheckPosterior(const tactus::v1::Answer& posterior) {
  double sum = 0;
  for (const double p : posterior.probability()) {
    REQUIRE(p >= 0 && p <= 1);
    sum += p;
  }
  REQUIRE(std::abs(sum - 1) < 1e-6);
  for (const double l : posterior.log_likelihood()) REQUIRE(std::isfinite(l));
  REQUIRE(posterior.unknown() >= 0 && posterior.unknown() <= 1);
}

void Read(StreamSession& session) {
  while (const auto* response = session.responses().StartWrite(0)) {
    if (response->has_answer()) CheckPosterior(response->answer());
    session.responses().FinishWrite();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  static const auto* const models = new tactus::testing::TestModels();
  FuzzedDataProvider data(bytes, size);
  StreamSession session(models, {});
  if (data.ConsumeBool()) REQUIRE(session.OnRequest(Config(data)).ok());
  tactus::v1::ClassifyContactRequest parsed;
  uint64_t sequence = 1;
  while (data.remaining_bytes() > 0) {
    absl::Status status;
    switch (data.ConsumeIntegralInRange(0, 4)) {
      case 0: {
        const std::string message = data.ConsumeRandomLengthString();
        google::protobuf::io::ArrayInputStream stream(
            message.data(), static_cast<int>(message.size()));
        status = session.OnMessage(&stream, message.size(), &parsed);
        break;
      }
      case 1: {
        Request end;
        end.mutable_end_of_trial();
        status = session.OnRequest(end);
        break;
      }
      case 2:
        Read(session);
        break;
      default: {
        const Request frames = Frames(data, sequence);
        status = session.OnRequest(frames);
        sequence =
            frames.frames().first_sequence() + frames.frames().frame_count();
      }
    }
    session.EndRequest(0, 1);
    if (!status.ok()) REQUIRE(!tactus::ReasonOf(status).empty());
    if (!session.wants_request()) Read(session);
    REQUIRE(session.responses().size() <=
            2 * tactus::limits::kMaxQueuedKept +
                tactus::limits::kMaxFramesPerMessage);
  }
  session.OnHalfClose();
  Read(session);
  REQUIRE(session.state() == StreamSession::State::kDone);
  return 0;
}
