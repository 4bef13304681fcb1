#include "tools/console/request_checks.h"

#include "gtest/gtest.h"

namespace tactus::internal::console {
namespace {

Request With(http::field field, const std::string& value) {
  Request request;
  request.set(field, value);
  return request;
}

TEST(RequestChecksTest, OfThisMachineOnlyItsOwnNamesAreAllowed) {
  for (const char* host : {"localhost", "localhost:8080", "127.0.0.1:1",
                           "127.9.9.9", "[::1]:8080", "[::1]"}) {
    EXPECT_TRUE(HasAllowedHost(With(http::field::host, host), true)) << host;
  }
  for (const char* host :
       {"", "evil.example", "evil.example:8080", "localhost.evil.example:80",
        "10.0.0.1:8080", "unix:x", "127.0.0.1.evil.example:80"}) {
    EXPECT_FALSE(HasAllowedHost(With(http::field::host, host), true)) << host;
  }
  EXPECT_TRUE(HasAllowedHost(With(http::field::host, "lab:8080"), false));
  EXPECT_FALSE(HasAllowedHost(Request(), false));
}

TEST(RequestChecksTest, TheOriginNamesTheHost) {
  Request request = With(http::field::host, "localhost:8080");
  EXPECT_FALSE(IsOwnOrigin(request));
  for (const char* origin :
       {"http://localhost:8080", "https://localhost:8080"}) {
    request.set(http::field::origin, origin);
    EXPECT_TRUE(IsOwnOrigin(request)) << origin;
  }
  for (const char* origin :
       {"null", "", "http://", "http://localhost", "http://localhost:80801",
        "http://evil.example", "localhost:8080"}) {
    request.set(http::field::origin, origin);
    EXPECT_FALSE(IsOwnOrigin(request)) << origin;
  }
}

TEST(RequestChecksTest, FindsTheCookieAmongOthers) {
  const auto cookie = [](const char* text) {
    return CookieOf(With(http::field::cookie, text));
  };
  EXPECT_EQ(cookie("tactus=abc"), "abc");
  EXPECT_EQ(cookie("a=b; tactus=abc; c=d"), "abc");
  EXPECT_EQ(cookie("xtactus=abc"), "");
  EXPECT_EQ(cookie("tactusx=abc"), "");
  EXPECT_EQ(cookie(""), "");
  EXPECT_EQ(CookieOf(Request()), "");
}

}  // namespace
}  // namespace tactus::internal::console
