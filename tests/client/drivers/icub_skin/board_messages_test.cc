// Messages and frames against the example of the protocol's specification
// (TSD-ICUBUNIT-canprotocol-sensorboards, version 1.12).
#include "client/drivers/icub_skin/board_messages.h"

#include "client/drivers/icub_skin/triangle_frames.h"
#include "core/base/random.h"
#include "gtest/gtest.h"

namespace tactus::internal::client::icub {
namespace {

void ExpectBytes(const CanFrame& frame, uint32_t id,
                 std::initializer_list<uint8_t> bytes) {
  EXPECT_TRUE(frame.SameAs(MakeCanFrame(id, bytes)))
      << std::hex << frame.id << " with " << int{frame.size} << " bytes";
}

TEST(BoardMessagesTest, TheSpecificationsExampleComesOutByteForByte) {
  ExpectBytes(
      MakeMessage(
          1, BoardConfig{.compensation = 0, .period_ms = 50, .no_load = 0xF5}),
      0x201, {0x4D, 0x00, 0x32, 0xF5});
  ExpectBytes(MakeMessage(1, TriangleConfig{.first = 0,
                                            .last = 15,
                                            .shift = 2,
                                            .enabled = false,
                                            .converter_offset = 0x2200}),
              0x201, {0x50, 0x00, 0x0F, 0x02, 0x00, 0x00, 0x22});
  ExpectBytes(MakeMessage(1, TriangleConfig{.first = 0,
                                            .last = 1,
                                            .shift = 2,
                                            .enabled = true,
                                            .converter_offset = 0x2200}),
              0x201, {0x50, 0x00, 0x01, 0x02, 0x01, 0x00, 0x22});
  ExpectBytes(MakeTransmit(1, true), 0x201, {0x07, 0x00});
  ExpectBytes(MakeTransmit(1, false), 0x201, {0x07, 0x01});
  ExpectBytes(Discover(), 0x70F, {0xFF});
}

TEST(BoardMessagesTest, WhatIsMadeIsReadBack) {
  const BoardConfig board{.compensation = 2, .period_ms = 20, .no_load = 240};
  EXPECT_EQ(ReadBoardConfig(MakeMessage(7, board), 7), board);
  EXPECT_EQ(ReadBoardConfig(MakeMessage(7, board), 8), std::nullopt);
  const TriangleConfig triangles{.first = 3,
                                 .last = 9,
                                 .shift = 0,
                                 .enabled = false,
                                 .converter_offset = 0x1234};
  EXPECT_EQ(ReadTriangleConfig(MakeMessage(14, triangles), 14), triangles);
  EXPECT_EQ(ReadTransmit(MakeTransmit(2, true), 2), true);
  EXPECT_EQ(ReadTransmit(MakeTransmit(2, false), 2), false);
  EXPECT_EQ(ReadTransmit(MakeTransmit(2, false), 3), std::nullopt);
  for (const bool application : {true, false}) {
    const BoardReply reply{.address = 13,
                           .application = application,
                           .type = 11,
                           .major = 1,
                           .minor = 12,
                           .build = static_cast<uint8_t>(application ? 3 : 0)};
    EXPECT_EQ(ReadReply(MakeReply(reply)), reply);
  }
  EXPECT_TRUE(IsDiscover(Discover()));
}

TEST(BoardMessagesTest, RepliesOfAllSkinBoardsAreKnown) {
  // Board 1: application, mtb4, 2.15.3; then a bootloader.
  const auto reply =
      ReadReply(MakeCanFrame(0x710, {0xFF, 0x0B, 0x02, 0x0F, 0x03}));
  ASSERT_TRUE(reply.has_value());
  EXPECT_EQ(reply->address, 1);
  EXPECT_TRUE(reply->application);
  EXPECT_TRUE(reply->HasSkin());
  EXPECT_EQ(reply->minor, 15);
  const auto loader = ReadReply(MakeCanFrame(0x7E0, {0xFF, 0x05, 0x01, 0x00}));
  ASSERT_TRUE(loader.has_value());
  EXPECT_EQ(loader->address, 14);
  EXPECT_FALSE(loader->application);
  EXPECT_FALSE(BoardReply{.type = 3}.HasSkin());
  // From the host, from address 15, or of a wrong size.
  EXPECT_FALSE(ReadReply(MakeCanFrame(0x700, {0xFF, 5, 1, 0, 0})).has_value());
  EXPECT_FALSE(ReadReply(MakeCanFrame(0x7F0, {0xFF, 5, 1, 0, 0})).has_value());
  EXPECT_FALSE(ReadReply(MakeCanFrame(0x710, {0xFF, 5, 1})).has_value());
  EXPECT_FALSE(ReadReply(MakeCanFrame(0x710, {0xFE, 5, 1, 0})).has_value());
}

TEST(TriangleFramesTest, BytesLieWhereTheSpecificationPutsThem) {
  TriangleReading reading;
  for (int k = 0; k < kDots; ++k) reading.dots[k] = static_cast<uint8_t>(k + 1);
  // Dots 0, 4 and 11 out of range; not connected.
  reading.status = {.out_of_range = 1 << 0 | 1 << 4 | 1 << 11,
                    .no_answer = false,
                    .not_connected = true};
  const auto [head, tail] = EncodeTriangle(13, 5, reading);
  ExpectBytes(head, 0x4D5, {0x40, 1, 2, 3, 4, 5, 6, 7});
  ExpectBytes(tail, 0x4D5, {0xC0, 8, 9, 10, 11, 12, 0x81, 0x12});
  const auto part = DecodePart(tail);
  ASSERT_TRUE(part.has_value());
  EXPECT_EQ(part->address, 13);
  EXPECT_EQ(part->triangle, 5);
  EXPECT_TRUE(part->tail);
  EXPECT_EQ(part->status, reading.status);
  EXPECT_FALSE(part->status.IsValid());
}

TEST(TriangleFramesTest, ATailOfOldFirmwareHasNoStatus) {
  const auto part = DecodePart(MakeCanFrame(0x410, {0xC0, 8, 9, 10, 11, 12}));
  ASSERT_TRUE(part.has_value());
  EXPECT_EQ(part->dots[11], 12);
  EXPECT_TRUE(part->status.IsValid());
}

TEST(TriangleFramesTest, OtherSizesAndFirstBytesAreNoParts) {
  for (uint8_t size = 0; size <= 8; ++size) {
    CanFrame head = MakeCanFrame(0x410, {0x40, 1, 2, 3, 4, 5, 6, 7});
    head.size = size;
    EXPECT_EQ(DecodePart(head).has_value(), size == 8) << int{size};
    CanFrame tail = MakeCanFrame(0x410, {0xC0, 1, 2, 3, 4, 5, 6, 7});
    tail.size = size;
    EXPECT_EQ(DecodePart(tail).has_value(), size == 6 || size == 8);
  }
  for (int first = 0; first < 256; ++first) {
    const CanFrame frame =
        MakeCanFrame(0x410, {static_cast<uint8_t>(first), 1, 2, 3, 4, 5, 6, 7});
    EXPECT_EQ(DecodePart(frame).has_value(), first == 0x40 || first == 0xC0);
  }
  // Another class, the host, everyone, an extended id.
  for (const uint32_t id : {0x310U, 0x510U, 0x400U, 0x4F0U}) {
    EXPECT_FALSE(
        DecodePart(MakeCanFrame(id, {0x40, 1, 2, 3, 4, 5, 6, 7})).has_value());
  }
  CanFrame extended = MakeCanFrame(0x410, {0x40, 1, 2, 3, 4, 5, 6, 7});
  extended.extended = true;
  EXPECT_FALSE(DecodePart(extended).has_value());
}

TEST(TriangleFramesTest, AnyReadingComesBack) {
  Random random(5);
  for (int i = 0; i < 2'000; ++i) {
    TriangleReading reading;
    for (uint8_t& dot : reading.dots) {
      dot = static_cast<uint8_t>(random.Index(256));
    }
    reading.status.out_of_range = static_cast<uint16_t>(random.Index(4096));
    reading.status.no_answer = random.Index(2) == 1;
    reading.status.not_connected = random.Index(2) == 1;
    const int address = static_cast<int>(1 + random.Index(14));
    const int triangle = static_cast<int>(random.Index(16));
    const auto [head, tail] = EncodeTriangle(address, triangle, reading);
    const auto first = DecodePart(head);
    const auto second = DecodePart(tail);
    ASSERT_TRUE(first && second);
    TriangleReading back;
    for (int k = 0; k < kDots; ++k) {
      back.dots[k] = k < kHeadDots ? first->dots[k] : second->dots[k];
    }
    back.status = second->status;
    ASSERT_EQ(back, reading);
    ASSERT_EQ(first->address, address);
    ASSERT_EQ(second->triangle, triangle);
  }
}

}  // namespace
}  // namespace tactus::internal::client::icub
