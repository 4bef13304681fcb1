// Bags of ROS 2: those that rosbag2 itself wrote, and made ones with touch.
#include <sqlite3.h>

#include <bit>
#include <filesystem>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/import/import.h"
#include "core/import/ros2/bag_summary.h"
#include "core/import/ros2/read_ros2_bag.h"
#include "core/import/ros2/ros2_taxels.h"
#include "core/import/ros2/ros2_type.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/import/bag_samples.h"
#include "tests/core/import/import_all.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kGoldenBags = std::string(TACTUS_GOLDEN) + "/bags/";

std::string TopicText(const BagTopicSummary& each) {
  return absl::StrCat(each.topic.name, " ", each.topic.type, " ",
                      each.topic.encoding, " ", each.messages);
}

std::vector<std::string> TopicTexts(const BagSummary& summary) {
  std::vector<std::string> texts;
  for (const BagTopicSummary& each : summary.topics) {
    texts.push_back(TopicText(each));
  }
  return texts;
}

constexpr char kNoEvent[] =
    "/parameter_events rcl_interfaces/msg/ParameterEvent cdr 0";

// The first message of a topic, decoded.
Ros2Message FirstOf(const std::string& path, const std::string& topic) {
  const auto bag = *Ros2Bag::Open(path);
  while (true) {
    const auto message = bag->Next();
    EXPECT_TRUE(message.ok()) << message.status();
    if (!message.ok() || *message == nullptr) return {};
    const BagTopic& each = bag->topics()[(*message)->topic];
    if (each.name != topic) continue;
    const auto type = Ros2Type::Parse(each.type, each.definition);
    EXPECT_TRUE(type.ok()) << type.status();
    const auto read = type->Read((*message)->data);
    EXPECT_TRUE(read.ok()) << read.status();
    return read.ok() ? *read : Ros2Message();
  }
}

// The numbers are those of the metadata.yaml that rosbag2 wrote beside it.
TEST(Ros2BagTest, ListsWhatRosbag2Wrote) {
  const auto zstd = SummarizeBag(kGoldenBags + "talker.mcap");
  ASSERT_TRUE(zstd.ok()) << zstd.status();
  EXPECT_THAT(zstd->compressions, ElementsAre("zstd"));
  EXPECT_THAT(zstd->cut_off, IsEmpty());
  EXPECT_THAT(TopicTexts(*zstd),
              ElementsAre(kNoEvent, "/rosout rcl_interfaces/msg/Log cdr 10",
                          "/topic std_msgs/msg/String cdr 10"));

  const auto sqlite = SummarizeBag(kGoldenBags + "talker_db3");
  ASSERT_TRUE(sqlite.ok()) << sqlite.status();
  EXPECT_EQ(sqlite->storage, "sqlite3");
  EXPECT_THAT(TopicTexts(*sqlite),
              ElementsAre(kNoEvent, "/rosout rcl_interfaces/msg/Log cdr 10",
                          "/topic std_msgs/msg/String cdr 10"));
  EXPECT_DOUBLE_EQ(sqlite->seconds, 4.531096768);
  EXPECT_NEAR(sqlite->topics[2].rate_hz, 2, 0.02);
  EXPECT_THAT(SkinToStartFrom(*sqlite), IsEmpty());
  EXPECT_EQ(FirstOf(kGoldenBags + "talker_db3", "/topic").texts.at("data"),
            "Hello, world! 0");
}

// The values are those that rosbag2's own test of this bag expects
// (test_rosbag2_play_end_to_end.cpp), which leaves the others at 0.
TEST(Ros2BagTest, DecodesWhatRosbag2Wrote) {
  const std::string path = kGoldenBags + "cdr_test_0.mcap";
  const auto summary = SummarizeBag(path);
  ASSERT_TRUE(summary.ok()) << summary.status();
  EXPECT_THAT(TopicTexts(*summary),
              ElementsAre("/array_topic test_msgs/msg/Arrays cdr 4",
                          "/test_topic test_msgs/msg/BasicTypes cdr 3"));
  const Ros2Message arrays = FirstOf(path, "/array_topic");
  EXPECT_THAT(arrays.numbers.at("bool_values"), ElementsAre(1, 0, 1));
  // The defaults of the definition, which the recorder's program left.
  EXPECT_THAT(arrays.numbers.at("float64_values"), ElementsAre(0, 0, 0));
  EXPECT_THAT(arrays.numbers.at("float64_values_default"),
              ElementsAre(3.1415, 0, -3.1415));
  EXPECT_THAT(arrays.numbers.at("int16_values_default"),
              ElementsAre(0, 32767, -32768));
  EXPECT_THAT(arrays.numbers.at("uint32_values_default"),
              ElementsAre(0, 1, 4294967295));
  EXPECT_EQ(arrays.numbers.at("basic_types_values.float64_value").size(), 3U);
  EXPECT_EQ(arrays.texts.at("string_values"), "Complex Hello3");
  const Ros2Message basic = FirstOf(path, "/test_topic");
  EXPECT_THAT(basic.numbers.at("int32_value"), ElementsAre(123));
}

// Bytes by the specification: 1, a byte of another kind, and 0x0102.
TEST(Ros2BagTest, ReadsEveryPlainEncoding) {
  const std::pair<std::string, std::string> cases[] = {
      {std::string("\0\1\0\0", 4),
       std::string("\7\0\0\0\2\1\0\0\0\0\0\0\0\0\x10\x40", 16)},
      {std::string("\0\0\0\0", 4),
       std::string("\7\0\0\0\0\0\1\2\x40\x10\0\0\0\0\0\0", 16)},
      {std::string("\0\7\0\0", 4),
       std::string("\7\0\0\0\2\1\0\0\0\0\0\0\0\0\x10\x40", 16)},
  };
  for (const auto& [header, bytes] : cases) {
    const std::string all = header + bytes;
    CdrReader reader(all);
    EXPECT_EQ(reader.Number<uint8_t>(), 7);
    EXPECT_EQ(reader.Number<uint32_t>(), 0x0102U);
    EXPECT_EQ(reader.Number<double>(), 4);
    EXPECT_TRUE(reader.good());
    EXPECT_EQ(reader.left(), 0U);
    EXPECT_EQ(reader.Number<uint8_t>(), 0);
    EXPECT_FALSE(reader.good());
  }
  // A double lies at a multiple of 8, but of 4 in CDR 2.
  const std::string text("\1\0\0\0\0\0\0\0\0\0\x10\x40\0\0\0\x41", 16);
  const std::string second = std::string("\0\7\0\0", 4) + text;
  CdrReader narrow(second);
  narrow.Number<uint32_t>();
  EXPECT_EQ(narrow.Number<double>(), 4);
  const std::string first = std::string("\0\1\0\0", 4) + text;
  CdrReader wide(first);
  wide.Number<uint32_t>();
  EXPECT_EQ(wide.Number<double>(), std::bit_cast<double>(0x4100000040100000));
  EXPECT_FALSE(CdrReader(std::string("\0\3\0\0\1", 5)).good());
  EXPECT_FALSE(CdrReader("\1").good());
}

TEST(Ros2BagTest, ListsTheShapesOfTouchAndAMapping) {
  const ScratchDir folder;
  CdrText image;
  image.PutHeader().Put(uint32_t{2}).Put(uint32_t{2}).PutText("mono16");
  image.Put(uint8_t{1}).Put(uint32_t{6});
  image.PutList<uint8_t>({1, 0, 0, 2, 9, 9, 0, 3, 0, 4, 9, 9});
  CdrText field;
  field.PutHeader().Put(1.5).Put(-2.5).Put(3.5);
  for (int i = 0; i < 9; ++i) field.Put(0.0);
  CdrText state;
  state.PutHeader().Put(uint32_t{2});
  state.PutText("a").PutList<float>({1, 2}).PutText("b").PutList<float>({3});
  WriteSampleBag(
      folder / "a.mcap",
      {TouchTopic("/hand/touch"),
       {"/image", "sensor_msgs/msg/Image", {{5, image.Done()}}},
       {"/magnet", "sensor_msgs/msg/MagneticField", {{5, field.Done()}}},
       {"/state", "tactile_msgs/msg/TactileState", {{5, state.Done()}}},
       {"/counts",
        "std_msgs/msg/Int16MultiArray",
        {{5, ArrayMessage<int16_t>({}, {1, -2})}}},
       {"/own", "my_msgs/msg/Skin", {{5, "x"}}}});
  const auto summary = SummarizeBag(folder / "a.mcap");
  ASSERT_TRUE(summary.ok()) << summary.status();
  std::vector<std::vector<size_t>> shapes;
  for (const auto& each : summary->topics) shapes.push_back(each.shape);
  EXPECT_THAT(shapes,
              ElementsAre(ElementsAre(2), ElementsAre(2, 3), ElementsAre(2, 2),
                          ElementsAre(1, 3), IsEmpty(), ElementsAre(3)));
  EXPECT_DOUBLE_EQ(summary->topics[1].rate_hz, 100);
  EXPECT_THAT(summary->topics[4].unread, HasSubstr("no definition"));
  const std::string skin = SkinToStartFrom(*summary);
  EXPECT_THAT(skin, HasSubstr("\"dataset\": \"/hand/touch\""));
  EXPECT_THAT(skin, HasSubstr("\"sample_rate_hz\": 100"));
  const auto pixels = TaxelsOf("sensor_msgs/msg/Image",
                               FirstOf(folder / "a.mcap", "/image"), "");
  ASSERT_TRUE(pixels.ok()) << pixels.status();
  EXPECT_THAT(pixels->numbers, ElementsAre(256, 2, 3, 4));
}

// Touch that other people's packages encoded and wrote (touch_bag.mjs).
TEST(Ros2BagTest, ReadsWhatAnotherWriterEncoded) {
  const std::string path = kGoldenBags + "touch.mcap";
  const auto summary = SummarizeBag(path);
  ASSERT_TRUE(summary.ok()) << summary.status();
  EXPECT_THAT(summary->cut_off, IsEmpty());
  const std::pair<std::string, std::vector<double>> cases[] = {
      {"/touch/array", {0.58, 0.5, 93, 0.25, 0.125}},
      {"/touch/counts", {0.58, 29, 529, 65535}},
      {"/touch/image", {0.58, 0, 0, 0, 0, 93, 0}},
      {"/touch/magnet", {0.58, -1.5, 29, 93}}};
  for (const auto& [topic, last] : cases) {
    const auto file = ReadRos2Bag(path, {.frames = topic});
    ASSERT_TRUE(file.ok()) << file.status();
    EXPECT_THAT(file->array.shape, ElementsAre(30, last.size()));
    const std::vector<double>& all = file->array.f64;
    EXPECT_THAT(std::vector<double>(all.end() - last.size(), all.end()),
                testing::Pointwise(testing::DoubleEq(), last))
        << topic;
  }
}

// The mapping that the list prints imports the bag as it stands.
TEST(Ros2BagTest, ImportsWithTheMappingOfTheList) {
  const ScratchDir folder;
  WriteSampleBag(folder / "a.mcap", {TouchTopic("/touch")});
  const auto summary = SummarizeBag(folder / "a.mcap");
  ASSERT_TRUE(summary.ok()) << summary.status();
  WriteBytes(folder / "skin.json", SkinToStartFrom(*summary));
  const auto trials = ImportAll(
      folder / "a.mcap", {.mapping = folder / "skin.json", .label = "soft"});
  ASSERT_TRUE(trials.ok()) << trials.status();
  ASSERT_EQ(trials->size(), 1U);
  const Trial& trial = trials->front();
  EXPECT_EQ(trial.label, "soft");
  EXPECT_EQ(trial.source, "a.mcap");
  EXPECT_EQ(trial.sample_rate_hz, 100);
  ASSERT_EQ(trial.taxels.frames(), 40U);
  EXPECT_EQ(trial.skin->rows, 2);
  EXPECT_EQ(trial.skin->columns, 3);
  EXPECT_NEAR(trial.time[1], 0.01, 1e-12);
  EXPECT_EQ(trial.taxels.f32[20 * 6 + 4], 70);
  EXPECT_EQ(trial.taxels.f32[20 * 6 + 3], 0.125F);
}

constexpr char kTouchSkin[] = R"({"name": "mine", "rows": 2, "columns": 3,
  "row_pitch_m": 0.01, "column_pitch_m": 0.01, "unit": "counts",
  "contact_threshold": 5, "sample_rate_hz": 100, "dataset": "/touch")";

// A folder of bags is none, and says which of them can be named.
TEST(Ros2BagTest, AFolderOfBagsNamesTheFirst) {
  const ScratchDir folder;
  for (const std::string run : {"bags/b", "bags/a", "bags/empty"}) {
    std::filesystem::create_directories(folder / run);
  }
  WriteSampleBag(folder / "bags/b/b_0.mcap", {TouchTopic("/touch")});
  WriteSampleBag(folder / "bags/a/a_0.mcap", {TouchTopic("/touch")});
  EXPECT_THAT(std::string(SummarizeBag(folder / "bags").status().message()),
              testing::EndsWith(absl::StrCat(
                  "is no bag, but holds bags; name one of them, such as ",
                  folder / "bags/a")));
  EXPECT_THAT(
      std::string(SummarizeBag(folder / "bags/empty").status().message()),
      HasSubstr("holds no .mcap or .db3"));
  WriteBytes(folder / "skin.json", std::string(kTouchSkin) + "}");
  const auto error = [&](const ImportOptions& options) {
    return std::string(ImportAll(folder / "bags", options).status().message());
  };
  const std::string list =
      absl::StrCat("trainctl import ", folder / "bags/a", " --list");
  EXPECT_THAT(error({}), HasSubstr(list));
  EXPECT_THAT(error({.file_names = "{label}_{}/{}.mcap"}), HasSubstr(list));
  EXPECT_THAT(error({.mapping = folder / "skin.json", .label = "soft"}),
              HasSubstr("is a folder of bags"));
}

// The topic of poses is part of the mapping unless there are two.
TEST(Ros2BagTest, TheMappingOfTheListHasTheOnlyTopicOfPoses) {
  const ScratchDir folder;
  const std::string type = "geometry_msgs/msg/PoseStamped";
  WriteSampleBag(folder / "one.mcap",
                 {TouchTopic("/touch"), {"/arm/pose", type, {{5, "x"}}}});
  WriteSampleBag(folder / "two.mcap", {TouchTopic("/touch"),
                                       {"/arm/pose", type, {{5, "x"}}},
                                       {"/cup/pose", type, {{5, "x"}}}});
  const auto one = SummarizeBag(folder / "one.mcap");
  ASSERT_TRUE(one.ok()) << one.status();
  EXPECT_THAT(SkinToStartFrom(*one),
              HasSubstr("\"pose_topic\": \"/arm/pose\",\n  \"rows\": 2,"));
  const auto two = SummarizeBag(folder / "two.mcap");
  ASSERT_TRUE(two.ok()) << two.status();
  EXPECT_THAT(SkinToStartFrom(*two), testing::Not(HasSubstr("\"pose_topic\"")));
}

// A folder of bags: a file, a folder as rosbag2 makes it, and one without
// metadata.yaml, whose recorder was killed.
TEST(Ros2BagTest, ImportsAFolderOfBagsByATable) {
  const ScratchDir folder;
  WriteBytes(folder / "skin.json", std::string(kTouchSkin) + "}");
  std::filesystem::create_directories(folder / "bags/b");
  std::filesystem::create_directories(folder / "bags/c");
  WriteSampleBag(folder / "bags/a.mcap", {TouchTopic("/touch")});
  WriteSampleBag(folder / "bags/b/b_0.mcap", {TouchTopic("/touch")});
  WriteBytes(folder / "bags/b/metadata.yaml", "rosbag2_bagfile_information:");
  WriteSampleBag(folder / "bags/c/c_0.mcap", {TouchTopic("/touch")}, false);
  WriteBytes(folder / "table.csv",
             "frames,label\na.mcap,x\nb,y\nc,y\nb/b_0.mcap:/touch,z\n");
  const auto trials = ImportAll(
      folder / "bags",
      {.mapping = folder / "skin.json", .table = folder / "table.csv"});
  ASSERT_TRUE(trials.ok()) << trials.status();
  ASSERT_EQ(trials->size(), 4U);
  for (const Trial& trial : *trials) {
    EXPECT_EQ(trial.taxels.frames(), 40U) << trial.source;
  }
  EXPECT_EQ(trials->at(2).label, "y");
  EXPECT_TRUE(SummarizeBag(folder / "bags/b")->cut_off.empty());
  EXPECT_THAT(SummarizeBag(folder / "bags/c")->cut_off,
              ElementsAre(HasSubstr("has no end")));
  const std::string whole = ReadBytes(folder / "bags/a.mcap");
  WriteBytes(folder / "bags/a.mcap", whole.substr(0, whole.size() - 9));
  EXPECT_THAT(SummarizeBag(folder / "bags/a.mcap")->cut_off,
              ElementsAre(HasSubstr("was cut off")));
}

void RunSql(const std::string& path, const std::string& sql) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr),
            SQLITE_OK)
      << sqlite3_errmsg(database);
  sqlite3_close(database);
}

std::string Hex(const std::string& bytes) {
  std::string text;
  for (const char byte : bytes) {
    absl::StrAppend(&text,
                    absl::Hex(static_cast<uint8_t>(byte), absl::kZeroPad2));
  }
  return text;
}

constexpr char kSqliteTables[] =
    "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT "
    "NOT NULL, serialization_format TEXT NOT NULL, offered_qos_profiles TEXT);"
    "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, "
    "timestamp INTEGER NOT NULL, data BLOB NOT NULL);";

// The same messages in SQLite, over two files of which ten sorts last.
TEST(Ros2BagTest, ImportsSqliteAsMcap) {
  const ScratchDir folder;
  const SampleTopic topic = TouchTopic("/touch");
  std::filesystem::create_directories(folder / "run");
  for (const int part : {2, 10}) {
    std::string sql =
        absl::StrCat(kSqliteTables, "INSERT INTO topics VALUES(", part,
                     ", '/touch', '", topic.type, "', 'cdr', '');");
    for (int i = part == 2 ? 0 : 15; i < (part == 2 ? 15 : 40); ++i) {
      absl::StrAppend(&sql, "INSERT INTO messages VALUES(NULL, ", part, ", ",
                      topic.messages[i].time_ns, ", x'",
                      Hex(topic.messages[i].bytes), "');");
    }
    RunSql(folder / absl::StrCat("run/run_", part, ".db3"), sql);
  }
  WriteSampleBag(folder / "run.mcap", {topic});
  const auto mcap = ReadRos2Bag(folder / "run.mcap", {.frames = "/touch"});
  const auto sqlite = ReadRos2Bag(folder / "run", {.frames = "/touch"});
  ASSERT_TRUE(mcap.ok()) << mcap.status();
  ASSERT_TRUE(sqlite.ok()) << sqlite.status();
  EXPECT_EQ(mcap->array.f64, sqlite->array.f64);
  EXPECT_THAT(mcap->array.shape, ElementsAre(40, 7));
}

// Reading leaves nothing beside the bag, and its name may be anything.
TEST(Ros2BagTest, LeavesTheFolderOfABagAlone) {
  const ScratchDir folder;
  const std::string path = folder / "a?b#c%d.db3";
  WriteBytes(path, ReadBytes(kGoldenBags + "talker_db3/talker.db3"));
  const auto summary = SummarizeBag(path);
  ASSERT_TRUE(summary.ok()) << summary.status();
  EXPECT_EQ(summary->messages, 20U);
  EXPECT_EQ(folder.files(), 1U);
}

// The log of a recorder that was killed holds messages that the file does not.
TEST(Ros2BagTest, ReadsTheLogOfARecorderThatWasKilled) {
  const ScratchDir folder;
  const std::string live = folder / "live.db3";
  sqlite3* recorder = nullptr;
  ASSERT_EQ(sqlite3_open(live.c_str(), &recorder), SQLITE_OK);
  const std::string sql = absl::StrCat(
      "PRAGMA journal_mode = WAL;", kSqliteTables,
      "INSERT INTO topics VALUES(1, '/a', 'std_msgs/msg/String', 'cdr', '');"
      "INSERT INTO messages VALUES(NULL, 1, 5, x'00010000020000006100');");
  ASSERT_EQ(sqlite3_exec(recorder, sql.c_str(), nullptr, nullptr, nullptr),
            SQLITE_OK);
  // As it lies on the disk before the recorder closes it.
  WriteBytes(folder / "a.db3", ReadBytes(live));
  WriteBytes(folder / "a.db3-wal", ReadBytes(live + "-wal"));
  sqlite3_close(recorder);
  const auto summary = SummarizeBag(folder / "a.db3");
  ASSERT_TRUE(summary.ok()) << summary.status();
  EXPECT_EQ(summary->messages, 1U);
}

// A type of which the bag holds the definition, and the poses beside it.
TEST(Ros2BagTest, ReadsTypesThatTheBagDefinesAndPoses) {
  const ScratchDir folder;
  constexpr char kDefinition[] = R"(# As that of XELA.
uint8 KIND = 3
string<=8 model "x#1"
SensorFull[] sensors
===============================================================================
MSG: xela_server_ros2/SensorFull
uint32 message
Taxel[] taxels
===============================================================================
MSG: xela_server_ros2/Taxel
int16 x
int16 y
int16 z
)";
  CdrText skin;
  skin.PutText("m").Put(uint32_t{1}).Put(uint32_t{9}).Put(uint32_t{2});
  for (const int16_t value : {1, 2, -3, 4, 5, 6}) skin.Put(value);
  CdrText pose;
  pose.PutHeader();
  for (const double value : {1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0}) {
    pose.Put(value);
  }
  WriteSampleBag(
      folder / "a.mcap",
      {{"/x",
        "xela_server_ros2/msg/SensStream",
        {{10, skin.Done()}},
        kDefinition},
       {"/pose", "geometry_msgs/msg/PoseStamped", {{5, pose.Done()}}}});
  const auto file =
      ReadRos2Bag(folder / "a.mcap", {.frames = "/x", .pose = "/pose"});
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->array.f64,
              ElementsAre(0, 1, 2, 3, 0, 0, 0, 1, 1, 2, -3, 4, 5, 6));
  const auto one = ReadRos2Bag(folder / "a.mcap",
                               {.frames = "/x", .values = "sensors.taxels.z"});
  ASSERT_TRUE(one.ok()) << one.status();
  EXPECT_THAT(one->array.f64, ElementsAre(0, -3, 6));
}

TEST(Ros2BagTest, NamesEveryMistake) {
  const ScratchDir folder;
  SampleTopic uneven = TouchTopic("/uneven");
  uneven.messages[3].bytes = ArrayMessage<float>({}, {1, 2});
  SampleTopic cut = TouchTopic("/cut");
  cut.messages[1].bytes.resize(30);
  SampleTopic huge = TouchTopic("/huge");
  huge.messages[0].bytes =
      CdrText().Put(uint32_t{0}).Put(uint32_t{0}).Put(~uint32_t{0}).Done();
  WriteSampleBag(folder / "a.mcap", {uneven, cut, huge});
  const std::pair<std::string, std::string> cases[] = {
      {"/absent", "has no message; the bag holds /uneven, /cut, /huge"},
      {"/uneven", "message 4: has 2 numbers; the first message has 6"},
      {"/cut", "message 2: message of "},
      {"/huge", "has too many parts, within data"}};
  for (const auto& [topic, text] : cases) {
    const auto file = ReadRos2Bag(folder / "a.mcap", {.frames = topic});
    EXPECT_EQ(ReasonOf(file.status()), "TRIAL_FILE_INVALID") << topic;
    EXPECT_THAT(std::string(file.status().message()), HasSubstr(text));
  }
  const auto field =
      ReadRos2Bag(folder / "a.mcap", {.frames = "/cut", .values = "force"});
  EXPECT_THAT(std::string(field.status().message()),
              HasSubstr("data, layout.data_offset, layout.dim.size"));

  EXPECT_EQ(ReasonOf(SummarizeBag(folder / "none.mcap").status()), "IO");
  WriteBytes(folder / "b.db3", "SQLite format 3");
  EXPECT_EQ(ReasonOf(SummarizeBag(folder / "b.db3").status()),
            "TRIAL_FILE_INVALID");
  RunSql(folder / "v.db3",
         "CREATE TABLE topics(id); CREATE VIEW messages AS SELECT 1;");
  EXPECT_THAT(std::string(SummarizeBag(folder / "v.db3").status().message()),
              HasSubstr("needs the tables topics, messages"));
  std::filesystem::create_directories(folder / "packed");
  WriteBytes(folder / "packed/p_0.db3.zstd", "x");
  EXPECT_THAT(std::string(SummarizeBag(folder / "packed").status().message()),
              HasSubstr("zstd -d"));
  const auto unlabelled =
      ImportAll(folder / "a.mcap", {.mapping = folder / "skin.json"});
  EXPECT_EQ(ReasonOf(unlabelled.status()), "INVALID_CONFIG");
  EXPECT_THAT(std::string(unlabelled.status().message()),
              HasSubstr("label of the import"));
  const auto unmapped = ImportAll(kGoldenBags + "talker_db3");
  EXPECT_EQ(ReasonOf(unmapped.status()), "INVALID_CONFIG");
  EXPECT_THAT(std::string(unmapped.status().message()), HasSubstr("--list"));
}

// A type may say that a few bytes are very many elements.
TEST(Ros2BagTest, BoundsWhatAMessageTakes) {
  std::string definition = "T1[10000] a\n";
  for (int i = 1; i < 9; ++i) {
    absl::StrAppend(&definition, "===\nMSG: p/T", i, "\nT", i + 1,
                    "[10000] a\n");
  }
  absl::StrAppend(&definition, "===\nMSG: p/T9\n");
  const auto type = Ros2Type::Parse("p/msg/T0", definition);
  ASSERT_TRUE(type.ok()) << type.status();
  EXPECT_FALSE(type->Read(CdrText().Done()).ok());
  const auto endless = Ros2Type::Parse("p/msg/T0", "T0 again");
  ASSERT_TRUE(endless.ok()) << endless.status();
  EXPECT_THAT(std::string(endless->Read(CdrText().Done()).status().message()),
              HasSubstr("without end"));
}

// Every prefix of a message is refused or a message; so is each changed byte.
TEST(Ros2BagTest, DamagedMessagesAreNoCrash) {
  const auto type = *Ros2Type::Parse("std_msgs/msg/UInt16MultiArray", "");
  const std::string good = ArrayMessage<uint16_t>({2, 2}, {1, 2, 3, 4});
  ASSERT_TRUE(type.Read(good).ok());
  for (size_t size = 0; size < good.size(); ++size) {
    EXPECT_FALSE(type.Read(good.substr(0, size)).ok()) << size;
  }
  for (size_t at = 0; at < good.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string bytes = good;
      bytes[at] = static_cast<char>(bytes[at] ^ (1 << bit));
      const auto read = type.Read(bytes);
      if (!read.ok()) {
        EXPECT_EQ(ReasonOf(read.status()), "TRIAL_FILE_INVALID");
      }
    }
  }
}

}  // namespace
}  // namespace tactus::internal
