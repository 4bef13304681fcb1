#include "tools/trainctl/data/simulate_one.h"

#include <fstream>
#include <sstream>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_split.h"
#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "tests/reference/sim/cvode.h"

namespace tactus::internal::client {
namespace {

constexpr char kScene[] =
    R"({"k_act": 2050, "v": 0.02, "goal": 0.01, "m_obj": 0.2, "k_obj": 5000,
        "mu_s": 0.5, "mu_k": 0.4, "duration": 0.5})";

TEST(ParseSceneTest, KeysAndDefaults) {
  const auto scene = ParseScene(kScene);
  ASSERT_TRUE(scene.ok()) << scene.status();
  EXPECT_EQ(scene->actuator_stiffness, 2050);
  EXPECT_EQ(scene->velocity_m_s, 0.02);
  EXPECT_EQ(scene->goal_m, 0.01);
  EXPECT_EQ(scene->object_mass_kg, 0.2);
  EXPECT_EQ(scene->object_stiffness, 5000);
  EXPECT_EQ(scene->mu_static, 0.5);
  EXPECT_EQ(scene->mu_kinetic, 0.4);
  EXPECT_EQ(scene->duration_s, 0.5);
  EXPECT_EQ(scene->arm_mass_kg, kCodyArmMass);
  EXPECT_FALSE(scene->fixed);
  EXPECT_EQ(scene->actuator_damping, CriticalDamping(2050, kCodyArmMass));
  EXPECT_GT(scene->retreat_after_s, 1e300);
  const auto other = ParseScene(
      R"({"m_arm": 2, "b_act": 0, "fixed": true, "m_obj": 1, "k_obj": 1e4,
          "mu_s": 0.5, "mu_k": 0.5, "retreat_after": 1.5,
          "retreat_speed": 0.03})");
  ASSERT_TRUE(other.ok()) << other.status();
  EXPECT_EQ(other->arm_mass_kg, 2);
  EXPECT_EQ(other->actuator_damping, 0);
  EXPECT_TRUE(other->fixed);
  EXPECT_EQ(other->retreat_after_s, 1.5);
  EXPECT_EQ(other->retreat_speed_m_s, 0.03);
}

TEST(ParseSceneTest, WhatIsWrongIsNamed) {
  const struct {
    const char* json;
    const char* field;
  } cases[] = {
      {"", "--one"},
      {"[1]", "--one"},
      {"{", "--one"},
      {R"({"mass": 1})", "key"},
      {R"({"m_obj": "heavy"})", "m_obj"},
      {R"({"fixed": 1})", "fixed"},
      {"{}", "scene.object_mass_kg"},
      {R"({"k_act": -1})", "scene.actuator_stiffness"},
      {R"({"v": 1e300})", "scene.velocity_m_s"},
  };
  for (const auto& c : cases) {
    const auto scene = ParseScene(c.json);
    EXPECT_EQ(ReasonOf(scene.status()), "INVALID_SCENE") << c.json;
    if (!scene.ok()) {
      EXPECT_EQ(InfoOf(scene.status()).metadata().at("field"), c.field);
    }
  }
}

std::vector<std::vector<double>> TableRows(const std::string& text) {
  std::vector<std::vector<double>> rows;
  for (absl::string_view line : absl::StrSplit(text, '\n', absl::SkipEmpty())) {
    if (rows.empty()) {
      EXPECT_EQ(line, "t,x_arm,v_arm,x_uobj,v_uobj,F_surf");
    }
    std::vector<double> row;
    for (absl::string_view cell : absl::StrSplit(line, ',')) {
      double value = 0;
      const bool number = absl::SimpleAtod(cell, &value);
      EXPECT_TRUE(number || rows.empty()) << cell;
      row.push_back(value);
    }
    rows.push_back(row);
  }
  return rows;
}

TEST(SimulateOneTest, PrintsTheContactOfCvode) {
  OneContactFlags flags;
  const std::string path = ::testing::TempDir() + "/simulate_one_test.json";
  std::ofstream(path) << kScene;
  flags.scene = "@" + path;
  flags.rate_hz = 1000;
  flags.csv = true;
  std::ostringstream exact;
  ASSERT_TRUE(SimulateOne(flags, exact).ok());
  flags.scene = kScene;
  std::ostringstream inline_scene;
  ASSERT_TRUE(SimulateOne(flags, inline_scene).ok());
  EXPECT_EQ(exact.str(), inline_scene.str());
  const auto a = TableRows(exact.str());
  ASSERT_EQ(a.size(), 502);
  SolverOptions options;
  options.sample_rate_hz = 1000;
  const auto cvode = IntegrateCvode(*ParseScene(kScene), options);
  ASSERT_TRUE(cvode.ok());
  ASSERT_EQ(cvode->samples.size(), 501);
  for (size_t i = 1; i < a.size(); ++i) {
    ASSERT_EQ(a[i].size(), 6);
    EXPECT_NEAR(a[i][0], (i - 1) / 1000.0, 1e-12);
    EXPECT_NEAR(a[i][5], std::max(0.0, 5000 * (a[i][1] - a[i][3])), 1e-9);
    EXPECT_NEAR(a[i][1], cvode->samples[i - 1].x_arm, 1e-5);
    EXPECT_NEAR(a[i][3], cvode->samples[i - 1].x_uobj, 1e-5);
  }
  EXPECT_GT(a.back()[3], 1e-3);
}

TEST(SimulateOneTest, BadFlagsAreNamed) {
  std::ostringstream out;
  OneContactFlags flags;
  flags.scene = kScene;
  EXPECT_EQ(ReasonOf(SimulateOne(flags, out)), "INVALID_CONFIG");
  flags.csv = true;
  flags.rate_hz = 33;
  EXPECT_EQ(ReasonOf(SimulateOne(flags, out)), "INVALID_SCENE");
  flags.scene = "@/nonexistent/scene.json";
  EXPECT_EQ(ReasonOf(SimulateOne(flags, out)), "IO");
  EXPECT_EQ(out.str(), "");
}

}  // namespace
}  // namespace tactus::internal::client
