#include "server/contact_log/logged_trial.h"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/contacts/labelled_contact.h"
#include "core/contacts/touch_contacts.h"
#include "core/data/trial_record.h"
#include "core/skin/layout_proto.h"
#include "core/stream/frame_decoder.h"
#include "gtest/gtest.h"
#include "tests/server/contact_log/pressed_stream.h"
#include "tests/server/contact_log/random_streams.h"

namespace tactus::internal::server {
namespace {

v1::ContactLabel LabelOf(const std::string& label) {
  v1::ContactLabel out;
  out.set_label(label);
  out.set_object("object of " + label);
  out.set_condition("condition of " + label);
  out.set_material("material of " + label);
  return out;
}

// What a stream sent, as the stream itself decodes it.
struct SentFrame {
  std::vector<float> taxels;
  int64_t time_ns = 0;
  std::vector<double> pose;
};

std::map<uint64_t, SentFrame> SentFrames(const RandomStream& stream) {
  FrameDecoder decoder(*ParseStreamConfig(stream.config));
  std::map<uint64_t, SentFrame> sent;
  for (const RandomStream::Step& step : stream.steps) {
    if (step.end_of_trial) continue;
    const v1::FrameBatch& batch = step.batch;
    EXPECT_TRUE(decoder.Check(batch).ok());
    for (uint32_t i = 0; i < batch.frame_count(); ++i) {
      SentFrame& frame = sent[batch.first_sequence() + i];
      const auto taxels = decoder.Frame(batch, i).taxels;
      frame.taxels.assign(taxels.begin(), taxels.end());
      frame.time_ns = decoder.CaptureTime(batch, i);
      if (batch.poses().empty()) continue;
      const auto pose = batch.poses().begin() + i * 7;
      frame.pose.assign(pose, pose + 7);
    }
    decoder.Accept(batch);
  }
  return sent;
}

void ExpectFrames(const KeptRecordings::Kept& kept, const Trial& trial,
                  const std::map<uint64_t, SentFrame>& sent) {
  size_t at = 0;
  int64_t start_ns = 0;
  for (const v1::FrameBatch& batch : kept.recording.frames()) {
    for (uint32_t i = 0; i < batch.frame_count(); ++i, ++at) {
      const SentFrame& frame = sent.at(batch.first_sequence() + i);
      if (at == 0) start_ns = frame.time_ns;
      ASSERT_LT(at, trial.time.size());
      EXPECT_EQ(trial.time[at], (frame.time_ns - start_ns) / 1e9);
      std::vector<float> taxels(trial.taxels.frame_size());
      trial.taxels.Decode(at, taxels.data());
      ASSERT_TRUE(taxels == frame.taxels) << "frame " << at;
      ASSERT_EQ(trial.poses.empty(), frame.pose.empty());
      if (frame.pose.empty()) continue;
      const Pose& pose = trial.poses[at];
      for (int k = 0; k < 3; ++k) EXPECT_EQ(pose.position[k], frame.pose[k]);
      EXPECT_EQ(pose.orientation.x(), frame.pose[3]);
      EXPECT_EQ(pose.orientation.w(), frame.pose[6]);
    }
  }
  EXPECT_EQ(trial.time.size(), at);
  EXPECT_EQ(trial.taxels.frames(), at);
}

TEST(LoggedTrialTest, HasTheFramesOfTheStream) {
  using enum v1::TaxelType;
  const StreamKind kinds[] = {
      {.name = "u16", .loss = 0.05},
      {.name = "f32", .type = TAXEL_TYPE_FLOAT32, .batch = 64},
      {.name = "sparse u16", .sparse = true, .batch = 64, .loss = 0.05},
      {.name = "sparse f32", .type = TAXEL_TYPE_FLOAT32, .sparse = true},
      {.name = "i16", .type = TAXEL_TYPE_INT16, .poses = true},
      {.name = "axes", .type = TAXEL_TYPE_INT16, .axes = 3},
      {.name = "sparse axes",
       .type = TAXEL_TYPE_INT16,
       .sparse = true,
       .axes = 3,
       .poses = true,
       .rate_hz = 130},
      {.name = "light", .light = true, .poses = true}};
  for (const StreamKind& kind : kinds) {
    for (uint64_t seed = 1; seed <= 2; ++seed) {
      SCOPED_TRACE(kind.name + ", seed " + std::to_string(seed));
      RandomStream stream = MakeStream(kind, seed);
      if (kind.type == TAXEL_TYPE_FLOAT32) stream.config.set_scale(0.7);
      RecordedStreamRig rig(stream.config, SmallPinned(kind.rate_hz));
      RunStream(stream, rig);
      const auto sent = SentFrames(stream);
      ASSERT_GT(rig.sink().kept.size(), 1u);
      for (const KeptRecordings::Kept& kept : rig.sink().kept) {
        const auto record = TrialOf(kept.stored, {{0, LabelOf("first")}});
        ASSERT_TRUE(record.ok()) << record.status();
        const auto trial = FromRecord(*record);
        ASSERT_TRUE(trial.ok()) << trial.status();
        EXPECT_EQ(trial->label, "first");
        EXPECT_EQ(trial->sample_rate_hz, kind.rate_hz);
        ASSERT_TRUE(trial->skin.has_value());
        EXPECT_EQ(*trial->skin, random_stream::Skin(kind));
        EXPECT_EQ(trial->taxels.type(), kind.type);
        ExpectFrames(kept, *trial, sent);
      }
    }
  }
}

TEST(LoggedTrialTest, OneContactIsATrialThatTrainingFinds) {
  PressedStream stream;
  stream.Quiet(20);
  stream.Press(30);
  stream.QuietUntil(1);
  v1::StoredContacts stored = stream.kept()[0].stored;
  stored.mutable_contacts(0)->set_name("contacts/17");
  const auto record = TrialOf(stored, {{0, LabelOf("HU")}});
  ASSERT_TRUE(record.ok()) << record.status();
  EXPECT_EQ(record->id(), "contacts_17");
  EXPECT_EQ(record->source(), "contacts/17 of arm");
  EXPECT_EQ(record->object(), "object of HU");
  EXPECT_EQ(record->condition(), "condition of HU");
  EXPECT_EQ(record->material(), "material of HU");
  EXPECT_EQ(record->touches_size(), 0);
  const auto contact = ExtractContact(*FromRecord(*record));
  ASSERT_TRUE(contact.ok()) << contact.status();
  ASSERT_TRUE(contact->has_value());
  EXPECT_EQ((*contact)->label, "HU");
  // From the onset to the end of the trial.
  ASSERT_EQ((*contact)->frames.size(), stream.next - 1 - 20);
  for (size_t t = 0; t < (*contact)->frames.size(); ++t) {
    EXPECT_EQ((*contact)->frames.touched(t), t < 30);
    EXPECT_EQ((*contact)->frames.net_force(t), t < 30 ? 6 : 0);
  }
}

TEST(LoggedTrialTest, SeveralContactsAreTouchesThatTrainingFinds) {
  PressedStream stream;
  stream.Quiet(10);
  stream.Press(30);
  stream.Same(40, Both(PressedAt(5, 7), PressedAt(12, 17)));
  stream.Same(40, PressedAt(12, 17));
  stream.QuietUntil(1);
  const v1::StoredContacts& stored = stream.kept()[0].stored;
  ASSERT_EQ(stored.contacts_size(), 2);
  const auto record = TrialOf(stored, {{0, LabelOf("HU")}, {1, LabelOf("SM")}});
  ASSERT_TRUE(record.ok()) << record.status();
  EXPECT_EQ(record->label(), "HU");
  ASSERT_EQ(record->touches_size(), 2);
  const v1::Touch& first = record->touches(0);
  EXPECT_EQ(first.label(), "HU");
  EXPECT_EQ(first.object(), "object of HU");
  EXPECT_EQ(first.material(), "material of HU");
  EXPECT_NEAR(first.begin_s(), 0.10, 1e-9);
  EXPECT_NEAR(first.end_s(), 0.80 + 0.24, 1e-9);
  EXPECT_EQ(first.row(), 5);
  EXPECT_EQ(first.column(), 8);
  const v1::Touch& second = record->touches(1);
  EXPECT_EQ(second.label(), "SM");
  // It is felt for two frames before it is a contact.
  EXPECT_NEAR(second.begin_s(), 0.41, 1e-9);
  EXPECT_NEAR(second.end_s(), 1.20 + 0.24, 1e-9);
  EXPECT_EQ(second.row(), 12);
  EXPECT_EQ(second.column(), 18);
  const auto found = ExtractContacts(*FromRecord(*record), {.max_contacts = 8});
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_EQ(found->counts.touches, 2u);
  EXPECT_EQ(found->counts.found, 2u);
  EXPECT_EQ(found->counts.spurious, 0u);
  ASSERT_EQ(found->contacts.size(), 2u);
  EXPECT_EQ(found->contacts[0].label, "HU");
  EXPECT_EQ(found->contacts[1].label, "SM");
  // With one label, the other contact is not mentioned.
  const auto one = TrialOf(stored, {{1, LabelOf("SM")}});
  ASSERT_TRUE(one.ok()) << one.status();
  ASSERT_EQ(one->touches_size(), 1);
  EXPECT_EQ(one->touches(0).label(), "SM");
  EXPECT_EQ(one->label(), "SM");
}

// A robot may name taxels that nobody is to look at, because they are broken.
TEST(LoggedTrialTest, MaskedTaxelsMayHoldAnything) {
  for (const bool is_sparse : {false, true}) {
    v1::StreamConfig config = PressedConfig();
    config.set_taxel_type(v1::TAXEL_TYPE_FLOAT32);
    config.clear_scale();
    config.mutable_geometry()->add_masked_taxels(300);
    RecordedStreamRig rig(config);
    for (int t = 0; t < 40; ++t) {
      testing::Counts counts = t < 10 ? testing::Untouched() : PressedAt(5, 7);
      counts[300] = 1;
      auto request = is_sparse ? testing::SparseF32(t + 1, {counts})
                               : testing::DenseF32(t + 1, {counts});
      std::string& values =
          is_sparse
              ? *request.mutable_frames()->mutable_sparse()->mutable_values()
              : *request.mutable_frames()->mutable_taxels();
      const size_t place = is_sparse ? values.size() / sizeof(float) - 1 : 300;
      const float broken[] = {std::numeric_limits<float>::quiet_NaN(), -3,
                              1e30F};
      std::memcpy(values.data() + place * sizeof(float), &broken[t % 3],
                  sizeof(float));
      rig.Send(request.frames());
    }
    rig.EndStream();
    ASSERT_EQ(rig.sink().kept.size(), 1u);
    const auto record =
        TrialOf(rig.sink().kept[0].stored, {{0, LabelOf("HU")}});
    ASSERT_TRUE(record.ok()) << record.status();
    const auto contact = ExtractContact(*FromRecord(*record));
    ASSERT_TRUE(contact.ok()) << contact.status();
    EXPECT_EQ((*contact)->frames.size(), 30u);
  }
}

int64_t PeakBytes() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return int64_t{usage.ru_maxrss} * 1024;
}

// A touch that only the end of the trial ends, and `messages` messages of 64
// frames without a value.
KeptRecordings::Kept LongSparse(v1::StreamConfig config, int messages) {
  config.set_never_release(true);
  config.set_cadence(v1::RESULT_CADENCE_EVENTS);
  RecordedStreamRig rig(config);
  testing::Counts touch(testing::kCodyTaxels);
  touch[2] = 2000;
  rig.Send(testing::SparseU16(1, {touch}).frames());
  v1::FrameBatch batch;
  batch.set_frame_count(64);
  for (int i = 0; i < 64; ++i) batch.mutable_sparse()->add_counts(0);
  for (int i = 0; i < messages; ++i) {
    batch.set_first_sequence(2 + 64 * i);
    batch.set_first_capture_time_ns((2 + 64 * i) * int64_t{10'000'000});
    rig.Send(batch);
  }
  rig.EndStream();
  EXPECT_EQ(rig.sink().kept.size(), 1u);
  return rig.sink().kept.at(0);
}

TEST(LoggedTrialTest, TooManySparseFramesAreRefusedWithoutMemory) {
  v1::StreamConfig large = PressedConfig();
  // A skin of six taxels, whose frames cost more than their taxels.
  v1::StreamConfig small = PressedConfig();
  SkinLayout layout = *LayoutPreset("cody-forearm");
  layout.name = "pad";
  layout.rows = 2;
  layout.columns = 3;
  layout.wrap_columns = false;
  *small.mutable_geometry() = LayoutToProto(layout);
  for (const auto& [config, messages] :
       {std::pair(large, 2000), std::pair(small, 8000)}) {
    const KeptRecordings::Kept kept = LongSparse(config, messages);
    EXPECT_FALSE(kept.cut);
    const int64_t before = PeakBytes();
    const auto record = TrialOf(kept.stored, {{0, LabelOf("HU")}});
    EXPECT_EQ(ReasonOf(record.status()), "INVALID_TRIAL");
    constexpr int64_t kLittle = int64_t{32} << 20;
    EXPECT_LT(PeakBytes() - before, kLittle);
  }
  // As many as fit are fine.
  EXPECT_TRUE(
      TrialOf(LongSparse(large, 600).stored, {{0, LabelOf("HU")}}).ok());
}

// The frames of the second contact are not kept.
TEST(LoggedTrialTest, AContactWithoutFramesIsRefused) {
  PressedStream stream;
  stream.Press(3000);
  stream.Same(100, Both(PressedAt(5, 7), PressedAt(12, 17)));
  stream.QuietUntil(1);
  const auto& kept = stream.kept()[0];
  ASSERT_TRUE(kept.cut);
  ASSERT_EQ(kept.stored.contacts_size(), 2);
  EXPECT_TRUE(TrialOf(kept.stored, {{0, LabelOf("HU")}}).ok());
  EXPECT_EQ(ReasonOf(TrialOf(kept.stored, {{1, LabelOf("SM")}}).status()),
            "INVALID_TRIAL");
}

}  // namespace
}  // namespace tactus::internal::server
