// The program itself: flags, port file, signals, exit codes.
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <thread>

#include "client/stream/contact_stream.h"
#include "core/base/errors.h"
#include "core/base/version.h"
#include "gtest/gtest.h"
#include "tests/server/support/requests.h"

namespace tactus {
namespace {

using std::chrono::milliseconds;

// A tactusd process. Killed with the object if it still runs.
class Daemon {
 public:
  explicit Daemon(std::vector<std::string> flags) {
    flags.insert(flags.begin(), TACTUSD);
    std::vector<char*> argv;
    for (std::string& flag : flags) argv.push_back(flag.data());
    argv.push_back(nullptr);
    if (posix_spawn(&pid_, TACTUSD, nullptr, nullptr, argv.data(), environ)) {
      pid_ = -1;
    }
  }
  ~Daemon() {
    if (pid_ < 0) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }

  void Signal(int signal) const { kill(pid_, signal); }
  // Exit code, or minus the signal that ended it.
  int Wait() {
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

 private:
  pid_t pid_ = -1;
};

int RunToEnd(std::vector<std::string> flags) {
  return Daemon(std::move(flags)).Wait();
}

// The address of a daemon that writes to `port_file`; empty if none comes.
std::string AwaitAddress(const std::string& port_file) {
  for (int i = 0; i < 2000; ++i) {
    int port = 0;
    if (std::ifstream(port_file) >> port) {
      return "127.0.0.1:" + std::to_string(port);
    }
    std::this_thread::sleep_for(milliseconds(5));
  }
  return "";
}

class TactusdTest : public ::testing::Test {
 protected:
  TactusdTest()
      : port_file_(::testing::TempDir() + "tactusd-test-" +
                   std::to_string(getpid())) {
    std::remove(port_file_.c_str());
  }
  ~TactusdTest() override { std::remove(port_file_.c_str()); }

  // Flags for a quiet server on a free port, and `more`.
  std::vector<std::string> Flags(const std::string& more) const {
    return {"--listen=127.0.0.1:0", "--port-file=" + port_file_,
            "--log-level=warn", more};
  }

  std::string port_file_;
};

TEST_F(TactusdTest, VersionAndBadFlags) {
  EXPECT_EQ(RunToEnd({"--version"}), 0);
  EXPECT_NE(RunToEnd({"--no-such-flag"}), 0);
  EXPECT_NE(RunToEnd({"--max-streams=0"}), 0);
  EXPECT_NE(RunToEnd({"--model=without-path"}), 0);
  EXPECT_EQ(RunToEnd({"--model=a=/no/such/file"}), 1);
  EXPECT_EQ(RunToEnd({"--log-level=chatty"}), 1);
  EXPECT_EQ(RunToEnd({"--listen=no-such-host.invalid:1"}), 1);
}

TEST_F(TactusdTest, ServesItsBuiltInModelAndStopsOnSigterm) {
  Daemon daemon(Flags("--drain-grace-ms=100"));
  const std::string address = AwaitAddress(port_file_);
  ASSERT_FALSE(address.empty());
  EXPECT_EQ(RunToEnd({"--health-check=" + address}), 0);
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
  EXPECT_EQ(RunToEnd({"--health-check=" + address}), 1);
}

// A self-signed certificate for localhost and 127.0.0.1, made for this run.
class TactusdTlsTest : public TactusdTest {
 protected:
  TactusdTlsTest() : base_(port_file_) {}
  ~TactusdTlsTest() override {
    std::remove(certificate().c_str());
    std::remove(key().c_str());
  }
  bool MakeCertificate() const {
    const std::string command =
        "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes "
        "-days 2 -subj /CN=localhost -addext "
        "subjectAltName=DNS:localhost,IP:127.0.0.1 -keyout " +
        key() + " -out " + certificate() + " 2>/dev/null";
    return std::system(command.c_str()) == 0;
  }
  std::string certificate() const { return base_ + ".crt"; }
  std::string key() const { return base_ + ".key"; }

 private:
  const std::string base_;
};

TEST_F(TactusdTlsTest, SpeaksTlsOnPortsAndPlainOnUnixSockets) {
  ASSERT_TRUE(MakeCertificate()) << "needs the openssl program";
  EXPECT_NE(RunToEnd({"--tls-cert=" + certificate()}), 0);
  EXPECT_EQ(RunToEnd({"--tls-cert=/no/such", "--tls-key=" + key()}), 1);
  EXPECT_EQ(RunToEnd({"--listen=127.0.0.1:0", "--log-level=off",
                      "--tls-cert=" + key(), "--tls-key=" + certificate()}),
            1);
  std::vector<std::string> flags = Flags("--tls-cert=" + certificate());
  const std::string socket = "unix:" + port_file_ + ".sock";
  flags.push_back("--tls-key=" + key());
  flags.push_back("--listen=" + socket);
  Daemon daemon(flags);
  const std::string address = AwaitAddress(port_file_);
  ASSERT_FALSE(address.empty());
  EXPECT_EQ(
      RunToEnd({"--health-check=" + address, "--tls-ca=" + certificate()}), 0);
  EXPECT_EQ(RunToEnd({"--health-check=" + address}), 1);
  EXPECT_EQ(RunToEnd({"--health-check=" + socket}), 0);
  const auto roots = client::ReadRootCertificates(certificate());
  ASSERT_TRUE(roots.ok()) << roots.status();
  for (const std::string& server : {address, socket}) {
    const auto stream = client::ContactStream::Open(
        client::MakeChannel(server, {.tls_roots = *roots}),
        testing::ConfigRequest().config(), [](const auto&) {});
    EXPECT_TRUE(stream.ok()) << server << ": " << stream.status();
  }
}

TEST_F(TactusdTest, ASecondSignalEndsItAtOnce) {
  Daemon daemon(Flags("--drain-grace-ms=3600000"));
  const std::string address = AwaitAddress(port_file_);
  ASSERT_FALSE(address.empty());
  std::atomic<bool> noticed = false;
  auto stream = client::ContactStream::Open(
      client::MakeChannel(address), testing::ConfigRequest().config(),
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
