// What browsers, and strangers, get from a console.
#include "tools/console/console.h"

#include <fstream>
#include <list>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits_console.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/tools/console/console_fixture.h"

namespace tactus::internal::console {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr char kUpgrade[] =
    "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";

TEST_F(ConsoleTest, ServesThePageAndNothingElse) {
  Start(false);
  for (const char* target : {"/", "/index.html"}) {
    const std::string page = Ask(absl::StrCat("GET ", target));
    EXPECT_THAT(page, StartsWith("HTTP/1.1 200 OK"));
    EXPECT_THAT(page, HasSubstr("this is index.html"));
    EXPECT_THAT(page, HasSubstr("Content-Security-Policy: default-src 'none'"));
    EXPECT_THAT(page, HasSubstr("X-Content-Type-Options: nosniff"));
  }
  EXPECT_THAT(Ask("GET /app.js"), HasSubstr("text/javascript"));
  EXPECT_THAT(Ask("HEAD /app.js"), Not(HasSubstr("this is")));
  std::ofstream(folder_ / "secret") << "hidden";
  for (const char* target :
       {"/secret", "/../secret", "/app.js/../secret", "/%2e%2e/secret",
        "//index.html", "/app.js?x", "/api", "/api/live", "http://x/"}) {
    EXPECT_THAT(Ask(absl::StrCat("GET ", target)),
                StartsWith("HTTP/1.1 404 Not Found"))
        << target;
  }
  EXPECT_THAT(Ask("POST /", "", "x"), StartsWith("HTTP/1.1 405"));
}

TEST_F(ConsoleTest, OnlyItsOwnPageMayWatch) {
  Start(false);
  EXPECT_THAT(Ask("GET /api/session"), HasSubstr("\"signed_in\":true"));
  EXPECT_THAT(Ask("GET /api/live", kUpgrade), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(
      Ask("GET /api/live", absl::StrCat(kUpgrade, "Origin: http://evil\r\n")),
      StartsWith("HTTP/1.1 403"));
  origin_ = "evil.example";
  EXPECT_THAT(Ask("GET /"), StartsWith("HTTP/1.1 403"));
}

TEST_F(ConsoleTest, PeopleSignInWithTokensThatMayWatch) {
  Start(true);
  EXPECT_THAT(Ask("GET /api/session"), HasSubstr("\"signed_in\":false"));
  EXPECT_THAT(SignIn("wrong"), StartsWith("HTTP/1.1 401"));
  const std::string robot = SignIn("arm-token");
  EXPECT_THAT(robot, StartsWith("HTTP/1.1 401"));
  EXPECT_THAT(robot, HasSubstr("viewer"));
  for (const char* token : {"", "two words", "\\u0000"}) {
    EXPECT_THAT(SignIn(token), StartsWith("HTTP/1.1 400")) << token;
  }
  // Not from elsewhere.
  EXPECT_THAT(Ask("POST /api/sign-in", "", "{\"token\":\"ann-token\"}"),
              StartsWith("HTTP/1.1 403"));

  const std::string good = SignIn("ann-token");
  ASSERT_THAT(good, StartsWith("HTTP/1.1 200 OK"));
  EXPECT_THAT(good, HasSubstr("; HttpOnly; SameSite=Strict; Path=/"));
  const std::string secret = After(good, "Set-Cookie: tactus=", ';');
  const std::string csrf = After(good, "\"csrf\":\"", '"');
  ASSERT_EQ(secret.size(), 64u);
  const std::string cookie = absl::StrCat("Cookie: tactus=", secret, "\r\n");
  EXPECT_THAT(Ask("GET /api/session", cookie), HasSubstr("\"signed_in\":true"));

  // A stranger's page cannot sign a person out.
  const auto sign_out = [&](const std::string& header) {
    return Ask("POST /api/sign-out", absl::StrCat(cookie, header), "x");
  };
  const std::string proof = absl::StrCat("X-CSRF-Token: ", csrf, "\r\n");
  EXPECT_THAT(sign_out(OwnOrigin()), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(sign_out(proof), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(sign_out(OwnOrigin() + "X-CSRF-Token: x\r\n"),
              StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(sign_out(OwnOrigin() + proof), StartsWith("HTTP/1.1 204"));
  EXPECT_THAT(Ask("GET /api/session", cookie),
              HasSubstr("\"signed_in\":false"));
}

TEST_F(ConsoleTest, ACookieThatSomebodyElseSetIsNotTaken) {
  Start(true);
  const std::string fixed(64, 'a');
  const std::string good =
      Ask("POST /api/sign-in",
          absl::StrCat(OwnOrigin(), "Cookie: tactus=", fixed, "\r\n"),
          "{\"token\":\"ann-token\"}");
  EXPECT_NE(After(good, "Set-Cookie: tactus=", ';'), fixed);
  EXPECT_THAT(
      Ask("GET /api/session", absl::StrCat("Cookie: tactus=", fixed, "\r\n")),
      HasSubstr("\"signed_in\":false"));
}

TEST_F(ConsoleTest, AnswersAfterHostileConnections) {
  Start(false);
  for (const std::string& bytes :
       {std::string(100'000, 'A'), std::string("\0\1\2\3\r\n\r\n", 8),
        "GET / HTTP/1.1\r\nX: " + std::string(100'000, 'a') + "\r\n\r\n",
        std::string("GET / HTTP/9.9\r\n\r\n"), std::string("\r\n\r\n\r\n"),
        std::string("POST /api/sign-in HTTP/1.1\r\nHost: localhost\r\n"
                    "Content-Length: 99999999999\r\n\r\n"),
        std::string("POST /api/sign-in HTTP/1.1\r\nHost: localhost\r\n"
                    "Transfer-Encoding: chunked\r\n\r\nfffffff\r\n")}) {
    const RawConnection connection(console_->port());
    connection.Send(bytes);
    connection.EndSending();
    EXPECT_THAT(connection.ReadAll(), Not(HasSubstr("200 OK")));
  }
  EXPECT_THAT(Ask("GET /"), StartsWith("HTTP/1.1 200 OK"));
  // More silent ones than may be; then they go.
  std::list<RawConnection> silent;
  for (int i = 0; i < limits::kMaxBrowserConnections + 50; ++i) {
    silent.emplace_back(console_->port());
  }
  silent.clear();
  EXPECT_TRUE(testing::Eventually(
      [&] { return absl::StartsWith(Ask("GET /"), "HTTP/1.1 200 OK"); }));
}

TEST_F(ConsoleTest, APageThatSaysAnythingElseIsLeft) {
  Start(false);
  Ask("GET /api/session");
  // Masked with zeros: "next" once, then what no page says.
  const std::string next("\x81\x84\0\0\0\0next", 10);
  for (const std::string& other :
       {std::string("\x81\x84\0\0\0\0what", 10),
        std::string("\x81\xfe\xff\xff\0\0\0\0", 8) + std::string(65'535, 'n'),
        std::string("\x81\x04next", 6)}) {
    const RawConnection page(console_->port());
    page.Send(absl::StrCat("GET /api/live HTTP/1.1\r\nHost: ", origin_, "\r\n",
                           kUpgrade, OwnOrigin(), "\r\n"));
    page.Send(next + other);
    page.EndSending();
    const std::string all = page.ReadAll();
    EXPECT_THAT(all, StartsWith("HTTP/1.1 101"));
  }
  EXPECT_THAT(Ask("GET /"), StartsWith("HTTP/1.1 200 OK"));
}

TEST_F(ConsoleTest, SaysWhatIsWrongWithItsOptions) {
  Start(false);
  const auto reason = [&](const auto& change) {
    ConsoleOptions options = options_;
    change(options);
    return ReasonOf(Console::Start(options).status());
  };
  EXPECT_EQ(reason([](auto& o) { o.servers.clear(); }), "INVALID_CONFIG");
  EXPECT_EQ(reason([](auto& o) { o.listen = "lab:8080"; }), "INVALID_CONFIG");
  // Tokens would travel unencrypted.
  EXPECT_EQ(reason([](auto& o) { o.listen = "0.0.0.0:0"; }), "INVALID_CONFIG");
  EXPECT_EQ(reason([](auto& o) { o.tls_key = "key.pem"; }), "INVALID_CONFIG");
  EXPECT_EQ(reason([](auto& o) { o.page = "/nowhere"; }), "IO");
}

}  // namespace
}  // namespace tactus::internal::console
