// Which line a skin is on, what it sends, and how often.
#include "client/drivers/serial/serial_search.h"

#include <termios.h>

#include <filesystem>

#include "core/base/errors.h"
#include "core/base/random.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/anyskin/anyskin_bytes.h"
#include "tests/client/drivers/serial/talking_skin.h"
#include "tests/support/scratch_dir.h"
#include "tools/common/skin_source.h"

namespace tactus::internal::client {
namespace {

using ::testing::AllOf;
using testing::AnySkinFrame;
using testing::AsBytes;
using testing::AsciiFrame;
using testing::BinaryFrame;
using testing::Chips;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Pty;
using testing::TalkingSkin;
using testing::Values;

// Frames of random values, 10 ms apart.
std::optional<SerialShape> ShapeOf(SerialFormat format, size_t rows,
                                   size_t columns, int frames,
                                   const std::string& before = "") {
  Random random(3);
  SerialShapeFinder finder(format);
  finder.Add(AsBytes(before), 0);
  for (int f = 0; f < frames; ++f) {
    Values values(rows * columns);
    for (uint16_t& value : values) {
      value = static_cast<uint16_t>(random.Index(256));
    }
    finder.Add(AsBytes(format == SerialFormat::kAscii
                           ? AsciiFrame(values, static_cast<int>(columns))
                           : BinaryFrame(values)),
               10'000'000 * f);
  }
  return finder.shape();
}

TEST(SerialShapeTest, AsciiShowsRowsColumnsAndRate) {
  for (const auto& [rows, columns] :
       {std::pair<size_t, size_t>(12, 32), {1, 1}, {64, 64}, {16, 32}}) {
    const auto shape = ShapeOf(SerialFormat::kAscii, rows, columns, 20, "5 6");
    ASSERT_TRUE(shape) << rows << " x " << columns;
    EXPECT_EQ(shape->rows, rows);
    EXPECT_EQ(shape->columns, columns);
    EXPECT_EQ(shape->taxels, rows * columns);
    EXPECT_NEAR(shape->rate_hz, 100, 1e-6);
  }
}

TEST(SerialShapeTest, Aa55ShowsTheNumberOfTaxelsAndTheRate) {
  for (const auto& [rows, columns] :
       {std::pair<size_t, size_t>(16, 32), {1, 1}, {64, 64}}) {
    const auto shape =
        ShapeOf(SerialFormat::kAa55, rows, columns, 20, "\x01\xAA\xAA");
    ASSERT_TRUE(shape) << rows << " x " << columns;
    EXPECT_EQ(shape->taxels, rows * columns);
    EXPECT_EQ(shape->rows, 0u);
    EXPECT_NEAR(shape->rate_hz, 100, 1e-6);
  }
}

TEST(SerialShapeTest, FewFramesAndOtherBytesAreNoShape) {
  EXPECT_FALSE(ShapeOf(SerialFormat::kAscii, 2, 3, 4));
  EXPECT_FALSE(ShapeOf(SerialFormat::kAa55, 2, 3, 4));
  for (const SerialFormat format :
       {SerialFormat::kAscii, SerialFormat::kAa55}) {
    SerialShapeFinder finder(format);
    Random random(9);
    for (int i = 0; i < 200'000; ++i) {
      const uint8_t byte = static_cast<uint8_t>(random.Index(256));
      finder.Add({&byte, 1}, i);
    }
    for (int i = 0; i < 100; ++i) {
      finder.Add(AsBytes("$GPGGA,123519,4807.038,N\r\nok 1 2 3\r\n\r\n"), i);
    }
    EXPECT_FALSE(finder.shape());
  }
}

// A taxel pattern like a sync word stays until it changes.
TEST(SerialShapeTest, ATaxelThatLooksLikeASyncWordDoesNotConfuse) {
  Values values(20);
  values[7] = 0xAA;
  values[8] = 0x55;
  SerialShapeFinder finder(SerialFormat::kAa55);
  for (int f = 0; f < 10; ++f) finder.Add(AsBytes(BinaryFrame(values)), f);
  ASSERT_TRUE(finder.shape());
  EXPECT_EQ(finder.shape()->taxels, 20u);
}

TEST(SerialShapeTest, AfterLostBytesAndAnotherShapeItIsFoundAgain) {
  SerialShapeFinder finder(SerialFormat::kAa55);
  const std::string small = BinaryFrame(Values(6, 1));
  for (int f = 0; f < 10; ++f) finder.Add(AsBytes(small), f);
  EXPECT_EQ(finder.shape()->taxels, 6u);
  finder.Add(AsBytes(small.substr(0, 5)), 10);
  finder.Add(AsBytes(small), 11);
  EXPECT_FALSE(finder.shape());
  const std::string large = BinaryFrame(Values(9, 1));
  for (int f = 0; f < 10; ++f) finder.Add(AsBytes(large), f);
  ASSERT_TRUE(finder.shape());
  EXPECT_EQ(finder.shape()->taxels, 9u);
  SerialShapeFinder lines(SerialFormat::kAscii);
  for (int f = 0; f < 10; ++f) lines.Add(AsBytes("1 2\n3 4\n\n"), f);
  EXPECT_EQ(lines.shape()->rows, 2u);
  for (int f = 0; f < 5; ++f) lines.Add(AsBytes("1 2 3\n\n"), f);
  ASSERT_TRUE(lines.shape());
  EXPECT_EQ(lines.shape()->rows, 1u);
  EXPECT_EQ(lines.shape()->columns, 3u);
}

TEST(SerialShapeTest, ShapesAreThoseOfLayouts) {
  EXPECT_EQ(ShapesOf(512), "8 x 64, 16 x 32, 32 x 16, 64 x 8");
  EXPECT_EQ(ShapesOf(67), "none");
  EXPECT_EQ(ShapesOf(0), "none");
}

// A machine with lines in a folder, some of which are named by links.
class SerialSearchTest : public ::testing::Test {
 protected:
  SerialSearchTest() {
    std::filesystem::create_directories(folder_ / "by-id");
    search_.by_id = folder_ / "by-id";
    search_.devices = folder_.path();
    search_.listen_ns = 500'000'000;
  }
  void Plug(const Pty& pty, const std::string& device,
            const std::string& name = "") {
    std::filesystem::create_symlink(pty.path(), folder_ / device);
    if (name.empty()) return;
    std::filesystem::create_symlink("../" + device, folder_ / "by-id/" + name);
  }

  const ScratchDir folder_;
  SerialSearch search_;
};

const Values kSix = {1, 2, 3, 4, 5, 6};

TEST_F(SerialSearchTest, LinesAreListedOnceByTheirName) {
  const Pty a;
  const Pty b;
  const Pty c;
  Plug(a, "ttyUSB0", "usb-skin");
  Plug(b, "ttyACM1");
  Plug(c, "ttyS0");
  std::filesystem::create_symlink("gone", folder_ / "by-id/usb-gone");
  EXPECT_THAT(SerialLines(search_),
              ElementsAre(folder_ / "by-id/usb-skin", folder_ / "ttyACM1"));
}

TEST_F(SerialSearchTest, TheOneSkinIsFoundAmongOtherLines) {
  const Pty silent;
  const Pty other;
  const Pty skin;
  Plug(silent, "ttyUSB0");
  Plug(other, "ttyUSB1", "usb-gps");
  Plug(skin, "ttyUSB2", "usb-skin");
  const TalkingSkin gps(other, {"$GPGGA,123519,4807.038,N\r\n"});
  const TalkingSkin talking(skin, {AsciiFrame(kSix, 3)});
  const auto found = FindSerialSkin(SerialFormat::kAscii, search_);
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_EQ(found->path, folder_ / "by-id/usb-skin");
  ASSERT_TRUE(found->shape);
  EXPECT_EQ(found->shape->rows, 2u);
  EXPECT_GT(found->shape->rate_hz, 1);
  EXPECT_THAT(ToText(*found), HasSubstr("usb-skin: 2 x 3 taxels at "));
}

TEST_F(SerialSearchTest, NoneAndSeveralAreListed) {
  auto found = FindSerialSkin(SerialFormat::kAscii, search_);
  EXPECT_EQ(ReasonOf(found.status()), "IO");
  EXPECT_THAT(std::string(found.status().message()),
              HasSubstr("there is no serial line"));
  const Pty a;
  const Pty b;
  Plug(a, "ttyUSB0");
  Plug(b, "ttyUSB1", "usb-b");
  WriteBytes(folder_ / "ttyUSB9", "no terminal");
  const TalkingSkin talking(b, {BinaryFrame(kSix)});
  found = FindSerialSkin(SerialFormat::kAscii, search_);
  EXPECT_EQ(ReasonOf(found.status()), "IO");
  EXPECT_THAT(
      std::string(found.status().message()),
      AllOf(HasSubstr("no skin sends frames in ascii"),
            HasSubstr("usb-b: 6 taxels at "), HasSubstr("Hz in aa55"),
            HasSubstr("ttyUSB0: sends nothing"), HasSubstr("ttyUSB9: ")));
  const TalkingSkin second(a, {BinaryFrame(kSix)});
  found = FindSerialSkin(SerialFormat::kAa55, search_);
  EXPECT_EQ(ReasonOf(found.status()), "INVALID_CONFIG");
  EXPECT_THAT(std::string(found.status().message()),
              AllOf(HasSubstr("usb-b"), HasSubstr("ttyUSB0"),
                    Not(HasSubstr("ttyUSB9"))));
}

// Another program's line keeps its settings, and gets no byte.
TEST_F(SerialSearchTest, LinesAreLeftAsTheyWere) {
  const Pty pty;
  Plug(pty, "ttyUSB0");
  const int line = open(pty.path().c_str(), O_RDWR | O_NOCTTY);
  ASSERT_GE(line, 0);
  termios before;
  ASSERT_EQ(tcgetattr(line, &before), 0);
  cfsetospeed(&before, B9600);
  before.c_lflag &= ~static_cast<tcflag_t>(ECHO);
  ASSERT_EQ(tcsetattr(line, TCSANOW, &before), 0);
  const TalkingSkin talking(pty, {"hello\r\n"});
  EXPECT_FALSE(FindSerialSkin(SerialFormat::kAscii, search_).ok());
  termios after;
  ASSERT_EQ(tcgetattr(line, &after), 0);
  EXPECT_EQ(cfgetospeed(&after), cfgetospeed(&before));
  EXPECT_EQ(after.c_lflag, before.c_lflag);
  EXPECT_EQ(after.c_iflag, before.c_iflag);
  EXPECT_EQ(after.c_oflag, before.c_oflag);
  EXPECT_FALSE(pty.WasWrittenTo());
  close(line);
}

TEST_F(SerialSearchTest, AMagneticSkinIsFoundByItsNumber) {
  const Pty magnetic;
  const Pty serial;
  Plug(magnetic, "ttyACM0", "usb-QT_Py");
  Plug(serial, "ttyUSB0");
  const std::string frame = AnySkinFrame(Chips(5, {25.5F, 300, -200, 1e3F}));
  const TalkingSkin fields(magnetic, {frame});
  const TalkingSkin talking(serial, {AsciiFrame(kSix, 3)});
  SkinSourceOptions options{.driver = "anyskin", .port = "auto", .magnets = 4};
  const absl::Status none = FindPort(options, search_).status();
  EXPECT_EQ(ReasonOf(none), "IO");
  EXPECT_THAT(
      std::string(none.message()),
      AllOf(HasSubstr("no skin sends frames of 4 magnetometers at 115200"),
            HasSubstr("usb-QT_Py: 5 magnetometers at "),
            HasSubstr("2 x 3 taxels at ")));
  options.magnets = 5;
  const auto text = FindPort(options, search_);
  ASSERT_TRUE(text.ok()) << text.status();
  EXPECT_THAT(*text, HasSubstr("5 magnetometers at "));
  EXPECT_EQ(options.port, folder_ / "by-id/usb-QT_Py");
  options = {.driver = "serial", .port = "auto"};
  ASSERT_TRUE(FindPort(options, search_).ok());
  EXPECT_EQ(options.port, folder_ / "ttyUSB0");
}

TEST_F(SerialSearchTest, APortThatIsNamedIsNotSearched) {
  SkinSourceOptions options{.driver = "serial", .port = "/dev/ttyUSB7"};
  EXPECT_EQ(*FindPort(options, search_), "");
  EXPECT_EQ(options.port, "/dev/ttyUSB7");
  const Pty pty;
  Plug(pty, "ttyUSB0", "usb-skin");
  const TalkingSkin talking(pty, {AsciiFrame(kSix, 3)});
  options.port = "auto";
  const auto text = FindPort(options, search_);
  ASSERT_TRUE(text.ok()) << text.status();
  EXPECT_THAT(*text, HasSubstr("2 x 3 taxels"));
  EXPECT_EQ(options.port, folder_ / "by-id/usb-skin");
}

}  // namespace
}  // namespace tactus::internal::client
