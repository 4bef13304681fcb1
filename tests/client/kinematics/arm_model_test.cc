// URDF files through urdfdom and KDL, against poses that numpy computed from
// formulas (arm_tables.py) and against what each mistake should be called.
#include "client/kinematics/arm_model.h"

#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/random.h"
#include "core/files/file_bytes.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/allocation_counter.h"

namespace tactus::internal::client {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string Golden(const std::string& name) {
  const char* root = std::getenv("TACTUS_SOURCE_DIR");
  const auto text = ReadFileBytes(std::string(root == nullptr ? "." : root) +
                                      "/tests/golden/kinematics/" + name,
                                  1 << 20);
  EXPECT_TRUE(text.ok()) << text.status();
  return text.value_or("");
}

// Largest difference of a position in metres or an entry of the rotation.
double LargestError(const std::string& arm, const std::string& link) {
  auto model = ArmModel::FromUrdf(Golden(arm + ".urdf"), link);
  EXPECT_TRUE(model.ok()) << model.status();
  if (!model.ok()) return 1;
  const size_t joints = model->joints().size();
  double worst = 0;
  int rows = 0;
  for (const absl::string_view line :
       absl::StrSplit(Golden(arm + ".csv"), '\n', absl::SkipEmpty())) {
    std::vector<double> numbers;
    for (const absl::string_view cell : absl::StrSplit(line, ',')) {
      EXPECT_TRUE(absl::SimpleAtod(cell, &numbers.emplace_back()));
    }
    EXPECT_EQ(numbers.size(), joints + 12);
    if (numbers.size() != joints + 12) return 1;
    const auto pose = model->PoseOf({numbers.data(), joints});
    EXPECT_TRUE(pose.ok()) << pose.status();
    if (!pose.ok()) return 1;
    const Eigen::Matrix3d rotation = pose->orientation.toRotationMatrix();
    for (int i = 0; i < 3; ++i) {
      const double* const expected = &numbers[joints];
      worst = std::max(worst, std::abs(pose->position[i] - expected[i]));
      for (int j = 0; j < 3; ++j) {
        worst =
            std::max(worst, std::abs(rotation(i, j) - expected[3 + 3 * i + j]));
      }
    }
    EXPECT_NEAR(pose->orientation.norm(), 1, 1e-14);
    ++rows;
  }
  EXPECT_EQ(rows, 40);
  std::printf("%s: largest error %.1e\n", arm.c_str(), worst);
  return worst;
}

TEST(ArmModelTest, ThePandasPosesAreThoseOfItsDenavitHartenbergTable) {
  EXPECT_LT(LargestError("panda", "link8"), 1e-12);
}

TEST(ArmModelTest, AnArmWithAllKindsOfJointsHasThePosesOfItsMatrices) {
  EXPECT_LT(LargestError("odd_arm", "forearm_skin"), 1e-12);
}

TEST(ArmModelTest, JointsThatMoveAreListedFromTheBaseOn) {
  const auto model = ArmModel::FromUrdf(Golden("odd_arm.urdf"), "forearm_skin");
  ASSERT_TRUE(model.ok()) << model.status();
  EXPECT_EQ(model->JointNames(), "slide, turn, elbow, roll");
  EXPECT_TRUE(model->joints()[0].slides);
  EXPECT_TRUE(model->joints()[1].endless);
  EXPECT_EQ(model->joints()[2].upper, 2.5);
}

TEST(ArmModelTest, APoseAllocatesNothing) {
  auto model = ArmModel::FromUrdf(Golden("panda.urdf"), "link8");
  ASSERT_TRUE(model.ok()) << model.status();
  const std::vector<double> values = {0, 0, 0, -1, 0, 1, 0};
  const testing::AllocationCounter counter;
  const auto pose = model->PoseOf(values);
  EXPECT_EQ(counter.count(), 0);
  EXPECT_TRUE(pose.ok());
}

std::string ErrorOf(const absl::Status& status) {
  EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG") << status;
  return std::string(status.message());
}

TEST(ArmModelTest, ValuesThatCannotBeRightAreRefused) {
  auto model = ArmModel::FromUrdf(Golden("odd_arm.urdf"), "forearm_skin");
  ASSERT_TRUE(model.ok()) << model.status();
  const auto error = [&](std::vector<double> values) {
    return ErrorOf(model->PoseOf(values).status());
  };
  EXPECT_THAT(error({0, 0, 0}),
              AllOf(HasSubstr("3"), HasSubstr("4: slide, turn, elbow, roll")));
  EXPECT_THAT(error({0, 0, 0, 0, 0}), HasSubstr("5"));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(error({0, nan, 0, 0}), HasSubstr("joint turn"));
  EXPECT_THAT(error({0, 0, HUGE_VAL, 0}), HasSubstr("joint elbow"));
  EXPECT_THAT(error({0, 2e4, 0, 0}), HasSubstr("joint turn"));
  // Degrees.
  EXPECT_THAT(error({0, 0, 90, 0}),
              AllOf(HasSubstr("joint elbow"), HasSubstr("-2.5 to 2.5 rad"),
                    HasSubstr("units")));
  EXPECT_THAT(error({-0.7, 0, 0, 0}),
              AllOf(HasSubstr("joint slide"), HasSubstr("m, its limits")));
  // A little beyond a stop, and many turns.
  EXPECT_TRUE(model->PoseOf(std::vector<double>{0, 60, 2.59, 0}).ok());
  EXPECT_FALSE(model->PoseOf(std::vector<double>{0, 60, 2.61, 0}).ok());
}

// base -a-> one -b-> two -c-> skin, without anything else.
constexpr char kSmall[] =
    "<robot name='r'><link name='base'/><link name='one'/><link name='two'/>"
    "<link name='skin'/>"
    "<joint name='a' type='revolute'><parent link='base'/><child link='one'/>"
    "<axis xyz='0 0 1'/><limit effort='1' velocity='1'/></joint>"
    "<joint name='b' type='prismatic'><parent link='one'/><child link='two'/>"
    "<axis xyz='1 0 0'/><limit effort='1' velocity='1'/></joint>"
    "<joint name='c' type='fixed'><parent link='two'/><child link='skin'/>"
    "</joint></robot>";

std::string Small(const std::string& from = "", const std::string& to = "") {
  if (from.empty()) return kSmall;
  const std::string text = absl::StrReplaceAll(kSmall, {{from, to}});
  EXPECT_NE(text, kSmall);
  return text;
}

TEST(ArmModelTest, TwoJointsHaveTheirClosedForm) {
  auto model = ArmModel::FromUrdf(Small(), "skin");
  ASSERT_TRUE(model.ok()) << model.status();
  // Limits of 0 and 0 are none.
  const auto pose = model->PoseOf(std::vector<double>{0.7, 2});
  ASSERT_TRUE(pose.ok()) << pose.status();
  EXPECT_NEAR(pose->position.x(), 2 * std::cos(0.7), 1e-14);
  EXPECT_NEAR(pose->position.y(), 2 * std::sin(0.7), 1e-14);
  EXPECT_NEAR(pose->orientation.z(), std::sin(0.35), 1e-14);
}

TEST(ArmModelTest, MistakesInAUrdfAreNamed) {
  const std::string mimic_gone = "<axis xyz='1 0 0'/><mimic joint='gripper'/>";
  const std::string mimic_self = "<axis xyz='1 0 0'/><mimic joint='b'/>";
  const std::string mimic_fixed = "<axis xyz='1 0 0'/><mimic joint='c'/>";
  struct Mistake {
    std::string text;
    std::string link;
    std::string error;
  };
  const Mistake mistakes[] = {
      {"", "skin", "a URDF"},
      {"x,y,z\n1,2,3\n", "skin", "a URDF"},
      {"<html><body/></html>", "skin", "robot"},
      {"<robot name='r'/>", "skin", "link"},
      {Small().substr(0, 300), "skin", "a URDF"},
      {Small(), "forearm", "one of base, one, skin, two"},
      {Small(), "", "one of base"},
      {Small(), "base", "a link below a joint that moves"},
      {Small("revolute", "floating"), "skin", "joint a is floating"},
      {Small("revolute", "planar"), "skin", "joint a is planar"},
      {Small("revolute", "spherical"), "skin", "spherical"},
      {Small("<axis xyz='1 0 0'/>", "<axis xyz='0 0 0'/>"), "skin", "length 0"},
      {Small("<axis xyz='1 0 0'/>", "<axis xyz='1 0'/>"), "skin", "a URDF"},
      {Small("<axis xyz='1 0 0'/>", "<axis xyz='nan 0 0'/>"), "skin", "a URDF"},
      {Small("<axis xyz='1 0 0'/>", "<axis xyz='1e30 0 0'/>"), "skin",
       "an axis of length 1"},
      {Small("<axis xyz='1 0 0'/>",
             "<axis xyz='1 0 0'/><origin xyz='1e9 0 "
             "0'/>"),
       "skin", "an origin far away"},
      {Small("<axis xyz='1 0 0'/>", mimic_gone), "skin", "mimic of gripper"},
      {Small("<axis xyz='1 0 0'/>", mimic_self), "skin", "mimic of itself"},
      {Small("<axis xyz='1 0 0'/>", mimic_fixed), "skin", "fixed joint"},
      {Small("<parent link='two'/>", "<parent link='three'/>"), "skin",
       "three"},
      // Two joints move one link.
      {Small("</robot>",
             "<joint name='d' type='fixed'><parent link='base'/>"
             "<child link='two'/></joint></robot>"),
       "skin", "the child of 2 joints"},
      // A loop beside the tree.
      {Small("</robot>",
             "<link name='p'/><link name='q'/>"
             "<joint name='d' type='fixed'><parent link='p'/><child "
             "link='q'/></joint>"
             "<joint name='e' type='fixed'><parent link='q'/><child "
             "link='p'/></joint></robot>"),
       "p", "loop"},
  };
  for (const Mistake& mistake : mistakes) {
    const auto model = ArmModel::FromUrdf(mistake.text, mistake.link);
    ASSERT_FALSE(model.ok()) << mistake.text;
    EXPECT_THAT(ErrorOf(model.status()), HasSubstr(mistake.error))
        << mistake.text;
  }
}

TEST(ArmModelTest, NothingIsPrintedForAWrongFile) {
  ::testing::internal::CaptureStderr();
  EXPECT_FALSE(ArmModel::FromUrdf("<robot name='r'/>", "skin").ok());
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(ArmModelTest, ALinkFarAwayIsNoPose) {
  // 200 rails of 8 km each.
  std::string text = "<robot name='r'><link name='l0'/>";
  for (int i = 1; i <= 200; ++i) {
    absl::StrAppend(&text, "<link name='l", i, "'/><joint name='j", i,
                    "' type='", i == 1 ? "prismatic" : "fixed",
                    "'><origin xyz='8000 0 0'/><parent link='l", i - 1,
                    "'/><child link='l", i, "'/></joint>");
  }
  auto model = ArmModel::FromUrdf(absl::StrCat(text, "</robot>"), "l200");
  ASSERT_FALSE(model.ok());
  // A prismatic joint has limits.
  model = ArmModel::FromUrdf(absl::StrReplaceAll(absl::StrCat(text, "</robot>"),
                                                 {{"prismatic", "continuous"}}),
                             "l200");
  ASSERT_TRUE(model.ok()) << model.status();
  EXPECT_THAT(ErrorOf(model->PoseOf(std::vector<double>{0}).status()),
              HasSubstr("metres from the base"));
}

// Pieces of good files removed, doubled, moved or overwritten.
TEST(ArmModelTest, ADamagedFileIsAnErrorOrAnArm) {
  const std::vector<std::string> good = {Golden("panda.urdf"),
                                         Golden("odd_arm.urdf"),
                                         Golden("scara.urdf"), kSmall};
  const std::vector<std::string> links = {"link8", "forearm_skin", "skin",
                                          "skin"};
  constexpr absl::string_view kPieces[] = {"<",           ">",
                                           "/>",          "\"",
                                           "<joint ",     "</joint>",
                                           "nan",         "1e999",
                                           "-",           "<!--",
                                           "]]>",         "&#0;",
                                           "\xff",        "<robot name='x'>",
                                           "type='fixed'"};
  Random random(14);
  int arms = 0;
  int errors = 0;
  for (int round = 0; round < 4000; ++round) {
    const size_t which = random.Index(good.size());
    std::string text = good[which];
    const int changes = 1 + static_cast<int>(random.Index(4));
    for (int i = 0; i < changes; ++i) {
      const size_t at = random.Index(text.size());
      const size_t size = random.Index(40);
      const std::string piece = text.substr(random.Index(text.size()), size);
      switch (random.Index(4)) {
        case 0:
          text.erase(at, size);
          break;
        case 1:
          text.insert(at, piece);
          break;
        case 2:
          text.replace(at, size, piece);
          break;
        default:
          text.insert(at, std::string(kPieces[random.Index(15)]));
      }
    }
    auto model = ArmModel::FromUrdf(text, links[which]);
    if (!model.ok()) {
      ErrorOf(model.status());
      ++errors;
      continue;
    }
    ++arms;
    const std::vector<double> values(model->joints().size(), 0.1);
    const Pose pose = model->Forward(values);
    EXPECT_TRUE(pose.position.allFinite()) << text;
    EXPECT_NEAR(pose.orientation.norm(), 1, 1e-9) << text;
  }
  EXPECT_GT(arms, 100);
  EXPECT_GT(errors, 100);
}

// What urdfdom and TinyXML would recurse for.
TEST(ArmModelTest, AsManyJointsAsAllowedAreRead) {
  std::string text = "<robot name='r'><link name='l0'/>";
  for (int i = 1; i <= limits::kMaxUrdfJoints; ++i) {
    absl::StrAppend(&text, "<link name='l", i, "'/><joint name='j", i,
                    "' type='continuous'><parent link='l", i - 1,
                    "'/><child link='l", i, "'/></joint>");
  }
  auto model = ArmModel::FromUrdf(absl::StrCat(text, "</robot>"),
                                  absl::StrCat("l", limits::kMaxUrdfJoints));
  ASSERT_TRUE(model.ok()) << model.status();
  EXPECT_EQ(model->joints().size(), size_t{limits::kMaxUrdfJoints});
}

}  // namespace
}  // namespace tactus::internal::client
