// Drives a StreamSession of any skin with messages of arbitrary bytes, with
// frame batches whose fields are arbitrary, and with several objects that press
// at once, while the reader comes and goes. Every contact's answers must be
// probability distributions, its taxels its own and those of the skin, every
// event be about a contact of its answer, every end have a reason, the queue
// stay bounded.
#include <fuzzer/FuzzedDataProvider.h>

#include <cmath>
#include <set>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "google/protobuf/io/zero_copy_stream_impl_lite.h"
#include "server/session/stream_session.h"
#include "tests/fuzz/any_skin.h"
#include "tests/server/support/test_models.h"

namespace {

using tactus::internal::server::StreamSession;
using Request = tactus::v1::ClassifyContactRequest;

#define REQUIRE(condition) \
  if (!(condition)) __builtin_trap()

bool Seldom(FuzzedDataProvider& data) {
  return data.ConsumeIntegralInRange(0, 63) == 63;
}

Request Frames(FuzzedDataProvider& data, uint64_t sequence,
               tactus::internal::fuzz::Presses& presses) {
  Request request;
  auto* batch = request.mutable_frames();
  // What ends a stream is rare, so that most streams have contacts.
  const auto count =
      Seldom(data) ? 0 : data.ConsumeIntegralInRange<uint32_t>(1, 5);
  batch->set_first_sequence(sequence +
                            (data.ConsumeIntegralInRange(0, 9) == 0
                                 ? data.ConsumeIntegralInRange(0, 300)
                                 : 0));
  batch->set_first_capture_time_ns(
      Seldom(data)
          ? data.ConsumeIntegral<int64_t>()
          : static_cast<int64_t>(batch->first_sequence()) * 10'000'000);
  batch->set_frame_count(count);
  const bool sparse = data.ConsumeBool();
  if (!Seldom(data)) {
    for (uint32_t i = 0; i < count; ++i) {
      if (data.ConsumeBool()) presses.Change(data);
      presses.AppendTo(sparse, batch);
    }
  } else if (!sparse) {
    batch->set_taxels(data.ConsumeBytesAsString(count * presses.values() *
                                                presses.value_bytes()));
  } else {
    size_t entries = 0;
    for (uint32_t i = 0; i < count; ++i) {
      const auto listed =
          data.ConsumeIntegralInRange<uint32_t>(0, presses.values());
      batch->mutable_sparse()->add_counts(listed);
      entries += listed;
    }
    batch->mutable_sparse()->set_indices(
        data.ConsumeBytesAsString(2 * entries));
    batch->mutable_sparse()->set_values(
        data.ConsumeBytesAsString(entries * presses.value_bytes()));
  }
  return request;
}

// The poses that the configuration asks for, and seldom others.
void AddPoses(FuzzedDataProvider& data, bool wanted,
              tactus::v1::FrameBatch* batch) {
  if (Seldom(data)) wanted = !wanted;
  if (!wanted) return;
  const bool any = Seldom(data);
  for (uint32_t i = 0; i < batch->frame_count(); ++i) {
    for (int k = 0; k < 3; ++k) {
      batch->add_poses(any ? data.ConsumeFloatingPoint<double>()
                           : 1e-3 * data.ConsumeIntegral<int8_t>());
    }
    for (double q : {0.0, 0.0, 0.0, 1.0}) batch->add_poses(q);
  }
}

void CheckDistribution(const google::protobuf::RepeatedField<double>& values) {
  double sum = 0;
  for (const double p : values) {
    REQUIRE(p >= 0 && p <= 1);
    sum += p;
  }
  REQUIRE(std::abs(sum - 1) < 1e-6);
}

using tactus::v1::StreamConfig;

// Its taxels rise, and no other contact has them.
void CheckPatch(const tactus::v1::ContactPatch& patch,
                const StreamConfig& config, std::set<uint32_t>& taken) {
  REQUIRE(patch.force() >= 0 && patch.max_force() >= 0);
  REQUIRE(patch.area_taxels() > 0);
  const auto& geometry = config.geometry();
  REQUIRE(patch.centroid_row() >= 0 &&
          patch.centroid_row() <= geometry.rows() - 1);
  REQUIRE(patch.centroid_column() >= 0 &&
          patch.centroid_column() < geometry.columns());
  if (!config.with_taxels()) {
    REQUIRE(patch.taxels().empty());
    return;
  }
  REQUIRE(patch.area_taxels() == static_cast<uint32_t>(patch.taxels_size()));
  uint32_t next = 0;
  for (const uint32_t taxel : patch.taxels()) {
    REQUIRE(taxel >= next && taxel < geometry.rows() * geometry.columns());
    REQUIRE(taken.insert(taxel).second);
    next = taxel + 1;
  }
  for (const uint32_t masked : geometry.masked_taxels()) {
    REQUIRE(taken.count(masked) == 0);
  }
}

void CheckContact(const tactus::v1::Contact& contact) {
  CheckDistribution(contact.probability());
  REQUIRE(contact.answers_size() == 2);
  for (const auto& question : contact.answers()) {
    CheckDistribution(question.probability());
  }
  REQUIRE(contact.unknown() >= 0 && contact.unknown() <= 1);
  REQUIRE(contact.has_patch() ==
          (contact.state() == tactus::v1::Contact::STATE_TOUCHING));
  // One that ends may have joined its parent.
  REQUIRE((contact.state() == tactus::v1::Contact::STATE_MERGED) <=
          (contact.merged_into() != 0));
  REQUIRE(contact.merged_into() != contact.id());
  REQUIRE(contact.parent_id() < contact.id());
}

void CheckAnswer(const tactus::v1::Answer& answer, const StreamConfig& config) {
  int going_on = 0;
  std::set<uint64_t> ids;
  std::set<uint32_t> taken;
  for (const tactus::v1::Contact& contact : answer.contacts()) {
    REQUIRE(contact.id() > 0 && ids.insert(contact.id()).second);
    CheckContact(contact);
    REQUIRE(contact.onset_sequence() <= answer.sequence());
    going_on += contact.state() != tactus::v1::Contact::STATE_RELEASED;
    if (contact.has_patch()) CheckPatch(contact.patch(), config, taken);
  }
  REQUIRE(going_on <= (config.has_max_contacts()
                           ? static_cast<int>(config.max_contacts())
                           : tactus::internal::limits::kMaxContacts));
  for (const tactus::v1::ContactEvent& event : answer.events()) {
    REQUIRE(ids.count(event.contact_id()) == 1);
  }
  if (config.cadence() == tactus::v1::RESULT_CADENCE_EVENTS) {
    REQUIRE(answer.is_final() || answer.events_size() > 0);
  }
  REQUIRE(answer.diagnostics().contacts_size() ==
          (config.with_diagnostics() ? answer.contacts_size() : 0));
  for (const auto& scores : answer.diagnostics().contacts()) {
    for (const double l : scores.log_likelihood()) REQUIRE(std::isfinite(l));
  }
}

void Read(StreamSession& session, const StreamConfig& config) {
  while (const auto* response = session.responses().StartWrite(0)) {
    if (response->has_answer()) CheckAnswer(response->answer(), config);
    session.responses().FinishWrite();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  static const auto* const models = new tactus::internal::testing::TestModels();
  FuzzedDataProvider data(bytes, size);
  StreamSession session(models, {});
  Request first;
  *first.mutable_config() = tactus::internal::fuzz::AnyConfig(data);
  const StreamConfig& config = first.config();
  tactus::internal::fuzz::Presses presses(config);
  if (!Seldom(data)) {
    const absl::Status status = session.OnRequest(first);
    REQUIRE(status.ok() || !tactus::internal::ReasonOf(status).empty());
  }
  tactus::v1::ClassifyContactRequest parsed;
  uint64_t sequence = 1;
  while (data.remaining_bytes() > 0) {
    absl::Status status;
    switch (data.ConsumeIntegralInRange(0, 47)) {
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
      case 3:
      case 4:
      case 5:
      case 6:
        Read(session, config);
        break;
      default: {
        Request frames = Frames(data, sequence, presses);
        AddPoses(data, config.with_poses(), frames.mutable_frames());
        status = session.OnRequest(frames);
        sequence =
            frames.frames().first_sequence() + frames.frames().frame_count();
      }
    }
    session.EndRequest(0, 1);
    if (!status.ok()) REQUIRE(!tactus::internal::ReasonOf(status).empty());
    if (!session.wants_request()) Read(session, config);
    REQUIRE(session.responses().size() <=
            2 * tactus::internal::limits::kMaxQueuedKept +
                tactus::internal::limits::kMaxFramesPerMessage);
  }
  session.OnHalfClose();
  Read(session, config);
  REQUIRE(session.state() == StreamSession::State::kDone);
  return 0;
}
