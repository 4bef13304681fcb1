#include "server/contact_log/contact_replay.h"

#include <algorithm>
#include <iostream>
#include <string>
#include <vector>

#include "core/cues/cue.h"
#include "gtest/gtest.h"
#include "tests/server/contact_log/random_streams.h"
#include "tests/server/contact_log/recorded_streams.h"

namespace tactus::internal::server {
namespace {

constexpr auto kU16 = v1::TAXEL_TYPE_UINT16;
constexpr auto kF32 = v1::TAXEL_TYPE_FLOAT32;
constexpr auto kI16 = v1::TAXEL_TYPE_INT16;

const std::vector<StreamKind>& Kinds() {
  static const std::vector<StreamKind> kinds = {
      {.name = "u16"},
      {.name = "u16 one by one", .batch = 1},
      {.name = "u16 64", .batch = 64, .same_batches = true},
      {.name = "f32", .type = kF32, .batch = 1, .loss = 0.05},
      {.name = "sparse u16", .sparse = true, .loss = 0.05},
      {.name = "sparse 64",
       .sparse = true,
       .batch = 64,
       .same_batches = true,
       .loss = 0.02},
      {.name = "sparse f32", .type = kF32, .sparse = true, .batch = 1},
      {.name = "three axes", .type = kI16, .axes = 3, .batch = 4},
      {.name = "three axes, poses, sparse",
       .type = kI16,
       .sparse = true,
       .axes = 3,
       .poses = true},
      {.name = "light", .light = true},
      {.name = "light, poses, losses",
       .light = true,
       .poses = true,
       .loss = 0.05},
      {.name = "poses", .poses = true},
      {.name = "poses one by one", .sparse = true, .poses = true, .batch = 1},
      {.name = "poses, losses", .sparse = true, .poses = true, .loss = 0.1},
      {.name = "poses at 200 Hz",
       .sparse = true,
       .poses = true,
       .rate_hz = 200,
       .batch = 5,
       .frames = 3000},
      {.name = "poses at 200 Hz one by one",
       .sparse = true,
       .poses = true,
       .rate_hz = 200,
       .batch = 1,
       .loss = 0.01,
       .frames = 3000},
      {.name = "dense poses at 200 Hz",
       .poses = true,
       .rate_hz = 200,
       .batch = 1,
       .frames = 3000},
      {.name = "poses at 1000 Hz",
       .sparse = true,
       .poses = true,
       .rate_hz = 1000,
       .batch = 7,
       .frames = 15'000},
  };
  return kinds;
}

// A third of the cues that need no embedding.
Model ManyCues(double rate_hz, int third) {
  Model model = testing::SmallModel();
  model.inputs.sample_rate_hz = rate_hz;
  model.inputs.hmm.clear();
  for (int i = third; i < CueCount(); i += 3) {
    const auto cue = static_cast<Cue>(i);
    if ((SourcesOf(cue) & kFromEmbedding) != 0) continue;
    model.inputs.hmm.push_back({.cue = cue, .limit = 10});
  }
  const auto count = model.inputs.hmm.size();
  for (size_t k = 0; k < model.hmms.size(); ++k) {
    GaussianHmm& hmm = model.hmms[k].components[0];
    hmm.dimensions = static_cast<int>(count);
    hmm.means.assign(2 * count, static_cast<double>(k));
    hmm.covariances.assign(2 * count, 1e3);
  }
  return model;
}

v1::ReplayContactResponse Replayed(const v1::StoredContacts& stored,
                                   const PinnedModel& model,
                                   uint32_t place = 0) {
  const auto response = ReplayContact(stored, place, model,
                                      {.max_frames = 10, .with_taxels = false});
  EXPECT_TRUE(response.ok()) << response.status();
  return response.value_or(v1::ReplayContactResponse());
}

struct ReplayCounts {
  int exact = 0;
  int later = 0;
  int others = 0;
  int others_same = 0;
};

// All recordings of a stream that are marked exact give the same answers again.
void ExpectExactIsExact(const StreamKind& kind, const PinnedModel& model,
                        uint64_t seed, ReplayCounts& counts) {
  SCOPED_TRACE(kind.name + ", seed " + std::to_string(seed));
  const RandomStream stream = MakeStream(kind, seed);
  RecordedStreamRig rig(stream.config, model);
  RunStream(stream, rig);
  ASSERT_FALSE(::testing::Test::HasFatalFailure());
  rig.Drop();
  EXPECT_EQ(rig.sink().left_out, 0);
  EXPECT_EQ(rig.taken_chunks(), 0u);
  for (const KeptRecordings::Kept& kept : rig.sink().kept) {
    const auto response = Replayed(kept.stored, model);
    if (!kept.exact) {
      ++counts.others;
      counts.others_same += response.same_answers() ? 1 : 0;
      continue;
    }
    ++counts.exact;
    counts.later += kept.stored.contacts(0).contact_id() > 1 ? 1 : 0;
    EXPECT_TRUE(response.same_answers())
        << kept.stored.contacts_size() << " contacts, the first "
        << kept.stored.contacts(0).ShortDebugString();
    for (int i = 0; i < kept.stored.contacts_size(); ++i) {
      EXPECT_EQ(Replayed(kept.stored, model, i).contact_id(), i + 1);
    }
  }
}

TEST(ContactReplayTest, WhatIsMarkedExactGivesTheSameAnswers) {
  constexpr uint64_t kSeeds = 3;
  for (const StreamKind& kind : Kinds()) {
    const PinnedModel model = SmallPinned(kind.rate_hz);
    ReplayCounts counts;
    for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
      ExpectExactIsExact(kind, model, seed, counts);
    }
    std::cout << kind.name << ": " << counts.exact << " exact, " << counts.later
              << " of them not the first, " << counts.others << " others, of "
              << "which " << counts.others_same << " replay the same\n";
    EXPECT_GT(counts.exact, 0) << kind.name;
  }
}

// Whatever a model remembers of a contact, it forgets at the next.
TEST(ContactReplayTest, ModelsRememberNothingOfContactsBefore) {
  constexpr uint64_t kSeeds = 1;
  for (const StreamKind& kind : Kinds()) {
    Model with_networks = testing::SmallModel();
    with_networks.inputs.sample_rate_hz = kind.rate_hz;
    testing::AddLstms(1, with_networks);
    for (const Model& model :
         {ManyCues(kind.rate_hz, 0), ManyCues(kind.rate_hz, 1),
          ManyCues(kind.rate_hz, 2), with_networks}) {
      const PinnedModel pinned = Pinned(model);
      ReplayCounts counts;
      for (uint64_t seed = 101; seed <= 100 + kSeeds; ++seed) {
        ExpectExactIsExact(kind, pinned, seed, counts);
      }
      EXPECT_GT(counts.later, 0) << kind.name;
    }
  }
}

}  // namespace
}  // namespace tactus::internal::server
