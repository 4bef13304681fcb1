// With empty TLS flags the server used plaintext and logged nothing about it.
// An address that begins with "unix" was taken for an unencrypted unix socket.
#include "client/stream/channel.h"
#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "tests/server/support/test_server.h"
#include "tests/server/support/tls_files.h"
#include "tests/support/bystander.h"
#include "tests/support/child_tactusd.h"
#include "tests/support/time_limit.h"

namespace tactus::internal {
namespace {

using testing::Bystander;
using testing::ChildTactusd;
using testing::TlsFiles;

TEST(TlsFailsOpenTest, EmptyFlagsAndVariablesAreRefused) {
  const TlsFiles files;
  ASSERT_TRUE(files.made()) << "needs the openssl program";
  const std::string certificate = "--tls-cert=" + files.certificate();
  for (const std::vector<std::string>& flags :
       {std::vector<std::string>{certificate, "--tls-key", ""},
        {"--tls-cert", "", "--tls-key", ""},
        {certificate},
        {certificate, "--tls-key=/dev/null"}}) {
    EXPECT_NE(ChildTactusd::Run(flags), 0) << flags[0];
  }
  EXPECT_NE(ChildTactusd::Run({"--listen=127.0.0.1:0"},
                              {"TACTUSD_TLS_CERT=", "TACTUSD_TLS_KEY="}),
            0);
}

TEST(TlsFailsOpenTest, OnlyTheUnixPrefixIsAUnixSocket) {
  // Such a host does not exist; as a unix socket it could be listened on.
  EXPECT_NE(ChildTactusd::Run({"--listen=unixbox.invalid:50051"}), 0);
}

TEST(TlsFailsOpenTest, ClientWithoutCertificatesMakesNoConnection) {
  EXPECT_EQ(ReasonOf(client::ReadRootCertificates("").status()), "IO");
  EXPECT_EQ(ReasonOf(client::ReadRootCertificates("/dev/null").status()), "IO");
  ChildTactusd plain;
  ASSERT_NE(plain.port(), 0);
  const testing::TimeLimit limit("the client has a stream without TLS",
                                 [&] { plain.Signal(SIGKILL); });
  testing::RawStream stream(
      client::MakeChannel(plain.address(), {.tls_roots = ""}));
  stream.Write(testing::ConfigRequest(testing::kModelWithoutPoses));
  EXPECT_FALSE(stream.Finish().ok());
  Bystander robot(plain.address());
  EXPECT_TRUE(robot.IsServed());
}

TEST(TlsFailsOpenTest, LogAndHealthCheckKnowOfTls) {
  // The certificate is for another name than the health check calls.
  const TlsFiles files("DNS:arm.lab");
  ASSERT_TRUE(files.made()) << "needs the openssl program";
  const std::vector<std::string> variables = {
      "TACTUSD_TLS_CERT=" + files.certificate(),
      "TACTUSD_TLS_KEY=" + files.key()};
  const std::string socket = "unix:" + files.key() + ".sock";
  ChildTactusd server(
      {.flags = {"--listen=" + socket}, .environment = variables});
  ASSERT_NE(server.port(), 0) << server.Log();
  EXPECT_NE(server.Log().find(", TLS\n"), std::string::npos) << server.Log();
  EXPECT_NE(server.Log().find(socket + ", plaintext\n"), std::string::npos);
  const std::string check = "--health-check=" + server.address();
  EXPECT_EQ(ChildTactusd::Run({check}, variables), 0);
  EXPECT_NE(ChildTactusd::Run({check}), 0);
  const TlsFiles foreign;
  EXPECT_NE(
      ChildTactusd::Run({check}, {"TACTUSD_TLS_CERT=" + foreign.certificate()}),
      0);
  Bystander robot(socket);
  EXPECT_TRUE(robot.IsServed());
}

}  // namespace
}  // namespace tactus::internal
