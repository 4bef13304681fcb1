// Who may call what: without a tokens file, with one, and while it changes.
#include "server/ops/authorizer.h"

#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <thread>

#include "client/stream/contact_stream.h"
#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/support/test_server.h"

namespace tactus::internal::server {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr char kClassify[] = "/tactus.v1.ContactService/ClassifyContact";
constexpr char kList[] = "/tactus.v1.ModelService/ListAliases";
constexpr char kTrain[] = "/tactus.v1.TrainingService/TrainModel";

class AuthorizerTest : public ::testing::Test {
 protected:
  AuthorizerTest()
      : path_(absl::StrCat(::testing::TempDir(), "/tokens-", getpid())) {}
  ~AuthorizerTest() override { std::filesystem::remove(path_); }

  void Write(const std::string& text) const { std::ofstream(path_) << text; }
  static std::string Line(const std::string& name, Role role) {
    return *TokenLine(name, role, name + "-token");
  }
  // The reason of the refusal, or the caller's name.
  static std::string Outcome(const Authorizer& authorizer,
                             const Authorizer::Credentials& credentials,
                             const char* method, Role role) {
    const auto caller = authorizer.Check(credentials, method, role);
    return caller.ok() ? caller->name : ReasonOf(caller.status());
  }

  const std::string path_;
};

TEST_F(AuthorizerTest, BehindAProxyLoopbackIsNotTheServersHost) {
  const Authorizer authorizer(Authorizer::Loopback::kProxy);
  const auto outcome = [&](const char* peer, const char* method) {
    return Outcome(authorizer, {.peer = peer}, method, Role::kRobot);
  };
  for (const char* peer :
       {"ipv4:127.0.0.1:9", "ipv6:%5B::1%5D:9", "ipv6:%5B::ffff:127.0.0.1%5D:9",
        "ipv4:192.0.2.7:1", "unknown"}) {
    EXPECT_EQ(outcome(peer, kTrain), "UNAUTHENTICATED") << peer;
    EXPECT_NE(outcome(peer, kClassify), "UNAUTHENTICATED") << peer;
  }
  for (const char* peer : {"unix:/run/tactus/s", "unix:", "inproc"}) {
    EXPECT_NE(outcome(peer, kTrain), "UNAUTHENTICATED") << peer;
  }
}

TEST_F(AuthorizerTest, WithoutTokensOtherHostsMayOnlyClassify) {
  const Authorizer authorizer;
  const auto outcome = [&](const char* peer, const char* method) {
    return Outcome(authorizer, {.peer = peer}, method, Role::kRobot);
  };
  for (const char* peer : {"ipv4:192.0.2.7:1", "ipv6:%5B2001:db8::1%5D:1",
                           "ipv6:%5B::ffff:192.0.2.7%5D:1", "strange"}) {
    EXPECT_EQ(outcome(peer, kTrain), "UNAUTHENTICATED") << peer;
    EXPECT_EQ(outcome(peer, kList), "UNAUTHENTICATED") << peer;
    EXPECT_NE(outcome(peer, kClassify), "UNAUTHENTICATED") << peer;
  }
  EXPECT_EQ(outcome("ipv4:127.0.0.1:9", kTrain), "127.0.0.1");
  EXPECT_EQ(outcome("ipv6:%5B::1%5D:9", kTrain), "0:0:0:0::/64");
  EXPECT_EQ(outcome("unix:/run/a", kTrain), "unix");
  EXPECT_EQ(outcome("inproc", kTrain), "inproc");
  const auto refused =
      authorizer.Check({.peer = "ipv4:192.0.2.7:1"}, kTrain, Role::kTrainer);
  EXPECT_THAT(std::string(refused.status().message()), HasSubstr("--tokens"));
}

TEST_F(AuthorizerTest, WithTokensEveryCallNeedsARole) {
  Write(Line("arm", Role::kRobot) + Line("lab", Role::kTrainer) +
        "certificate pc trainer\n");
  const auto authorizer = Authorizer::Open(path_);
  ASSERT_TRUE(authorizer.ok()) << authorizer.status();
  const auto outcome = [&](const Authorizer::Credentials& credentials,
                           Role role) {
    return Outcome(**authorizer, credentials, kClassify, role);
  };
  for (const char* peer : {"inproc", "unix:/run/a", "ipv4:127.0.0.1:1"}) {
    EXPECT_EQ(outcome({.peer = peer}, Role::kRobot), "UNAUTHENTICATED");
  }
  const auto bearer = [](const std::string& value) {
    return Authorizer::Credentials{.peer = "unix:", .authorization = {value}};
  };
  EXPECT_EQ(outcome(bearer("Bearer arm-token"), Role::kRobot), "arm");
  EXPECT_EQ(outcome(bearer("bearer  arm-token "), Role::kRobot), "arm");
  EXPECT_EQ(outcome(bearer("Bearer arm-token"), Role::kTrainer),
            "PERMISSION_DENIED");
  EXPECT_EQ(outcome(bearer("Bearer lab-token"), Role::kTrainer), "lab");
  EXPECT_EQ(outcome(bearer("Bearer lab-token"), Role::kAdmin),
            "PERMISSION_DENIED");
  for (const char* value : {"", "Bearer", "Bearer ", "arm-token",
                            "Basic arm-token", "Bearer arm-token x"}) {
    EXPECT_EQ(outcome(bearer(value), Role::kRobot), "UNAUTHENTICATED") << value;
  }
  EXPECT_EQ(outcome({.peer = "unix:",
                     .authorization = {"Bearer arm-token", "Bearer arm-token"}},
                    Role::kRobot),
            "UNAUTHENTICATED");
  EXPECT_EQ(outcome({.peer = "unix:", .certificate = "pc"}, Role::kTrainer),
            "pc");
  EXPECT_EQ(outcome({.peer = "unix:", .certificate = "arm"}, Role::kRobot),
            "UNAUTHENTICATED");
  // A wrong token is wrong whatever the certificate.
  EXPECT_EQ(outcome({.peer = "unix:",
                     .authorization = {"Bearer wrong"},
                     .certificate = "pc"},
                    Role::kRobot),
            "UNAUTHENTICATED");
  const auto refused =
      (*authorizer)->Check(bearer("Bearer my-secret"), kClassify, Role::kRobot);
  EXPECT_THAT(refused.status().ToString(), Not(HasSubstr("my-secret")));
}

TEST_F(AuthorizerTest, AReloadTakesEffectAndABrokenFileKeepsTheOldTable) {
  EXPECT_EQ(ReasonOf(Authorizer::Open(path_).status()), "IO");
  Write("arm robot x\n");
  const absl::Status broken = Authorizer::Open(path_).status();
  EXPECT_THAT(std::string(broken.message()),
              HasSubstr(path_ + ": line 1: the SHA-256"));
  Write(Line("old", Role::kRobot));
  const auto authorizer = *Authorizer::Open(path_);
  const auto outcome = [&](const std::string& name) {
    return Outcome(
        *authorizer,
        {.peer = "unix:", .authorization = {"Bearer " + name + "-token"}},
        kClassify, Role::kRobot);
  };
  EXPECT_EQ(outcome("old"), "old");
  for (const char* wrong : {"", "old robot\n", "new root 00\n"}) {
    Write(wrong);
    EXPECT_FALSE(authorizer->Reload().ok()) << wrong;
    EXPECT_EQ(outcome("old"), "old") << wrong;
  }
  std::filesystem::remove(path_);
  EXPECT_FALSE(authorizer->Reload().ok());
  EXPECT_EQ(outcome("old"), "old");
  Write(Line("new", Role::kRobot));
  ASSERT_TRUE(authorizer->Reload().ok());
  EXPECT_EQ(outcome("old"), "UNAUTHENTICATED");
  EXPECT_EQ(outcome("new"), "new");
}

TEST_F(AuthorizerTest, CallsGoOnDuringReloads) {
  Write(Line("arm", Role::kRobot));
  const auto authorizer = *Authorizer::Open(path_);
  std::atomic<bool> stop = false;
  std::atomic<int> calls = 0;
  std::atomic<int> refused = 0;
  std::thread caller([&] {
    for (; !stop; ++calls) {
      refused +=
          Outcome(*authorizer,
                  {.peer = "unix:", .authorization = {"Bearer arm-token"}},
                  kClassify, Role::kRobot) != "arm";
    }
  });
  for (int i = 0; i < 200 || calls < 200; ++i) {
    EXPECT_TRUE(authorizer->Reload().ok());
  }
  stop = true;
  caller.join();
  EXPECT_EQ(refused, 0);
}

TEST_F(AuthorizerTest, AStreamIsCheckedWhenItBegins) {
  Write(Line("arm", Role::kRobot));
  const auto authorizer = *Authorizer::Open(path_);
  TactusServer::Options options;
  options.authorizer = authorizer.get();
  testing::TestServer server(options);
  const auto open = [&](const std::string& token) {
    return client::ContactStream::Open(
        server.channel(), testing::ConfigRequest().config(), [](const auto&) {},
        {}, token);
  };
  auto stream = open("arm-token");
  ASSERT_TRUE(stream.ok()) << stream.status();
  for (const char* wrong : {"", "arm-tokem"}) {
    EXPECT_EQ(ReasonOf(open(wrong).status()), "UNAUTHENTICATED") << wrong;
  }
  Write(Line("other", Role::kRobot));
  ASSERT_TRUE(authorizer->Reload().ok());
  EXPECT_EQ(ReasonOf(open("arm-token").status()), "UNAUTHENTICATED");
  ASSERT_TRUE((*stream)->Send(testing::DenseU16(1, {testing::Touch(1)})).ok());
  EXPECT_TRUE((*stream)->EndTrial().ok());
  EXPECT_TRUE((*stream)->Close().ok());
  // Refused streams take no place.
  EXPECT_TRUE(
      testing::Eventually([&] { return server.server().gate().live() == 0; }));
}

}  // namespace
}  // namespace tactus::internal::server
