// Pictures of skins, and contacts on them, for Foxglove's panels.
#include <cmath>
#include <cstring>
#include <random>
#include <set>

#include "core/data/recording/foxglove_contacts.h"
#include "core/data/recording/foxglove_image.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/data/foreign_decoder.h"

namespace tactus::internal {
namespace {

using google::protobuf::Message;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

SkinLayout SmallSkin(int rows, int columns) {
  SkinLayout layout = *LayoutPreset("cody-forearm");
  layout.rows = rows;
  layout.columns = columns;
  layout.onset_threshold = 0.25;
  return layout;
}

std::vector<float> PixelsOf(const Message& image) {
  const auto* data = image.GetDescriptor()->FindFieldByName("data");
  const std::string bytes = image.GetReflection()->GetString(image, data);
  std::vector<float> pixels(bytes.size() / sizeof(float));
  std::memcpy(pixels.data(), bytes.data(), bytes.size());
  return pixels;
}

TEST(FoxgloveImageTest, BrightnessIsTheLoadBetweenBlackAndWhite) {
  SkinLayout layout = SmallSkin(2, 3);
  layout.mask = {1, 1, 1, 1, 0, 1};
  const FoxgloveImage image(layout);
  ForeignDecoder decoder(FoxgloveImage::Schema());
  const float infinite = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  // With four onset thresholds in 1 N, 1 N is half as bright as white.
  const auto message = decoder.Decode(image.EncodeFloats(
      1'500'000'000, std::vector<float>{0, 1, 3, infinite, 7, nan}));
  EXPECT_THAT(message->ShortDebugString(),
              AllOf(HasSubstr("timestamp { seconds: 1 nanos: 500000000 }"),
                    HasSubstr("width: 3 height: 2 encoding: \"32FC1\" "
                              "step: 12 data: "),
                    HasSubstr("frame_id: \"cody-forearm\"")));
  EXPECT_EQ(PixelsOf(*message), (std::vector<float>{0, 0.5F, 0.75F, 1, 0, 0}));
}

TEST(FoxgloveImageTest, OfThreeAxesItShowsTheNormalLoad) {
  SkinLayout layout = SmallSkin(1, 2);
  layout.axes = 3;
  layout.signed_values = true;
  layout.normal_axis = 2;
  const std::vector<float> values = {9, -9, 1, 5, 5, -1};
  ForeignDecoder decoder(FoxgloveImage::Schema());
  EXPECT_EQ(
      PixelsOf(*decoder.Decode(FoxgloveImage(layout).EncodeFloats(0, values))),
      (std::vector<float>{0.5F, 0}));
  // Without a normal axis, the distance from 0.
  layout.normal_axis.reset();
  EXPECT_EQ(PixelsOf(*decoder.Decode(FoxgloveImage(layout).EncodeFloats(
                0, std::vector<float>{3, 0, 0, -2, 1, 2}))),
            (std::vector<float>{0.75F, 0.75F}));
}

v1::Contact* AddContact(uint64_t id, const std::vector<uint32_t>& taxels,
                        v1::Answer& answer) {
  v1::Contact* contact = answer.add_contacts();
  contact->set_id(id);
  contact->mutable_patch()->mutable_taxels()->Add(taxels.begin(), taxels.end());
  return contact;
}

struct Line {
  double x0 = 0;
  double y0 = 0;
  double x1 = 0;
  double y1 = 0;
};

std::vector<const Message*> PartsOf(const Message& message, const char* name) {
  const auto* field = message.GetDescriptor()->FindFieldByName(name);
  std::vector<const Message*> parts;
  for (int i = 0; i < message.GetReflection()->FieldSize(message, field); ++i) {
    parts.push_back(
        &message.GetReflection()->GetRepeatedMessage(message, field, i));
  }
  return parts;
}

double NumberOf(const Message& message, const char* name) {
  const auto* field = message.GetDescriptor()->FindFieldByName(name);
  return message.GetReflection()->GetDouble(message, field);
}

std::vector<Line> LinesOf(const Message& outline) {
  const auto points = PartsOf(outline, "points");
  EXPECT_EQ(points.size() % 2, 0u);
  std::vector<Line> lines;
  for (size_t i = 0; i + 1 < points.size(); i += 2) {
    lines.push_back({NumberOf(*points[i], "x"), NumberOf(*points[i], "y"),
                     NumberOf(*points[i + 1], "x"),
                     NumberOf(*points[i + 1], "y")});
  }
  return lines;
}

// True if a ray from the middle of a taxel to the left crosses the outline an
// odd number of times.
bool IsWithin(const std::vector<Line>& lines, int row, int column) {
  bool within = false;
  for (const Line& line : lines) {
    if (line.x0 == line.x1 && line.x0 < column + 0.5 &&
        std::min(line.y0, line.y1) < row + 0.5 &&
        std::max(line.y0, line.y1) > row + 0.5) {
      within = !within;
    }
  }
  return within;
}

// The same for a ray upwards.
bool IsBelow(const std::vector<Line>& lines, int row, int column) {
  bool below = false;
  for (const Line& line : lines) {
    if (line.y0 == line.y1 && line.y0 < row + 0.5 &&
        std::min(line.x0, line.x1) < column + 0.5 &&
        std::max(line.x0, line.x1) > column + 0.5) {
      below = !below;
    }
  }
  return below;
}

TEST(FoxgloveContactsTest, OutlinesEncloseTheTaxelsOfAContactAndNoOthers) {
  constexpr int kRows = 7;
  constexpr int kColumns = 9;
  const FoxgloveContacts contacts(SmallSkin(kRows, kColumns), {});
  ForeignDecoder decoder(FoxgloveContacts::Schema());
  std::mt19937 random(5);
  for (int round = 0; round < 50; ++round) {
    std::set<uint32_t> taxels = {static_cast<uint32_t>(round)};
    for (int i = 0; i < round; ++i)
      taxels.insert(random() % (kRows * kColumns));
    v1::Answer answer;
    AddContact(1, {taxels.begin(), taxels.end()}, answer);
    const auto message = decoder.Decode(contacts.Encode(answer));
    const auto outlines = PartsOf(*message, "points");
    ASSERT_EQ(outlines.size(), 1u);
    const std::vector<Line> lines = LinesOf(*outlines[0]);
    for (int row = 0; row < kRows; ++row) {
      for (int column = 0; column < kColumns; ++column) {
        const bool touched =
            taxels.contains(static_cast<uint32_t>(row * kColumns + column));
        ASSERT_EQ(IsWithin(lines, row, column), touched);
        ASSERT_EQ(IsBelow(lines, row, column), touched);
      }
    }
  }
}

TEST(FoxgloveContactsTest, SaysWhatIsDecidedOfEachContact) {
  FoxgloveContacts::Questions questions;
  for (const auto& values : {std::vector<std::string>{"hard", "soft"},
                             std::vector<std::string>{"unmoved", "moved"}}) {
    v1::Question* question = questions.Add();
    question->mutable_values()->Add(values.begin(), values.end());
  }
  const FoxgloveContacts contacts(SmallSkin(24, 10), questions);
  v1::Answer answer;
  answer.set_capture_time_ns(2'000'000'001);
  const auto decide = [&](v1::Contact* contact, std::vector<int> values) {
    for (const int value : values) {
      v1::QuestionAnswer* decided = contact->add_answers();
      if (value < 0) continue;
      decided->mutable_decision()->set_value(static_cast<uint32_t>(value));
    }
  };
  decide(AddContact(11, {0}, answer), {-1, -1});
  decide(AddContact(12, {50, 51}, answer), {0, 1});
  decide(AddContact(13, {100}, answer), {-1, 0});
  AddContact(14, {200}, answer)->set_unknown(0.9);
  // No value of a question, and more answers than questions.
  decide(AddContact(15, {210}, answer), {7, 1, 0});
  // Not felt now; and taxels that the skin does not have.
  answer.add_contacts()->set_id(16);
  AddContact(17, {5'000'000}, answer);
  ForeignDecoder decoder(FoxgloveContacts::Schema());
  const auto message = decoder.Decode(contacts.Encode(answer));
  std::vector<std::string> texts;
  for (const Message* text : PartsOf(*message, "texts")) {
    const auto* field = text->GetDescriptor()->FindFieldByName("text");
    texts.push_back(text->GetReflection()->GetString(*text, field));
    // A letter is a twelfth of the picture.
    EXPECT_EQ(NumberOf(*text, "font_size"), 2);
  }
  EXPECT_THAT(texts,
              testing::ElementsAre("11", "12: hard, moved", "13: unmoved",
                                   "14: unknown", "15: moved"));
  EXPECT_THAT(message->ShortDebugString(),
              HasSubstr("timestamp { seconds: 2 nanos: 1 }"));
  // Below the first contact, which touches the upper edge; above the second.
  EXPECT_THAT(PartsOf(*message, "texts")[0]->ShortDebugString(),
              HasSubstr("position { y: 3 }"));
  EXPECT_THAT(PartsOf(*message, "texts")[1]->ShortDebugString(),
              HasSubstr("position { y: 5 }"));
}

// The outlines of before must go.
TEST(FoxgloveContactsTest, WithoutContactsThereIsAnEmptyPicture) {
  const FoxgloveContacts contacts(SmallSkin(4, 4), {});
  ForeignDecoder decoder(FoxgloveContacts::Schema());
  const auto message = decoder.Decode(contacts.Encode(v1::Answer()));
  EXPECT_THAT(PartsOf(*message, "points"), IsEmpty());
  EXPECT_THAT(PartsOf(*message, "texts"), IsEmpty());
  EXPECT_THAT(message->ShortDebugString(), HasSubstr("timestamp {"));
}

}  // namespace
}  // namespace tactus::internal
