// Bags that rosbag itself writes, with a message type of our own. Needs
// librosbag-storage-dev.
#include "core/import/ros_bag.h"

#include <rosbag/bag.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/base/errors.h"
#include "core/import/import.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/import/import_all.h"

namespace tactus::internal::bag_test {

// What hrl_haptic_manip's TaxelArray has, and a text and a constant to skip.
constexpr char kTaxels[] = R"(# Test.
int32 VERSION=1
Header header
string sensor_type
string[] link_names
float64[] normals_x
float64[] normals_y
float64[] normals_z
float64[] values_x
float64[] values_y
float64[] values_z
int32[2] extra
================================================================================
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
)";
constexpr char kPose[] = R"(std_msgs/Header header
Pose pose
===
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
===
MSG: geometry_msgs/Pose
Point position
Quaternion orientation
===
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z
===
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
)";

// Bytes of a message, with the type that the bag shall record.
struct Raw {
  std::string type;
  std::string definition;
  std::string bytes;

  void Number(double value) { Append(&value, sizeof(value)); }
  void Whole(uint32_t value) { Append(&value, sizeof(value)); }
  void Text(const std::string& text) {
    Whole(static_cast<uint32_t>(text.size()));
    bytes += text;
  }
  void Numbers(const std::vector<double>& values) {
    Whole(static_cast<uint32_t>(values.size()));
    for (const double value : values) Number(value);
  }
  void Append(const void* data, size_t size) {
    bytes.append(static_cast<const char*>(data), size);
  }
};

}  // namespace tactus::internal::bag_test

namespace ros {
namespace message_traits {

template <>
struct MD5Sum<tactus::internal::bag_test::Raw> {
  static const char* value(const tactus::internal::bag_test::Raw& raw) {
    return raw.type == "test/Pose" ? "0123456789abcdef0123456789abcdef"
                                   : "fedcba9876543210fedcba9876543210";
  }
};
template <>
struct DataType<tactus::internal::bag_test::Raw> {
  static const char* value(const tactus::internal::bag_test::Raw& raw) {
    return raw.type.c_str();
  }
};
template <>
struct Definition<tactus::internal::bag_test::Raw> {
  static const char* value(const tactus::internal::bag_test::Raw& raw) {
    return raw.definition.c_str();
  }
};

}  // namespace message_traits

namespace serialization {

template <>
struct Serializer<tactus::internal::bag_test::Raw> {
  template <typename Stream>
  static void write(Stream& stream,
                    const tactus::internal::bag_test::Raw& raw) {
    std::memcpy(stream.advance(static_cast<uint32_t>(raw.bytes.size())),
                raw.bytes.data(), raw.bytes.size());
  }
  static uint32_t serializedLength(const tactus::internal::bag_test::Raw& raw) {
    return static_cast<uint32_t>(raw.bytes.size());
  }
};

}  // namespace serialization
}  // namespace ros

namespace tactus::internal {
namespace {

namespace fs = std::filesystem;
using bag_test::Raw;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

Raw TaxelMessage(const std::vector<double>& forces) {
  Raw raw{.type = "test/Taxels", .definition = bag_test::kTaxels, .bytes = {}};
  for (int i = 0; i < 3; ++i) raw.Whole(7);  // seq, stamp
  raw.Text("arm");
  raw.Text("force");
  raw.Whole(2);
  raw.Text("link 1");
  raw.Text("link 2");
  const size_t n = forces.size();
  // Normals point along -z; forces have a part along x, too.
  raw.Numbers(std::vector<double>(n, 0));
  raw.Numbers(std::vector<double>(n, 0));
  raw.Numbers(std::vector<double>(n, -1));
  std::vector<double> side;
  std::vector<double> down;
  for (const double force : forces) {
    side.push_back(0.75 * force);
    down.push_back(-force);
  }
  raw.Numbers(side);
  raw.Numbers(std::vector<double>(n, 0));
  raw.Numbers(down);
  raw.Whole(1);
  raw.Whole(2);
  return raw;
}

Raw PoseMessage(double x) {
  Raw raw{.type = "test/Pose", .definition = bag_test::kPose, .bytes = {}};
  for (int i = 0; i < 3; ++i) raw.Whole(7);
  raw.Text("");
  for (const double value : {x, 2., 3., 0., 0., 0., 1.}) raw.Number(value);
  return raw;
}

class RosBagTest : public ::testing::Test {
 protected:
  RosBagTest() : folder_(fs::path(::testing::TempDir()) / "ros_bag") {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~RosBagTest() override { fs::remove_all(folder_); }

  std::string Path(const std::string& name) const { return folder_ / name; }

  // 20 frames of a 1 x 3 skin, 50 a second; poses 10 a second.
  std::string WriteBag(const std::string& name) {
    rosbag::Bag bag(Path(name), rosbag::bagmode::Write);
    for (int t = 0; t < 20; ++t) {
      const double force = t < 5 ? 0 : 0.25 * t;
      bag.write("/skin", ros::Time(100 + 0.02 * t),
                TaxelMessage({0, force, 2 * force}));
      if (t % 5 == 0) {
        bag.write("/pose", ros::Time(100 + 0.02 * t), PoseMessage(0.1 * t));
      }
    }
    bag.close();
    return Path(name);
  }

  static std::string Message(const absl::StatusOr<ArrayFile>& file) {
    EXPECT_EQ(ReasonOf(file.status()), "TRIAL_FILE_INVALID") << file.status();
    return std::string(file.status().message());
  }

  const fs::path folder_;
};

TEST_F(RosBagTest, ForcesAlongNormalsWithTimesAndPoses) {
  const auto file =
      ReadBag(WriteBag("a.bag"), {.frames = "/skin", .pose = "/pose"});
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->array.shape, ElementsAre(20, 11));
  EXPECT_EQ(file->header[0], "time");
  EXPECT_EQ(file->header[7], "qw");
  const auto at = [&](int frame, int column) {
    return file->Number(frame * 11 + column);
  };
  EXPECT_NEAR(at(12, 0), 0.24, 1e-6);
  // The last pose before frame 12 is that of frame 10.
  EXPECT_DOUBLE_EQ(at(12, 1), 1);
  EXPECT_DOUBLE_EQ(at(12, 7), 1);
  EXPECT_DOUBLE_EQ(at(12, 8), 0);
  EXPECT_DOUBLE_EQ(at(12, 9), 3);
  EXPECT_DOUBLE_EQ(at(12, 10), 6);
}

TEST_F(RosBagTest, MagnitudesAndSingleFields) {
  const std::string path = WriteBag("a.bag");
  auto file = ReadBag(path, {.frames = "/skin", .values = "magnitude"});
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_DOUBLE_EQ(file->Number(12 * 4 + 2), 3 * 1.25);
  file = ReadBag(path, {.frames = "/skin", .values = "values_z"});
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_DOUBLE_EQ(file->Number(12 * 4 + 2), -3);
}

TEST_F(RosBagTest, MistakesNameFileTopicAndField) {
  const std::string path = WriteBag("a.bag");
  EXPECT_THAT(Message(ReadBag(path, {.frames = "/skins"})),
              HasSubstr("a.bag: topic \"/skins\": has no message; the bag "
                        "holds "));
  EXPECT_THAT(Message(ReadBag(path, {.frames = "/skin", .values = "val_z"})),
              HasSubstr("topic \"/skin\": message 0: field \"val_z\" is not "
                        "in the message"));
  // Poses are no taxels, and taxels no poses.
  EXPECT_THAT(Message(ReadBag(path, {.frames = "/pose"})),
              HasSubstr("field \"values_x\""));
  EXPECT_THAT(Message(ReadBag(path, {.frames = "/skin", .pose = "/skin"})),
              HasSubstr("field \"position.x\""));
  std::ofstream(Path("text.bag")) << "no bag";
  EXPECT_THAT(Message(ReadBag(Path("text.bag"), {.frames = "/skin"})),
              HasSubstr("text.bag: is no bag of ROS 1, or damaged"));
  EXPECT_FALSE(ReadBag(Path("absent.bag"), {.frames = "/skin"}).ok());
}

// A cut bag gives an error at any length, and never an answer.
TEST_F(RosBagTest, ATruncatedBagIsRefused) {
  std::ifstream file(WriteBag("a.bag"), std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  for (size_t size = 0; size < bytes.size(); size += 97) {
    std::ofstream(Path("cut.bag"), std::ios::binary) << bytes.substr(0, size);
    EXPECT_THAT(Message(ReadBag(Path("cut.bag"), {.frames = "/skin"})),
                HasSubstr("cut.bag"))
        << size;
  }
}

// A message that is shorter than its type says.
TEST_F(RosBagTest, AShortMessageIsRefused) {
  Raw raw = TaxelMessage({1, 2, 3});
  raw.bytes.resize(raw.bytes.size() - 3);
  {
    rosbag::Bag bag(Path("short.bag"), rosbag::bagmode::Write);
    bag.write("/skin", ros::Time(1), TaxelMessage({1, 2, 3}));
    bag.write("/skin", ros::Time(2), raw);
  }
  EXPECT_THAT(Message(ReadBag(Path("short.bag"), {.frames = "/skin"})),
              HasSubstr("message 1: ROS message: ends within extra"));
}

TEST_F(RosBagTest, IsImportedAsAFolder) {
  WriteBag("a.bag");
  std::ofstream(folder_ / "skin.json") << R"({"name": "mine", "rows": 1,
    "columns": 3, "row_pitch_m": 0.01, "column_pitch_m": 0.01,
    "unit": "newton", "contact_threshold": 0.1, "sample_rate_hz": 50,
    "dataset": "/skin", "bag_values": "normal", "pose_topic": "/pose"})";
  std::ofstream(folder_ / "trials.csv") << "frames,label\na.bag,soft\n";
  const auto trials = ImportAll(folder_.string());
  ASSERT_TRUE(trials.ok()) << trials.status();
  ASSERT_EQ(trials->size(), 1u);
  const Trial& trial = trials->front();
  EXPECT_EQ(trial.label, "soft");
  EXPECT_EQ(trial.taxels.frames(), 20u);
  EXPECT_EQ(trial.poses.size(), 20u);
  EXPECT_DOUBLE_EQ(trial.poses[12].position.x(), 1);
  std::vector<float> taxels(3);
  trial.taxels.Decode(12, taxels.data());
  EXPECT_THAT(taxels, ElementsAre(0, 3, 6));

  std::ofstream(folder_ / "trials.csv") << "frames,label\na.bag:/no,soft\n";
  EXPECT_THAT(std::string(ImportAll(folder_.string()).status().message()),
              HasSubstr("trials.csv: line 2: frames: "));
}

}  // namespace
}  // namespace tactus::internal
