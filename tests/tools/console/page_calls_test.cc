// What pages get from servers, and what strangers do not.
#include "tools/console/page_calls.h"

#include <atomic>
#include <list>

#include "core/base/limits_console.h"
#include "gmock/gmock.h"
#include "grpcpp/server.h"
#include "grpcpp/server_builder.h"
#include "tactus/v1/models.grpc.pb.h"
#include "tactus/v1/monitor.grpc.pb.h"
#include "tests/tools/console/console_fixture.h"

namespace tactus::internal::console {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr char kStreams[] = "POST /api/servers/0/MonitorService/ListStreams";
constexpr char kAliases[] = "POST /api/servers/0/ModelService/ListAliases";
constexpr char kInfo[] = "POST /api/servers/0/AdminService/GetServerInfo";

// Answers who watches, and no question about aliases.
class SilentServer : private v1::MonitorService::Service,
                     private v1::ModelService::Service {
 public:
  SilentServer() {
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(),
                             &port_);
    builder.RegisterService(static_cast<v1::MonitorService::Service*>(this));
    builder.RegisterService(static_cast<v1::ModelService::Service*>(this));
    server_ = builder.BuildAndStart();
  }
  ~SilentServer() override {
    server_->Shutdown(std::chrono::system_clock::now());
  }

  std::string address() const { return absl::StrCat("127.0.0.1:", port_); }
  int begun() const { return begun_; }
  int cancelled() const { return cancelled_; }

 private:
  grpc::Status ListStreams(grpc::ServerContext* context,
                           const v1::ListStreamsRequest*,
                           v1::ListStreamsResponse*) override {
    const auto& metadata = context->client_metadata();
    return metadata.contains("authorization")
               ? grpc::Status::OK
               : grpc::Status(grpc::StatusCode::UNAUTHENTICATED, "no token");
  }
  grpc::Status ListAliases(grpc::ServerContext* context,
                           const v1::ListAliasesRequest*,
                           v1::ListAliasesResponse*) override {
    ++begun_;
    while (!context->IsCancelled()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    ++cancelled_;
    return grpc::Status::CANCELLED;
  }
  // More than a page may get.
  grpc::Status ListModelVersions(
      grpc::ServerContext*, const v1::ListModelVersionsRequest*,
      v1::ListModelVersionsResponse* response) override {
    response->set_next_page_token(
        std::string(limits::kMaxPageReplyBytes + 1, 'x'));
    return grpc::Status::OK;
  }

  int port_ = 0;
  std::atomic<int> begun_{0};
  std::atomic<int> cancelled_{0};
  std::unique_ptr<grpc::Server> server_;
};

class PageCallsTest : public ConsoleTest {};

TEST_F(PageCallsTest, APageAsksItsServer) {
  Start(false);
  const std::string page = PageOf("");
  const std::string info = Ask(kInfo, page, "{}");
  EXPECT_THAT(info, StartsWith("HTTP/1.1 200 OK"));
  EXPECT_THAT(info, HasSubstr("Content-Type: application/json"));
  EXPECT_THAT(info, HasSubstr("\"max_streams\":"));
  EXPECT_THAT(info, HasSubstr("\"uptime_ms\":\""));
  EXPECT_THAT(Ask(kStreams, page, "{\"page_size\": 3}"),
              HasSubstr("\"streams\":[]"));
}

TEST_F(PageCallsTest, ErrorsOfTheServerKeepTheirWords) {
  Start(false);
  const std::string page = PageOf("");
  const std::string error =
      Ask("POST /api/servers/0/TrainingService/ListDatasets", page, "{}");
  EXPECT_THAT(error, StartsWith("HTTP/1.1 409"));
  EXPECT_THAT(error, HasSubstr("\"code\":\"FAILED_PRECONDITION\""));
  EXPECT_THAT(error, HasSubstr("\"reason\":\"NO_DATA_DIRECTORY\""));
  EXPECT_THAT(error, HasSubstr("\"message\":\""));
  EXPECT_THAT(error, HasSubstr("\"metadata\":{"));
  EXPECT_THAT(Ask(kStreams, page, "{\"page_token\": \"none\"}"),
              StartsWith("HTTP/1.1 400"));
}

TEST_F(PageCallsTest, AServerThatIsGoneIsUnavailable) {
  StartConsole("127.0.0.1:1");
  // Nobody can sign in, so nobody can ask.
  EXPECT_THAT(Ask(kInfo, PageOf(""), "{}"), StartsWith("HTTP/1.1 401"));
  Start(false);
  const std::string page = PageOf("");
  server_.reset();
  const std::string error = Ask(kInfo, page, "{}");
  EXPECT_THAT(error, StartsWith("HTTP/1.1 503"));
  EXPECT_THAT(error, HasSubstr("\"code\":\"UNAVAILABLE\""));
}

TEST_F(PageCallsTest, OnlyItsOwnPageMayAsk) {
  Start(true);
  const std::string page = PageOf("bob-token");
  EXPECT_THAT(Ask(kInfo, page, "{}"), StartsWith("HTTP/1.1 200 OK"));
  const auto without = [&](const std::string& name) {
    const size_t at = page.find(name);
    const size_t end = page.find("\r\n", at) + 2;
    return page.substr(0, at) + page.substr(end);
  };
  EXPECT_THAT(Ask(kInfo, without("Origin"), "{}"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(Ask(kInfo, without("X-CSRF"), "{}"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(Ask(kInfo, without("Cookie"), "{}"), StartsWith("HTTP/1.1 401"));
  EXPECT_THAT(Ask(kInfo, without("Origin") + "Origin: http://evil\r\n", "{}"),
              StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(Ask(kInfo, without("X-CSRF") + "X-CSRF-Token: x\r\n", "{}"),
              StartsWith("HTTP/1.1 403"));
  // The secret of another person.
  const std::string other = PageOf("ann-token");
  EXPECT_THAT(Ask(kInfo,
                  absl::StrCat(without("X-CSRF"), "X-CSRF-Token: ",
                               After(other, "X-CSRF-Token: ", '\r'), "\r\n"),
                  "{}"),
              StartsWith("HTTP/1.1 403"));
}

TEST_F(PageCallsTest, WhatIsNotListedIsNotCalled) {
  Start(false);
  const std::string page = PageOf("");
  for (const char* path :
       {"ModelService/ImportModel", "ModelService/NoSuchMethod",
        "ContactService/ClassifyTrial", "ModelService", ""}) {
    EXPECT_THAT(Ask(absl::StrCat("POST /api/servers/0/", path), page, "{}"),
                StartsWith("HTTP/1.1 404"))
        << path;
  }
  EXPECT_THAT(Ask("POST /api/servers/1/AdminService/GetServerInfo", page, "{}"),
              StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(Ask("GET /api/servers/0/AdminService/GetServerInfo", page),
              StartsWith("HTTP/1.1 405"));
}

TEST_F(PageCallsTest, BadBodiesAreRefused) {
  Start(false);
  const std::string page = PageOf("");
  for (const std::string& body :
       {std::string("no JSON"), std::string("{\"strange\": 1}"),
        std::string("{\"page_size\": \"many\"}"),
        std::string("{\"page_token\": \"\xff\"}"), std::string(200'000, '[')}) {
    const std::string response = Ask(kStreams, page, body);
    EXPECT_THAT(response, StartsWith("HTTP/1.1 400")) << body.substr(0, 40);
    EXPECT_THAT(response, HasSubstr("\"reason\":\"INVALID_CONFIG\""));
  }
  const std::string fits =
      absl::StrCat("{\"page_token\": \"", std::string(100'000, 'x'), "\"}");
  EXPECT_THAT(Ask(kStreams, page, fits), Not(StartsWith("HTTP/1.1 413")));
  const std::string large(limits::kMaxPageCallBytes + 1, ' ');
  EXPECT_THAT(Ask(kStreams, page, large), StartsWith("HTTP/1.1 413"));
  // Strangers may not send as much.
  EXPECT_THAT(Ask(kStreams, OwnOrigin(), fits), StartsWith("HTTP/1.1 413"));
  EXPECT_THAT(Ask("POST /api/sign-in", page, fits), StartsWith("HTTP/1.1 413"));
  EXPECT_THAT(Ask(kStreams, page, "{}"), StartsWith("HTTP/1.1 200 OK"));
}

TEST_F(PageCallsTest, TheServerDecidesWhoMayDoWhat) {
  Start(true);
  const std::string page = PageOf("ann-token");
  EXPECT_THAT(Ask(kStreams, page, "{}"), StartsWith("HTTP/1.1 200 OK"));
  const std::string refused = Ask(kInfo, page, "{}");
  EXPECT_THAT(refused, StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(refused, HasSubstr("\"reason\":\"PERMISSION_DENIED\""));
  EXPECT_THAT(refused, HasSubstr("\"role\":\"viewer\""));
  EXPECT_THAT(refused, Not(HasSubstr("ann-token")));
}

TEST_F(PageCallsTest, AReplyThatIsTooLargeIsAnError) {
  const SilentServer silent;
  StartConsole(silent.address());
  const std::string response =
      Ask("POST /api/servers/0/ModelService/ListModelVersions", PageOf("any"),
          "{}");
  EXPECT_THAT(response, StartsWith("HTTP/1.1 429"));
  EXPECT_THAT(response, HasSubstr("larger than max"));
}

TEST_F(PageCallsTest, ACallEndsWithTheBrowser) {
  const SilentServer silent;
  StartConsole(silent.address());
  const std::string page = PageOf("any");
  {
    const RawConnection browser(console_->port());
    browser.Send(RequestOf(kAliases, page, "{}"));
    ASSERT_TRUE(testing::Eventually([&] { return silent.begun() == 1; }));
    // Bytes that nobody reads must not hide that it goes.
    browser.Send("GET / HTTP/1.1\r\n");
  }
  EXPECT_TRUE(testing::Eventually([&] { return silent.cancelled() == 1; }));
}

TEST_F(PageCallsTest, ACallEndsWithTheSignIn) {
  const SilentServer silent;
  StartConsole(silent.address());
  const std::string page = PageOf("any");
  const RawConnection browser(console_->port());
  browser.Send(RequestOf(kAliases, page, "{}"));
  ASSERT_TRUE(testing::Eventually([&] { return silent.begun() == 1; }));
  EXPECT_THAT(Ask("POST /api/sign-out", page, "x"), StartsWith("HTTP/1.1 204"));
  EXPECT_TRUE(testing::Eventually([&] { return silent.cancelled() == 1; }));
  const std::string response = browser.ReadAll();
  EXPECT_THAT(response, StartsWith("HTTP/1.1 401"));
  EXPECT_THAT(response, HasSubstr("\"reason\":\"UNAUTHENTICATED\""));
}

TEST_F(PageCallsTest, NobodyAsksTooMuchAtOnce) {
  const SilentServer silent;
  StartConsole(silent.address());
  const std::string page = PageOf("any");
  std::list<RawConnection> browsers;
  for (int i = 0; i < limits::kMaxPageCallsOfPerson; ++i) {
    browsers.emplace_back(console_->port());
    browsers.back().Send(RequestOf(kAliases, page, "{}"));
  }
  ASSERT_TRUE(testing::Eventually(
      [&] { return silent.begun() == limits::kMaxPageCallsOfPerson; }));
  // A second sign-in of the same person counts with the first one.
  EXPECT_THAT(Ask(kAliases, PageOf("any"), "{}"), StartsWith("HTTP/1.1 429"));
  EXPECT_THAT(Ask(kStreams, PageOf("else"), "{}"),
              StartsWith("HTTP/1.1 200 OK"));
  browsers.clear();
  EXPECT_TRUE(testing::Eventually([&] {
    return absl::StartsWith(Ask(kStreams, page, "{}"), "HTTP/1.1 200 OK");
  }));
}

TEST_F(PageCallsTest, TheConsoleEndsWithCallsUnderWay) {
  const SilentServer silent;
  StartConsole(silent.address());
  const std::string page = PageOf("any");
  const RawConnection browser(console_->port());
  browser.Send(RequestOf(kAliases, page, "{}"));
  ASSERT_TRUE(testing::Eventually([&] { return silent.begun() == 1; }));
  console_.reset();
  EXPECT_TRUE(testing::Eventually([&] { return silent.cancelled() == 1; }));
}

}  // namespace
}  // namespace tactus::internal::console
