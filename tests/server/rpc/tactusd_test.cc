// The program itself: flags, port file, signals, exit codes.
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "client/stream/contact_stream.h"
#include "core/access/access_table.h"
#include "core/base/errors.h"
#include "core/base/version.h"
#include "gtest/gtest.h"
#include "tactus/v1/admin.grpc.pb.h"
#include "tests/server/support/requests.h"
#include "tests/server/support/tls_files.h"
#include "tests/support/child_tactusd.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {
namespace {

using std::chrono::milliseconds;
using testing::ChildTactusd;

std::vector<std::string> Quiet(std::vector<std::string> flags) {
  flags.push_back("--log-level=warn");
  return flags;
}

TEST(TactusdTest, VersionAndBadFlags) {
  EXPECT_EQ(ChildTactusd::Run({"--version"}), 0);
  EXPECT_NE(ChildTactusd::Run({"--no-such-flag"}), 0);
  EXPECT_NE(ChildTactusd::Run({"--max-streams=0"}), 0);
  EXPECT_NE(ChildTactusd::Run({"--model=without-path"}), 0);
  EXPECT_EQ(ChildTactusd::Run({"--model=a=/no/such/file"}), 1);
  EXPECT_EQ(ChildTactusd::Run({"--log-level=chatty"}), 1);
  EXPECT_EQ(ChildTactusd::Run({"--listen=no-such-host.invalid:1"}), 1);
}

TEST(TactusdTest, ServesItsBuiltInModelAndStopsOnSigterm) {
  ChildTactusd daemon(Quiet({"--drain-grace-ms=100"}));
  ASSERT_NE(daemon.port(), 0) << daemon.Log();
  const std::string address = daemon.address();
  EXPECT_EQ(ChildTactusd::Run({"--health-check=" + address}), 0);
  v1::StreamConfig config =
      testing::ConfigRequest(testing::kModelWithoutPoses).config();
  bool noticed = false;
  bool final = false;
  auto stream = client::ContactStream::Open(
      client::MakeChannel(address), config, [&](const auto& response) {
        noticed |= response.has_notice();
        final |= response.answer().is_final();
      });
  ASSERT_TRUE(stream.ok()) << stream.status();
  EXPECT_EQ((*stream)->started().model_version(), "models/no-poses/versions/1");
  EXPECT_EQ((*stream)->started().server().version(), kVersion);
  ASSERT_TRUE((*stream)->Send(testing::DenseU16(1, {testing::Touch(1)})).ok());
  daemon.Signal(SIGTERM);
  EXPECT_EQ(daemon.Wait(), 0);
  EXPECT_EQ(ReasonOf((*stream)->Close()), "DRAINING");
  EXPECT_TRUE(noticed);
  EXPECT_TRUE(final);
  EXPECT_EQ(ChildTactusd::Run({"--health-check=" + address}), 1);
}

TEST(TactusdTest, WarnsOfAddressesThatOtherHostsReach) {
  const std::string kWarning = "is open to other hosts";
  const ChildTactusd local;
  ASSERT_NE(local.port(), 0) << local.Log();
  EXPECT_FALSE(absl::StrContains(local.Log(), kWarning)) << local.Log();
  const ChildTactusd open({"--listen=0.0.0.0:0"});
  ASSERT_NE(open.port(), 0) << open.Log();
  EXPECT_TRUE(absl::StrContains(open.Log(), "0.0.0.0:0 " + kWarning))
      << open.Log();
}

TEST(TactusdTest, DrainEndsItAsSigtermDoes) {
  ChildTactusd daemon(Quiet({"--drain-grace-ms=100"}));
  ASSERT_NE(daemon.port(), 0) << daemon.Log();
  const auto channel = client::MakeChannel(daemon.address());
  bool noticed = false;
  bool final = false;
  auto stream = client::ContactStream::Open(
      channel, testing::ConfigRequest(testing::kModelWithoutPoses).config(),
      [&](const auto& response) {
        noticed |= response.has_notice();
        final |= response.answer().is_final();
      });
  ASSERT_TRUE(stream.ok()) << stream.status();
  ASSERT_TRUE((*stream)->Send(testing::DenseU16(1, {testing::Touch(1)})).ok());
  grpc::ClientContext context;
  v1::DrainResponse response;
  const auto stub = v1::AdminService::NewStub(channel);
  const grpc::Status status = stub->Drain(&context, {}, &response);
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(response.streams(), 1u);
  EXPECT_EQ(response.grace_ms(), 100);
  EXPECT_EQ(daemon.Wait(), 0);
  EXPECT_EQ(ReasonOf((*stream)->Close()), "DRAINING");
  EXPECT_TRUE(noticed);
  EXPECT_TRUE(final);
}

TEST(TactusdTlsTest, SpeaksTlsOnPortsAndPlainOnUnixSockets) {
  const testing::TlsFiles files;
  ASSERT_TRUE(files.made()) << "needs the openssl program";
  const std::string certificate = "--tls-cert=" + files.certificate();
  const std::string key = "--tls-key=" + files.key();
  EXPECT_NE(ChildTactusd::Run({"--tls-cert=/no/such", key}), 0);
  EXPECT_NE(ChildTactusd::Run({certificate}), 0);
  EXPECT_EQ(ChildTactusd::Run({"--listen=127.0.0.1:0", "--log-level=off",
                               "--tls-cert=" + files.key(),
                               "--tls-key=" + files.certificate()}),
            1);
  const ScratchDir folder;
  const std::string socket = "unix:" + folder / "tactusd.sock";
  ChildTactusd daemon(Quiet({certificate, key, "--listen=" + socket}));
  ASSERT_NE(daemon.port(), 0) << daemon.Log();
  const std::string address = daemon.address();
  EXPECT_EQ(ChildTactusd::Run({"--health-check=" + address,
                               "--tls-ca=" + files.certificate()}),
            0);
  EXPECT_EQ(ChildTactusd::Run({"--health-check=" + address}), 1);
  EXPECT_EQ(ChildTactusd::Run({"--health-check=" + socket}), 0);
  const auto roots = client::ReadRootCertificates(files.certificate());
  ASSERT_TRUE(roots.ok()) << roots.status();
  for (const std::string& server : {address, socket}) {
    const auto stream = client::ContactStream::Open(
        client::MakeChannel(server, {.tls_roots = *roots}),
        testing::ConfigRequest(testing::kModelWithoutPoses).config(),
        [](const auto&) {});
    EXPECT_TRUE(stream.ok()) << server << ": " << stream.status();
  }
}

// "open", or why a stream with this token is refused.
std::string OpenOutcome(const ChildTactusd& daemon, const std::string& token) {
  const auto stream = client::ContactStream::Open(
      client::MakeChannel(daemon.address()),
      testing::ConfigRequest(testing::kModelWithoutPoses).config(),
      [](const auto&) {}, {}, token);
  return stream.ok() ? "open" : ReasonOf(stream.status());
}

class TactusdTokensTest : public ::testing::Test {
 protected:
  TactusdTokensTest()
      : path_(
            absl::StrCat(::testing::TempDir(), "/tactusd-tokens-", getpid())) {}
  ~TactusdTokensTest() override { std::filesystem::remove(path_); }

  void Write(const std::string& text) const { std::ofstream(path_) << text; }
  void WriteToken(const std::string& token) const {
    Write(*TokenLine("arm", Role::kRobot, token));
  }
  // Waits until the log holds `text`.
  static bool Logs(const ChildTactusd& daemon, const std::string& text) {
    for (int i = 0; i < 2000; ++i) {
      if (absl::StrContains(daemon.Log(), text)) return true;
      std::this_thread::sleep_for(milliseconds(5));
    }
    return false;
  }

  const std::string path_;
};

TEST_F(TactusdTokensTest, SighupReadsTheFileAgain) {
  WriteToken("first");
  ChildTactusd daemon({"--tokens=" + path_});
  ASSERT_NE(daemon.port(), 0) << daemon.Log();
  EXPECT_EQ(OpenOutcome(daemon, "first"), "open");
  EXPECT_EQ(OpenOutcome(daemon, ""), "UNAUTHENTICATED");
  EXPECT_EQ(ChildTactusd::Run({"--health-check=" + daemon.address()}), 0);
  Write("arm robot\n");
  daemon.Signal(SIGHUP);
  ASSERT_TRUE(Logs(daemon, "the old tokens stay: " + path_ + ": line 1"))
      << daemon.Log();
  EXPECT_EQ(OpenOutcome(daemon, "first"), "open");
  WriteToken("second");
  daemon.Signal(SIGHUP);
  ASSERT_TRUE(Logs(daemon, "loaded again")) << daemon.Log();
  EXPECT_EQ(OpenOutcome(daemon, "second"), "open");
  EXPECT_EQ(OpenOutcome(daemon, "first"), "UNAUTHENTICATED");
  daemon.Signal(SIGTERM);
  EXPECT_EQ(daemon.Wait(), 0);
}

TEST_F(TactusdTokensTest, RefusedTokensDoNotFloodTheLog) {
  WriteToken("right");
  ChildTactusd daemon(Quiet({"--tokens=" + path_}));
  ASSERT_NE(daemon.port(), 0) << daemon.Log();
  constexpr int kCalls = 300;
  for (int i = 0; i < kCalls; ++i) {
    ASSERT_EQ(OpenOutcome(daemon, "my-secret"), "UNAUTHENTICATED");
  }
  const std::string log = daemon.Log();
  EXPECT_FALSE(absl::StrContains(log, "my-secret"));
  const std::vector<std::string> parts = absl::StrSplit(log, "refused /");
  EXPECT_GT(parts.size(), 1u);
  EXPECT_LT(parts.size(), kCalls / 2);
}

TEST_F(TactusdTokensTest, WrongFlagsAreRefused) {
  WriteToken("right");
  const std::string tokens = "--tokens=" + path_;
  const testing::TlsFiles files;
  ASSERT_TRUE(files.made()) << "needs the openssl program";
  const std::string authority = "--tls-client-ca=" + files.certificate();
  const std::string certificate = "--tls-cert=" + files.certificate();
  const std::string key = "--tls-key=" + files.key();
  const std::string listen = "--listen=127.0.0.1:0";
  EXPECT_EQ(ChildTactusd::Run({listen, authority, tokens}), 1);
  EXPECT_EQ(ChildTactusd::Run({listen, authority, certificate, key}), 1);
  EXPECT_EQ(ChildTactusd::Run({listen, tokens, certificate, key,
                               "--tls-client-ca=" + files.key()}),
            1);
  EXPECT_NE(ChildTactusd::Run({listen, "--tokens=/no/such"}), 0);
  EXPECT_NE(ChildTactusd::Run({listen, "--tokens="}), 0);
  // An empty variable must not mean that everything is open.
  EXPECT_EQ(ChildTactusd::Run({listen}, {"TACTUSD_TOKENS="}), 1);
  EXPECT_EQ(ChildTactusd::Run({listen}, {"TACTUSD_TLS_CLIENT_CA="}), 1);
  Write("arm root x\n");
  EXPECT_EQ(ChildTactusd::Run({listen, tokens}), 1);
  EXPECT_EQ(ChildTactusd::Run({listen}, {"TACTUSD_TOKENS=" + path_}), 1);
}

TEST(TactusdTest, ASecondSignalEndsItAtOnce) {
  ChildTactusd daemon(Quiet({"--drain-grace-ms=3600000"}));
  ASSERT_NE(daemon.port(), 0) << daemon.Log();
  std::atomic<bool> noticed = false;
  auto stream = client::ContactStream::Open(
      client::MakeChannel(daemon.address()),
      testing::ConfigRequest(testing::kModelWithoutPoses).config(),
      [&](const auto& response) { noticed = response.has_notice(); });
  ASSERT_TRUE(stream.ok()) << stream.status();
  daemon.Signal(SIGINT);
  for (int i = 0; i < 2000 && !noticed; ++i) {
    std::this_thread::sleep_for(milliseconds(5));
  }
  ASSERT_TRUE(noticed);
  daemon.Signal(SIGINT);
  EXPECT_EQ(daemon.Wait(), -SIGINT);
  EXPECT_FALSE((*stream)->Close().ok());
}

}  // namespace
}  // namespace tactus::internal
