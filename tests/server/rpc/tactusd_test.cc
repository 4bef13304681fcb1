// The program itself: flags, port file, signals, exit codes.
#include <signal.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "client/stream/contact_stream.h"
#include "core/base/errors.h"
#include "core/base/version.h"
#include "gtest/gtest.h"
#include "tests/server/support/requests.h"
#include "tests/server/support/tls_files.h"
#include "tests/support/child_tactusd.h"

namespace tactus {
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
  v1::StreamConfig config = testing::ConfigRequest().config();
  bool noticed = false;
  bool final = false;
  auto stream = client::ContactStream::Open(
      client::MakeChannel(address), config, [&](const auto& response) {
        noticed |= response.has_notice();
        final |= response.posterior().is_final();
      });
  ASSERT_TRUE(stream.ok()) << stream.status();
  EXPECT_EQ((*stream)->started().model_version(), "models/default/versions/1");
  EXPECT_EQ((*stream)->started().server().version(), kVersion);
  ASSERT_TRUE((*stream)->Send(testing::DenseU16(1, {testing::Touch(1)})).ok());
  daemon.Signal(SIGTERM);
  EXPECT_EQ(daemon.Wait(), 0);
  EXPECT_EQ(ReasonOf((*stream)->Close()), "DRAINING");
  EXPECT_TRUE(noticed);
  EXPECT_TRUE(final);
  EXPECT_EQ(ChildTactusd::Run({"--health-check=" + address}), 1);
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
  const std::string socket = "unix:" + files.key() + ".sock";
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
        testing::ConfigRequest().config(), [](const auto&) {});
    EXPECT_TRUE(stream.ok()) << server << ": " << stream.status();
  }
}

TEST(TactusdTest, ASecondSignalEndsItAtOnce) {
  ChildTactusd daemon(Quiet({"--drain-grace-ms=3600000"}));
  ASSERT_NE(daemon.port(), 0) << daemon.Log();
  std::atomic<bool> noticed = false;
  auto stream = client::ContactStream::Open(
      client::MakeChannel(daemon.address()), testing::ConfigRequest().config(),
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
}  // namespace tactus
