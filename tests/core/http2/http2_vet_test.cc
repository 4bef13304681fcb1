#include "core/http2/http2_vet.h"

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "core/base/limits_http2.h"
#include "core/base/random.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "nghttp2/nghttp2.h"
#include "tests/support/allocation_counter.h"

namespace tactus::internal {
namespace {

using ::testing::HasSubstr;

constexpr absl::string_view kPreface("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n");
constexpr uint8_t kData = 0;
constexpr uint8_t kHeaders = 1;
constexpr uint8_t kReset = 3;
constexpr uint8_t kSettings = 4;
constexpr uint8_t kPush = 5;
constexpr uint8_t kPing = 6;
constexpr uint8_t kGoAway = 7;
constexpr uint8_t kContinuation = 9;
constexpr uint8_t kEndHeaders = 4;
constexpr uint8_t kPadded = 8;
constexpr uint8_t kPriority = 32;

std::string Frame(uint8_t type, uint8_t flags, uint32_t stream,
                  absl::string_view payload) {
  std::string frame;
  const size_t size = payload.size();
  for (const int shift : {16, 8, 0}) {
    frame.push_back(static_cast<char>(size >> shift));
  }
  frame.push_back(static_cast<char>(type));
  frame.push_back(static_cast<char>(flags));
  for (const int shift : {24, 16, 8, 0}) {
    frame.push_back(static_cast<char>(stream >> shift));
  }
  return absl::StrCat(frame, payload);
}

std::string Hello() {
  return std::string(kPreface) + Frame(kSettings, 0, 0, "");
}

// Header blocks as nghttp2 writes them: with Huffman codes and its table.
class Deflater {
 public:
  Deflater() { nghttp2_hd_deflate_new(&deflater_, 4096); }
  ~Deflater() { nghttp2_hd_deflate_del(deflater_); }
  std::string Block(std::vector<std::pair<std::string, std::string>> fields) {
    std::vector<nghttp2_nv> list;
    for (auto& [name, value] : fields) {
      list.push_back({reinterpret_cast<uint8_t*>(name.data()),
                      reinterpret_cast<uint8_t*>(value.data()), name.size(),
                      value.size(), NGHTTP2_NV_FLAG_NONE});
    }
    std::string block(
        nghttp2_hd_deflate_bound(deflater_, list.data(), list.size()), '\0');
    const ssize_t size = nghttp2_hd_deflate_hd(
        deflater_, reinterpret_cast<uint8_t*>(block.data()), block.size(),
        list.data(), list.size());
    block.resize(static_cast<size_t>(size));
    return block;
  }

 private:
  nghttp2_hd_deflater* deflater_ = nullptr;
};

std::vector<std::pair<std::string, std::string>> Call(const std::string& path) {
  return {{":method", "POST"},
          {":scheme", "http"},
          {":path", path},
          {":authority", "arm.lab:50051"},
          {"content-type", "application/grpc"},
          {"te", "trailers"},
          {"authorization", "Bearer " + std::string(64, 'a')}};
}

std::span<const uint8_t> Bytes(absl::string_view text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

std::string FaultOf(absl::string_view bytes) {
  Http2Vet vet(Http2Vet::Peer::kClient);
  return std::string(vet.Check(Bytes(bytes), 1));
}

// A connection with many calls passes, in pieces of any size.
TEST(Http2VetTest, CallsPassInAnyPieces) {
  Deflater deflater;
  std::string bytes = Hello();
  for (uint32_t i = 0; i < 50; ++i) {
    const uint32_t stream = 2 * i + 1;
    const std::string block =
        deflater.Block(Call("/tactus.v1.ContactService/" + std::to_string(i)));
    if (i % 3 == 0) {
      bytes += Frame(kHeaders, 0, stream, block.substr(0, 5));
      bytes += Frame(kContinuation, 0, stream, "");
      bytes += Frame(kContinuation, kEndHeaders, stream, block.substr(5));
    } else if (i % 3 == 1) {
      bytes += Frame(kHeaders, kEndHeaders | kPriority, stream,
                     std::string(5, '\7') + block);
    } else {
      bytes += Frame(kHeaders, kEndHeaders, stream, block);
    }
    bytes += Frame(kData, 0, stream, std::string(773, 'x'));
    bytes += Frame(kData, 1, stream, "");
    bytes += Frame(kPing, 0, 0, "12345678");
    bytes += Frame(8, 0, 0, "1234");
  }
  bytes += Frame(kGoAway, 0, 0, "12345678");
  EXPECT_EQ(FaultOf(bytes), "");
  Random random(1);
  for (int round = 0; round < 200; ++round) {
    Http2Vet vet(Http2Vet::Peer::kClient);
    for (size_t at = 0; at < bytes.size();) {
      const size_t size =
          std::min(bytes.size() - at,
                   static_cast<size_t>(1 + random.Uniform() * (1 + round)));
      ASSERT_EQ(vet.Check(Bytes(bytes).subspan(at, size), 1), "") << at;
      at += size;
    }
  }
}

// What a server sends begins without the preface.
TEST(Http2VetTest, AServersBytesPass) {
  Deflater deflater;
  const std::string bytes =
      Frame(kSettings, 0, 0, "123456") +
      Frame(kHeaders, kEndHeaders, 1, deflater.Block({{":status", "200"}}));
  Http2Vet vet(Http2Vet::Peer::kServer);
  EXPECT_EQ(vet.Check(Bytes(bytes), 1), "");
}

// A server resets a call that it ends before the client has.
TEST(Http2VetTest, AServerMayResetManyCalls) {
  Http2Vet vet(Http2Vet::Peer::kServer);
  vet.Check(Bytes(Frame(kSettings, 0, 0, "")), 1);
  for (uint32_t i = 0; i < 5000; ++i) {
    ASSERT_EQ(vet.Check(Bytes(Frame(kReset, 0, 2 * i + 1, "1234")), 1), "");
  }
}

TEST(Http2VetTest, MessagesCostNoMemory) {
  Http2Vet vet(Http2Vet::Peer::kClient);
  ASSERT_EQ(vet.Check(Bytes(Hello()), 1), "");
  const std::string frame = Frame(kData, 0, 1, std::string(773, 'x'));
  const testing::AllocationCounter counter;
  for (int i = 0; i < 100; ++i) vet.Check(Bytes(frame), i);
  EXPECT_EQ(counter.count(), 0);
}

struct BadBytes {
  const char* name;
  std::string bytes;
  const char* fault;
};

void PrintTo(const BadBytes& bad, std::ostream* out) { *out << bad.name; }

std::string LiteralOfLength(absl::string_view length) {
  // A literal header without a name in the table, and the length of its name.
  return std::string("\0", 1) + std::string(length);
}

std::vector<BadBytes> AllBad() {
  const std::string four_gib =
      LiteralOfLength("\1x") + "\x7f\x80\xff\xff\xff\x0f";
  std::string flood = Frame(kHeaders, 0, 1, "");
  for (int i = 0; i < 100; ++i) {
    flood += Frame(kContinuation, 0, 1, std::string("\0\1a\1b", 5));
  }
  std::string small_headers;
  for (int i = 0; i < 1000; ++i) small_headers += std::string("\0\1a\1b", 5);
  std::string pings;
  for (int i = 0; i < 2000; ++i) pings += Frame(kPing, 0, 0, "12345678");
  std::string settings;
  for (int i = 0; i < 2000; ++i) settings += Frame(kSettings, 0, 0, "");
  std::string resets;
  for (int i = 0; i < 2000; ++i) resets += Frame(kReset, 0, 1, "1234");
  std::string updates;
  for (int i = 0; i < 200'000; ++i) updates += Frame(8, 0, 1, "1234");
  std::string goaways;
  for (int i = 0; i < 10; ++i) goaways += Frame(kGoAway, 0, 0, "12345678");
  Deflater deflater;
  return {
      {"Http1", "GET / HTTP/1.1\r\n\r\n", "HTTP/2"},
      {"NoSettings", std::string(kPreface) + Frame(kPing, 0, 0, "12345678"),
       "not SETTINGS"},
      {"ValueOf4GiB", Hello() + Frame(kHeaders, 0, 1, four_gib), "HPACK"},
      {"NumberWithoutEnd",
       Hello() + Frame(kHeaders, 0, 1,
                       LiteralOfLength("\x7f" + std::string(100, '\x80'))),
       "HPACK"},
      {"ReferenceToNothing", Hello() + Frame(kHeaders, kEndHeaders, 1, "\xfe"),
       "HPACK"},
      {"TableTooLarge",
       Hello() + Frame(kHeaders, kEndHeaders, 1, "\x3f\xff\xff\x01"), "HPACK"},
      {"BlockEndsWithinAHeader",
       Hello() + Frame(kHeaders, kEndHeaders, 1, std::string("\0\5ab", 4)),
       "HPACK"},
      {"ManyFrames", Hello() + flood, "too many frames"},
      {"ManyHeaders", Hello() + Frame(kHeaders, kEndHeaders, 1, small_headers),
       "too many headers"},
      {"DecodedTooLong",
       Hello() + Frame(kHeaders, kEndHeaders, 1,
                       deflater.Block({{"a", std::string(20'000, 'e')},
                                       {"b", std::string(20'000, 'e')}})),
       "too many headers"},
      {"LongBlock",
       Hello() + Frame(kHeaders, 0, 1, std::string(16384, '\x82')) +
           Frame(kContinuation, 0, 1, std::string(16384, '\x82')) +
           Frame(kContinuation, 0, 1, "\x82"),
       "too"},
      {"LongControlFrame",
       Hello() + Frame(kGoAway, 0, 0, std::string(100'000, 'x')), "too long"},
      {"FrameWithinABlock",
       Hello() + Frame(kHeaders, 0, 1, "\x82") + Frame(kData, 0, 1, "x"),
       "within a header block"},
      {"OtherStreamWithinABlock",
       Hello() + Frame(kHeaders, 0, 1, "\x82") +
           Frame(kContinuation, 0, 3, "\x82"),
       "CONTINUATION"},
      {"LoneContinuation", Hello() + Frame(kContinuation, 0, 1, "\x82"),
       "CONTINUATION"},
      {"StreamZero", Hello() + Frame(kHeaders, kEndHeaders, 0, "\x82"),
       "without a stream"},
      {"Padding",
       Hello() + Frame(kHeaders, kEndHeaders | kPadded, 1,
                       std::string("\1\x82\0", 3)),
       "padded"},
      {"ShortPriority",
       Hello() + Frame(kHeaders, kEndHeaders | kPriority, 1, "123"), "short"},
      {"Push", Hello() + Frame(kPush, 0, 1, "1234"), "pushes"},
      {"Pings", Hello() + pings, "PING"},
      {"Settings", Hello() + settings, "SETTINGS"},
      {"Resets", Hello() + resets, "RST_STREAM"},
      {"Updates", Hello() + updates, "without a message"},
      {"GoAways", Hello() + goaways, "GOAWAY"},
      {"HeaderThatAborts",
       Hello() + Frame(kHeaders, kEndHeaders, 1,
                       deflater.Block({{"grpclb_client_stats", "abc"}})),
       "grpclb_client_stats"},
  };
}

class Http2VetFaultTest : public ::testing::TestWithParam<BadBytes> {};

TEST_P(Http2VetFaultTest, IsFoundInAnyPieces) {
  const std::string& bytes = GetParam().bytes;
  EXPECT_THAT(FaultOf(bytes), HasSubstr(GetParam().fault));
  Http2Vet vet(Http2Vet::Peer::kClient);
  for (size_t at = 0; at < bytes.size(); ++at) {
    vet.Check(Bytes(bytes).subspan(at, 1), 1);
  }
  const std::string fault(vet.Check({}, 1));
  EXPECT_THAT(fault, HasSubstr(GetParam().fault));
  // A fault is final.
  EXPECT_EQ(vet.Check(Bytes(Frame(kPing, 0, 0, "12345678")), 1'000'000'000'000),
            fault);
}

INSTANTIATE_TEST_SUITE_P(All, Http2VetFaultTest, ::testing::ValuesIn(AllBad()),
                         [](const auto& test) { return test.param.name; });

// Any bytes end in a fault or in a pass, and do no harm.
TEST(Http2VetTest, RandomBytes) {
  Random random(7);
  for (int round = 0; round < 2000; ++round) {
    std::string bytes = Hello();
    for (int i = 0; i < 20; ++i) {
      std::string payload;
      const int size = static_cast<int>(random.Uniform() * 40);
      for (int k = 0; k < size; ++k) {
        payload.push_back(static_cast<char>(random.Uniform() * 256));
      }
      bytes += Frame(static_cast<uint8_t>(random.Uniform() * 11),
                     static_cast<uint8_t>(random.Uniform() * 48),
                     static_cast<uint32_t>(random.Uniform() * 4), payload);
    }
    FaultOf(bytes);
  }
}

}  // namespace
}  // namespace tactus::internal
