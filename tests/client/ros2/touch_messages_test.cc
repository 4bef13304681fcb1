// Messages as the .msg files of client/ros2/tactus_msgs define them: the reader
// of bags reads them by the text of these files.
#include "client/ros2/touch_messages.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>

#include "absl/strings/str_cat.h"
#include "core/files/file_bytes.h"
#include "core/import/ros2/ros2_type.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal::client {
namespace {

using ::testing::ElementsAre;

// The type's own text, then that of all others.
std::string Definition(const std::string& name) {
  const std::filesystem::path folder =
      std::filesystem::path(std::getenv("TACTUS_SOURCE_DIR")) /
      "client/ros2/tactus_msgs/msg";
  std::string text = *ReadFileBytes(folder / (name + ".msg"), 1 << 20);
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().stem() == name) continue;
    absl::StrAppend(&text, "\n===\nMSG: tactus_msgs/",
                    entry.path().stem().string(), "\n",
                    *ReadFileBytes(entry.path(), 1 << 20));
  }
  return text;
}

Ros2Message Read(const std::string& name, const std::string& bytes) {
  const auto type =
      Ros2Type::Parse("tactus_msgs/msg/" + name, Definition(name));
  EXPECT_TRUE(type.ok()) << type.status();
  auto message = type->Read(bytes);
  EXPECT_TRUE(message.ok()) << message.status();
  return *std::move(message);
}

Contact FullContact() {
  Contact contact = {.id = 3, .state = Contact::State::kLost};
  contact.onset_sequence = 70;
  contact.since_onset_ns = 1'500'000'007;
  contact.patch = ContactPatch{.force = 4.5,
                               .max_force = 1.25,
                               .area_taxels = 9,
                               .area_m2 = 0.002,
                               .centroid_row = 7.5,
                               .centroid_column = 11.25};
  contact.patch->centroid.link = {0.1, 0.2, 0.3};
  contact.patch->centroid.link_normal = {0, 0, 1};
  contact.patch->centroid.world = Point3{1, 2, 3};
  contact.patch->centre_of_pressure = SkinSpot{.link = {0.4, 0.5, 0.6}};
  contact.motion_m = 0.01;
  contact.classes = {{"HU", 0.75}, {"SM", 0.25}};
  contact.answers = {
      {.question = "hardness",
       .values = {{"hard", 0.9}, {"soft", 0.1}},
       .decided = DecidedValue{.value = "hard",
                               .sequence = 80,
                               .since_onset_ns = 2'000'000'001,
                               .changes = 2,
                               .revised = true}},
      {.question = "mobility", .values = {{"moved", 0.5}, {"unmoved", 0.5}}}};
  contact.unknown = 0.125;
  contact.object = TouchedObject{.log10_stiffness = 2.5,
                                 .log10_stiffness_deviation = 0.5,
                                 .moved_m = 0.03,
                                 .moved_deviation_m = 0.004};
  contact.parent = 1;
  contact.merged_into = 2;
  return contact;
}

TEST(TouchMessagesTest, ContactsAreWhatTheirMsgFilesSay) {
  Answer answer = {.sequence = 100,
                   .capture_time_ns = 1'700'000'000'000'000'009};
  answer.contacts = {FullContact(), Contact{.id = 4}};
  answer.regions = 5;
  answer.frames_missing = 6;
  answer.is_final = true;
  const Ros2Message read = Read("Contacts", ContactsMessage(answer, "palm"));
  const auto& numbers = read.numbers;
  EXPECT_THAT(numbers.at("header.stamp.sec"), ElementsAre(1'700'000'000));
  EXPECT_THAT(numbers.at("header.stamp.nanosec"), ElementsAre(9));
  EXPECT_EQ(read.texts.at("header.frame_id"), "palm");
  EXPECT_THAT(numbers.at("frame"), ElementsAre(100));
  EXPECT_THAT(numbers.at("regions"), ElementsAre(5));
  EXPECT_THAT(numbers.at("frames_missing"), ElementsAre(6));
  EXPECT_THAT(numbers.at("is_final"), ElementsAre(1));
  const std::map<std::string, std::pair<double, double>> fields = {
      {"id", {3, 4}},
      {"state", {1, 0}},
      {"onset_frame", {70, 0}},
      {"since_onset.sec", {1, 0}},
      {"since_onset.nanosec", {500'000'007, 0}},
      {"has_patch", {1, 0}},
      {"force", {4.5, 0}},
      {"max_force", {1.25, 0}},
      {"area_taxels", {9, 0}},
      {"area_m2", {0.002, 0}},
      {"centroid_row", {7.5, 0}},
      {"centroid_column", {11.25, 0}},
      {"centroid.x", {0.1, 0}},
      {"centroid.y", {0.2, 0}},
      {"centroid.z", {0.3, 0}},
      {"normal.z", {1, 0}},
      {"centre_of_pressure.x", {0.4, 0}},
      {"centre_of_pressure.z", {0.6, 0}},
      {"has_world", {1, 0}},
      {"world.x", {1, 0}},
      {"world.z", {3, 0}},
      {"unknown", {0.125, 0}},
      {"has_object", {1, 0}},
      {"log10_stiffness", {2.5, 0}},
      {"log10_stiffness_deviation", {0.5, 0}},
      {"moved_m", {0.03, 0}},
      {"moved_deviation_m", {0.004, 0}},
      {"parent", {1, 0}},
      {"merged_into", {2, 0}}};
  for (const auto& [name, values] : fields) {
    EXPECT_THAT(numbers.at("contacts." + name),
                ElementsAre(values.first, values.second))
        << name;
  }
  EXPECT_EQ(numbers.at("contacts.motion_m")[0], 0.01);
  EXPECT_TRUE(std::isnan(numbers.at("contacts.motion_m")[1]));
  EXPECT_THAT(numbers.at("contacts.classes.probability"),
              ElementsAre(0.75, 0.25));
  EXPECT_EQ(read.texts.at("contacts.classes.name"), "SM");
  EXPECT_THAT(numbers.at("contacts.answers.values.probability"),
              ElementsAre(0.9, 0.1, 0.5, 0.5));
  EXPECT_EQ(read.texts.at("contacts.answers.values.name"), "unmoved");
  EXPECT_EQ(read.texts.at("contacts.answers.question"), "mobility");
  EXPECT_THAT(numbers.at("contacts.answers.decided_after.sec"),
              ElementsAre(2, 0));
  EXPECT_THAT(numbers.at("contacts.answers.decided_after.nanosec"),
              ElementsAre(1, 0));
  EXPECT_THAT(numbers.at("contacts.answers.changes"), ElementsAre(2, 0));
  EXPECT_THAT(numbers.at("contacts.answers.revised"), ElementsAre(1, 0));
}

TEST(TouchMessagesTest, EventsAreWhatTheirMsgFileSays) {
  const Event event = {.kind = EventKind::kDecided,
                       .contact = 2,
                       .sequence = 33,
                       .capture_time_ns = -1,
                       .since_onset_ns = 340'000'000,
                       .question = "hardness",
                       .value = "soft",
                       .other_contact = 9};
  const Ros2Message read = Read("ContactEvent", EventMessage(event, "palm"));
  // A time before 1970 has nanoseconds above 0 all the same.
  EXPECT_THAT(read.numbers.at("header.stamp.sec"), ElementsAre(-1));
  EXPECT_THAT(read.numbers.at("header.stamp.nanosec"),
              ElementsAre(999'999'999));
  EXPECT_THAT(read.numbers.at("frame"), ElementsAre(33));
  EXPECT_THAT(read.numbers.at("kind"), ElementsAre(2));
  EXPECT_THAT(read.numbers.at("contact"), ElementsAre(2));
  EXPECT_THAT(read.numbers.at("since_onset.nanosec"), ElementsAre(340'000'000));
  EXPECT_EQ(read.texts.at("question"), "hardness");
  EXPECT_EQ(read.texts.at("value"), "soft");
  EXPECT_THAT(read.numbers.at("other_contact"), ElementsAre(9));
}

}  // namespace
}  // namespace tactus::internal::client
