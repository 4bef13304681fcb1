#include "server/metrics/metrics_listener.h"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <list>

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal::server {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

// A connection to a port of this host; a stranger decides what it says.
class Connection {
 public:
  explicit Connection(int port) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval patience = {.tv_sec = 20, .tv_usec = 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address));
  }
  ~Connection() { close(socket_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void Send(const std::string& bytes) const {
    size_t sent = 0;
    while (sent < bytes.size()) {
      const ssize_t now =
          send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
      if (now <= 0) return;
      sent += static_cast<size_t>(now);
    }
  }
  std::string ReadAll() const {
    std::string text;
    char part[4096];
    ssize_t count = 0;
    while ((count = recv(socket_, part, sizeof(part), 0)) > 0) {
      text.append(part, static_cast<size_t>(count));
    }
    return text;
  }

 private:
  const int socket_;
};

std::string Ask(int port, const std::string& request) {
  const Connection connection(port);
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
    const Connection connection(listener->port());
    connection.Send(bytes);
  }
  // Some say nothing and stay: their time runs out.
  std::list<Connection> silent;
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
