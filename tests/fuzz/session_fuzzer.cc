// Drives a StreamSession with messages of arbitrary bytes and with frame
// batches whose fields are arbitrary, while the reader comes and goes. Every
// contact's answers must be probability distributions, every event be about a
// contact of its answer, every end have a reason, the queue stay bounded.
#include <fuzzer/FuzzedDataProvider.h>

#include <cmath>
#include <cstring>
#include <set>

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

// A small skin, so that few bytes make a frame, with room for two contacts.
constexpr int kRows = 2;
constexpr int kColumns = 9;

Request Config(FuzzedDataProvider& data) {
  Request request;
  auto* config = request.mutable_config();
  auto* geometry = config->mutable_geometry();
  geometry->set_layout("fuzz");
  geometry->set_rows(kRows);
  geometry->set_columns(kColumns);
  geometry->set_row_pitch_m(0.01);
  geometry->set_column_pitch_m(0.01);
  geometry->set_taxel_area_m2(1e-4);
  geometry->set_wrap_columns(data.ConsumeBool());
  geometry->set_unit(tactus::v1::TAXEL_UNIT_NEWTON);
  geometry->set_contact_threshold(0.1);
  geometry->set_onset_threshold(0.2);
  config->set_taxel_type(data.ConsumeBool() ? tactus::v1::TAXEL_TYPE_UINT16
                                            : tactus::v1::TAXEL_TYPE_FLOAT32);
  if (data.ConsumeBool()) config->set_scale(0.001);
  config->set_with_poses(data.ConsumeBool());
  config->set_with_taxels(data.ConsumeBool());
  config->set_with_diagnostics(data.ConsumeBool());
  config->set_never_release(data.ConsumeBool());
  if (!config->never_release()) {
    config->set_release_after_ms(data.ConsumeIntegralInRange(1, 50));
  }
  if (data.ConsumeBool()) {
    config->set_max_contacts(data.ConsumeIntegralInRange(1, 8));
  }
  config->set_cadence(static_cast<tactus::v1::ResultCadence>(
      data.ConsumeIntegralInRange(0, 4)));
  config->set_result_interval_frames(data.ConsumeIntegralInRange(1, 4));
  config->set_effort(
      static_cast<tactus::v1::Effort>(data.ConsumeIntegralInRange(0, 2)));
  return request;
}

// Frames with a load on some columns, which stays for several frames: any
// bytes seldom make two contacts.
std::string Presses(FuzzedDataProvider& data, uint32_t frames) {
  std::string taxels;
  uint32_t columns = 0;
  for (uint32_t i = 0; i < frames; ++i) {
    if (i == 0 || data.ConsumeIntegralInRange(0, 7) == 0) {
      columns = data.ConsumeIntegral<uint16_t>();
    }
    for (int taxel = 0; taxel < kRows * kColumns; ++taxel) {
      const uint16_t load = (columns >> taxel % kColumns & 1) * 2'000;
      taxels.append(reinterpret_cast<const char*>(&load), sizeof(load));
    }
  }
  return taxels;
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
  const size_t taxels = count * kRows * kColumns;
  if (data.ConsumeBool()) {
    batch->set_taxels(Presses(data, count));
  } else if (data.ConsumeBool()) {
    batch->set_taxels(
        data.ConsumeBytesAsString(taxels * (data.ConsumeBool() ? 2 : 4)));
  } else {
    auto* sparse = batch->mutable_sparse();
    size_t entries = 0;
    for (uint32_t i = 0; i < count; ++i) {
      sparse->add_counts(data.ConsumeIntegralInRange(0, kRows * kColumns));
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

void CheckDistribution(const google::protobuf::RepeatedField<double>& values) {
  double sum = 0;
  for (const double p : values) {
    REQUIRE(p >= 0 && p <= 1);
    sum += p;
  }
  REQUIRE(std::abs(sum - 1) < 1e-6);
}

void CheckAnswer(const tactus::v1::Answer& answer) {
  REQUIRE(answer.contacts_size() <= tactus::limits::kMaxContacts);
  std::set<uint64_t> ids;
  for (const tactus::v1::Contact& contact : answer.contacts()) {
    REQUIRE(contact.id() > 0 && ids.insert(contact.id()).second);
    CheckDistribution(contact.probability());
    REQUIRE(contact.answers_size() == 2);
    for (const auto& question : contact.answers()) {
      CheckDistribution(question.probability());
    }
    REQUIRE(contact.unknown() >= 0 && contact.unknown() <= 1);
    REQUIRE(contact.onset_sequence() <= answer.sequence());
    REQUIRE(contact.has_patch() ==
            (contact.state() == tactus::v1::Contact::STATE_TOUCHING));
  }
  for (const tactus::v1::ContactEvent& event : answer.events()) {
    REQUIRE(ids.count(event.contact_id()) == 1);
  }
  for (const auto& scores : answer.diagnostics().contacts()) {
    for (const double l : scores.log_likelihood()) REQUIRE(std::isfinite(l));
  }
}

void Read(StreamSession& session) {
  while (const auto* response = session.responses().StartWrite(0)) {
    if (response->has_answer()) CheckAnswer(response->answer());
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
