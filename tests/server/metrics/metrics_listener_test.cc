#include "server/metrics/metrics_listener.h"

#include <list>

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/raw_connection.h"

namespace tactus::internal::server {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::RawConnection;
using ::testing::StartsWith;

std::string Ask(int port, const std::string& request) {
  const RawConnection connection(port);
  connection.Send(request + "\r\nHost: x\r\n\r\n");
  return connection.ReadAll();
}

std::unique_ptr<MetricsListener> Listen() {
  return *MetricsListener::Start("0", [] {
    Families families = {GaugeFamily("seven", "Seven.")};
    Add({}, 7, &families[0]);
    return families;
  });
}

TEST(MetricsListenerTest, AnswersInTheFormatThatIsAskedFor) {
  const auto listener = Listen();
  const std::string text = Ask(listener->port(), "GET /metrics HTTP/1.1");
  EXPECT_THAT(text, StartsWith("HTTP/1.1 200 OK"));
  EXPECT_THAT(text, HasSubstr("text/plain; version=0.0.4"));
  EXPECT_THAT(text, HasSubstr("\nseven 7\n"));
  EXPECT_THAT(text, Not(HasSubstr("# EOF")));
  const std::string open =
      Ask(listener->port(),
          "GET /metrics HTTP/1.1\r\nAccept: "
          "application/openmetrics-text;version=1.0.0,text/plain;q=0.5");
  EXPECT_THAT(open, HasSubstr("Content-Type: application/openmetrics-text"));
  EXPECT_THAT(open, HasSubstr("\nseven 7\n# EOF\n"));
  const std::string head = Ask(listener->port(), "HEAD /metrics HTTP/1.1");
  EXPECT_THAT(head, StartsWith("HTTP/1.1 200 OK"));
  EXPECT_THAT(head, Not(HasSubstr("seven 7")));
}

TEST(MetricsListenerTest, HasNothingElse) {
  const auto listener = Listen();
  for (const char* path : {"/", "/metrics/", "/../etc/passwd", "/%2e%2e/",
                           "/metrics/../../etc/passwd"}) {
    EXPECT_THAT(Ask(listener->port(), std::string("GET ") + path + " HTTP/1.1"),
                Not(HasSubstr("200 OK")))
        << path;
  }
  EXPECT_THAT(Ask(listener->port(), "POST /metrics HTTP/1.1"),
              HasSubstr("405 Method Not Allowed"));
}

// Bytes of a stranger neither stop it nor fill it.
TEST(MetricsListenerTest, AnswersAfterHostileConnections) {
  const auto listener = Listen();
  for (const std::string& bytes :
       {std::string(1'000'000, 'A'), std::string("GET /metrics"),
        std::string(64, '\0'),
        std::string("GET /metrics HTTP/1.1\r\nX: ") +
            std::string(1'000'000, 'b'),
        std::string("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"),
        std::string("GET /metrics HTTP/9.9\r\n\r\n")}) {
    const RawConnection connection(listener->port());
    connection.Send(bytes);
  }
  // Some say nothing and stay: their time runs out.
  std::list<RawConnection> silent;
  for (int i = 0; i < 8; ++i) silent.emplace_back(listener->port());
  EXPECT_THAT(Ask(listener->port(), "GET /metrics HTTP/1.1"),
              HasSubstr("seven 7"));
}

TEST(MetricsListenerTest, RefusesWhatIsNoAddress) {
  for (const char* address :
       {"", "x", "localhost:", ":80", "70000", "-1", "9464s",
        "127.0.0.1:1,127.0.0.1:2", "127.0.0.1:9464r"}) {
    const auto listener =
        MetricsListener::Start(address, [] { return Families(); });
    EXPECT_EQ(ReasonOf(listener.status()), "INVALID_CONFIG") << address;
  }
  const auto first = Listen();
  const auto taken = MetricsListener::Start(std::to_string(first->port()),
                                            [] { return Families(); });
  EXPECT_EQ(ReasonOf(taken.status()), "IO");
}

}  // namespace
}  // namespace tactus::internal::server
