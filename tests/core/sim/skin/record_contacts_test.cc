#include "core/sim/skin/record_contacts.h"

#include <numeric>

#include "gtest/gtest.h"
#include "tests/core/sim/skin/ideal_skin.h"
#include "tests/support/find_material.h"

namespace tactus::internal {
namespace {

using testing::IdealSkin;

SimulatedContact SteadyContact(double force, size_t samples) {
  SimulatedContact contact;
  contact.spec.object = {*FindMaterial("steel"), 0.04, Surface::kWood};
  contact.signals.samples.assign(samples, {force, 0.0016, 0.003});
  contact.signals.object_motion.assign(samples, 0);
  return contact;
}

std::vector<double> Frame(const Trial& trial, size_t frame) {
  std::vector<float> taxels(384);
  trial.taxels.Decode(frame, taxels.data());
  return {taxels.begin(), taxels.end()};
}

LinkMotion AtRest(size_t frames) {
  LinkMotion motion;
  motion.steps.resize(frames);
  return motion;
}

TEST(RecordContactsTest, LoadsOfTwoObjectsAdd) {
  const SimulatedContact a = SteadyContact(2, 20);
  const SimulatedContact b = SteadyContact(0.5, 20);
  // Their faces overlap, across the seam.
  const PlacedContact both[] = {{.contact = &a,
                                 .centre = {.row = 7.5, .column = 23.5},
                                 .begin_frame = 10,
                                 .end_sample = 20},
                                {.contact = &b,
                                 .centre = {.row = 8.5, .column = 0.5},
                                 .begin_frame = 20,
                                 .end_sample = 20}};
  const auto record = [&](std::span<const PlacedContact> contacts) {
    Random random(1);
    return RecordContacts(Trial(), contacts, IdealSkin(), AtRest(50), random);
  };
  const Trial together = record(both);
  const Trial only_a = record({&both[0], 1});
  const Trial only_b = record({&both[1], 1});
  int shared = 0;
  for (size_t t = 0; t < 50; ++t) {
    const std::vector<double> sum = Frame(together, t);
    const std::vector<double> one = Frame(only_a, t);
    const std::vector<double> other = Frame(only_b, t);
    for (size_t i = 0; i < sum.size(); ++i) {
      // Readings are floats of up to 2 N.
      ASSERT_NEAR(sum[i], one[i] + other[i], 1e-6) << t << " taxel " << i;
      shared += one[i] > 0 && other[i] > 0;
    }
    const double load = (t >= 10 && t < 30 ? 2 : 0) + (t >= 20 && t < 40) * 0.5;
    EXPECT_NEAR(std::accumulate(sum.begin(), sum.end(), 0.0), load, 1e-5) << t;
  }
  EXPECT_GT(shared, 20);
}

TEST(RecordContactsTest, OnlyTheGivenSamplesPress) {
  const SimulatedContact a = SteadyContact(1, 20);
  const PlacedContact placed = {.contact = &a,
                                .centre = {.row = 7.5, .column = 4},
                                .begin_frame = 5,
                                .begin_sample = 3,
                                .end_sample = 12};
  Random random(1);
  const Trial trial =
      RecordContacts(Trial(), {&placed, 1}, IdealSkin(), AtRest(30), random);
  ASSERT_EQ(trial.time.size(), 30);
  for (size_t t = 0; t < 30; ++t) {
    const std::vector<double> taxels = Frame(trial, t);
    EXPECT_NEAR(std::accumulate(taxels.begin(), taxels.end(), 0.0),
                t >= 8 && t < 17 ? 1 : 0, 1e-5)
        << t;
  }
}

}  // namespace
}  // namespace tactus::internal
