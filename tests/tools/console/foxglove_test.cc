// Who may watch from another program, and what hostile ones get.
#include <list>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/limits_console.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/tools/console/console_fixture.h"
#include "tools/console/watch_rights.h"

namespace tactus::internal::console {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr char kHello[] =
    "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
constexpr char kProtocol[] =
    "Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n";
constexpr char kStranger[] = "Origin: http://evil.example\r\n";

// A text of a client, masked with zeros.
std::string ClientText(const std::string& text) {
  std::string frame = "\x81";
  if (text.size() < 126) {
    frame += static_cast<char>(0x80 | text.size());
  } else {
    frame += '\xfe';
    frame += static_cast<char>(text.size() >> 8);
    frame += static_cast<char>(text.size());
  }
  return absl::StrCat(frame, std::string(4, '\0'), text);
}

// How the console ends a connection with a code and a reason.
std::string Closing(int code) {
  return {static_cast<char>(code >> 8), static_cast<char>(code)};
}

class FoxgloveTest : public ConsoleTest {
 protected:
  // The response, and what follows it, to one who says nothing more.
  std::string Watch(const std::string& target,
                    const std::string& header = "") const {
    return Ask(absl::StrCat("GET ", target),
               absl::StrCat(kHello, kProtocol, header));
  }
  std::string KeyOf(const std::string& session) const {
    return After(session, "\"watch_key\":\"", '"');
  }
  // Opens a connection; returns what the console says at once.
  std::string Connect(const std::string& target,
                      const RawConnection& connection) const {
    connection.Send(RequestOf(absl::StrCat("GET ", target),
                              absl::StrCat(kHello, kProtocol), ""));
    return connection.ReadUntil("serverInfo");
  }
};

constexpr char kWelcome[] = "HTTP/1.1 101";
constexpr char kRefused[] = "HTTP/1.1 403";

TEST_F(FoxgloveTest, WithoutTokensProgramsOfThisMachineMayWatch) {
  Start(false);
  const std::string welcome = Watch("/foxglove");
  EXPECT_THAT(welcome, StartsWith(kWelcome));
  EXPECT_THAT(welcome,
              HasSubstr("Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n"));
  EXPECT_THAT(welcome, HasSubstr("\"op\":\"serverInfo\""));
  EXPECT_THAT(Ask("GET /foxglove",
                  absl::StrCat(kHello,
                               "Sec-WebSocket-Protocol: foxglove.websocket.v1, "
                               "foxglove.sdk.v1\r\n")),
              HasSubstr("Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n"));
  EXPECT_THAT(Ask("GET /foxglove", kHello), StartsWith("HTTP/1.1 400"));
  for (const char* target : {"/foxglove/", "/foxglov", "/x?/foxglove"}) {
    EXPECT_THAT(Watch(target), StartsWith("HTTP/1.1 404")) << target;
  }
  EXPECT_THAT(Ask("GET /foxglove"), StartsWith("HTTP/1.1 404"));

  // Pages of others may not, whatever they call themselves.
  for (const char* origin : {"http://evil.example", "null", ""}) {
    EXPECT_THAT(Watch("/foxglove", absl::StrCat("Origin: ", origin, "\r\n")),
                StartsWith(kRefused))
        << origin;
  }
  EXPECT_THAT(Watch("/foxglove", OwnOrigin()), StartsWith(kWelcome));
  const std::string key = KeyOf(Ask("GET /api/session"));
  ASSERT_EQ(key.size(), 64u);
  EXPECT_THAT(Watch("/foxglove?key=" + key, kStranger), StartsWith(kWelcome));
  EXPECT_THAT(Watch("/foxglove?a=b&key=" + key, kStranger),
              StartsWith(kWelcome));
  for (const std::string& wrong :
       {std::string(), key.substr(1), key + "0", std::string(64, '0')}) {
    EXPECT_THAT(Watch("/foxglove?key=" + wrong), StartsWith(kRefused)) << wrong;
  }
  origin_ = "evil.example";
  EXPECT_THAT(Watch("/foxglove?key=" + key), StartsWith(kRefused));
}

TEST_F(FoxgloveTest, WithTokensOnlyAKeyOrTheOwnPageMayWatch) {
  Start(true);
  EXPECT_THAT(Watch("/foxglove"), StartsWith(kRefused));
  EXPECT_THAT(Watch("/foxglove", OwnOrigin()), StartsWith(kRefused));
  const std::string session = SignIn("ann-token");
  const std::string key = KeyOf(session);
  const std::string secret = After(session, "Set-Cookie: tactus=", ';');
  const std::string csrf = After(session, "\"csrf\":\"", '"');
  const std::string cookie = absl::StrCat("Cookie: tactus=", secret, "\r\n");
  ASSERT_EQ(key.size(), 64u);
  EXPECT_THAT(Watch("/foxglove", cookie), StartsWith(kRefused));
  EXPECT_THAT(Watch("/foxglove", kStranger + cookie), StartsWith(kRefused));
  EXPECT_THAT(Watch("/foxglove", OwnOrigin() + cookie), StartsWith(kWelcome));
  EXPECT_THAT(Watch("/foxglove?key=" + key, kStranger), StartsWith(kWelcome));
  EXPECT_THAT(Watch("/foxglove?key=" + secret), StartsWith(kRefused));
  EXPECT_THAT(Watch("/foxglove?key=" + csrf), StartsWith(kRefused));

  // The key is good for nothing else.
  EXPECT_THAT(
      Ask("GET /api/session", absl::StrCat("Cookie: tactus=", key, "\r\n")),
      HasSubstr("\"signed_in\":false"));
  EXPECT_THAT(
      Ask("POST /api/sign-out",
          absl::StrCat(OwnOrigin(), cookie, "X-CSRF-Token: ", key, "\r\n"),
          "x"),
      StartsWith(kRefused));

  // It ends with the sign-in, and so do its connections.
  const RawConnection watching(console_->port());
  EXPECT_THAT(Connect("/foxglove?key=" + key, watching), StartsWith(kWelcome));
  EXPECT_THAT(
      Ask("POST /api/sign-out",
          absl::StrCat(OwnOrigin(), cookie, "X-CSRF-Token: ", csrf, "\r\n"),
          "x"),
      StartsWith("HTTP/1.1 204"));
  EXPECT_THAT(Watch("/foxglove?key=" + key), StartsWith(kRefused));
  EXPECT_THAT(watching.ReadUntil("signed out"),
              HasSubstr(Closing(4401) + "signed out"));
}

TEST_F(FoxgloveTest, EndsAConnectionThatSaysAnythingElse) {
  Start(false);
  const auto ending = [&](const std::string& text) {
    const RawConnection connection(console_->port());
    Connect("/foxglove", connection);
    connection.Send(text);
    connection.EndSending();
    return connection.ReadAll();
  };
  EXPECT_THAT(ending(ClientText("{\"op\":")), HasSubstr(Closing(1008) + "not"));
  EXPECT_THAT(ending(ClientText("[]")), HasSubstr(Closing(1008) + "not"));
  // One byte more than there may be.
  EXPECT_THAT(ending(ClientText(
                  std::string(limits::kMaxFoxgloveMessageBytes + 1, ' '))),
              HasSubstr(Closing(1009)));
  // Not UTF-8.
  EXPECT_THAT(ending(ClientText("\"\xff\"")), HasSubstr(Closing(1007)));
  std::string many;
  for (int i = 0; i <= limits::kMaxFoxgloveMessagesPerS; ++i) {
    many += ClientText("{\"op\":\"unsubscribe\",\"subscriptionIds\":[1]}");
  }
  EXPECT_THAT(ending(many), HasSubstr(Closing(1008) + "too many messages"));
  // Without a mask.
  EXPECT_THAT(ending("\x81\x02{}"), HasSubstr(Closing(1002)));
  EXPECT_THAT(Watch("/foxglove"), StartsWith(kWelcome));
}

TEST_F(FoxgloveTest, CountsAmongThePagesThatWatch) {
  Start(false);
  std::list<RawConnection> watching;
  for (int i = 0; i < limits::kMaxLivePages; ++i) {
    EXPECT_THAT(Connect("/foxglove", watching.emplace_back(console_->port())),
                StartsWith(kWelcome));
  }
  EXPECT_THAT(Watch("/foxglove"), StartsWith("HTTP/1.1 503"));
  EXPECT_THAT(Ask("GET /api/live", kHello + OwnOrigin()),
              StartsWith("HTTP/1.1 503"));
  EXPECT_THAT(Ask("GET /"), StartsWith("HTTP/1.1 200 OK"));
  watching.clear();
  EXPECT_TRUE(testing::Eventually(
      [&] { return absl::StartsWith(Watch("/foxglove"), kWelcome); }));
}

// On other addresses than the host's own, strangers reach the console.
TEST(WatchRightsTest, AProgramWithoutAKeyIsOneOfThisMachine) {
  Doorkeeper doorkeeper({});
  Request request;
  request.target("/foxglove");
  EXPECT_TRUE(IsLocalProgram(request, true));
  EXPECT_FALSE(IsLocalProgram(request, false));
  EXPECT_EQ(FindWatcher(request, doorkeeper, true), nullptr);
  doorkeeper.Open();
  EXPECT_EQ(FindWatcher(request, doorkeeper, true), doorkeeper.Everybody());
  EXPECT_EQ(FindWatcher(request, doorkeeper, false), nullptr);
  request.target("/foxglove?key=" + doorkeeper.Everybody()->watch_key);
  EXPECT_FALSE(IsLocalProgram(request, true));
  EXPECT_EQ(FindWatcher(request, doorkeeper, false), doorkeeper.Everybody());
  request.target("/foxglove?key=");
  EXPECT_EQ(FindWatcher(request, doorkeeper, true), nullptr);
  request.target("/foxglove");
  request.set(http::field::origin, "http://elsewhere");
  EXPECT_FALSE(IsLocalProgram(request, true));
  EXPECT_EQ(FindWatcher(request, doorkeeper, true), nullptr);
}

}  // namespace
}  // namespace tactus::internal::console
