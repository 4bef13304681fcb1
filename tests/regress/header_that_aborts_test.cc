// A call with the header `grpclb_client_stats` ended the process, with or
// without TLS: gRPC aborts when it hands that header to a processor of
// authentication metadata, which is where calls are gated.
#include <openssl/ssl.h>

#include <memory>
#include <string>
#include <vector>

#include "gtest/gtest.h"
#include "tests/server/support/tls_files.h"
#include "tests/support/bystander.h"
#include "tests/support/child_tactusd.h"
#include "tests/support/raw_http2.h"

namespace tactus::internal {
namespace {

using std::chrono::milliseconds;
using testing::Bystander;
using testing::ChildTactusd;
using testing::RawHttp2;
using testing::TlsFiles;

// The names that gRPC 1.51 gives a meaning, in a request or an answer.
const char* const kNames[] = {":authority",
                              ":method",
                              ":path",
                              ":scheme",
                              ":status",
                              "authorization",
                              "content-length",
                              "content-type",
                              "endpoint-load-metrics-bin",
                              "grpc-accept-encoding",
                              "grpc-encoding",
                              "grpc-internal-encoding-request",
                              "grpc-internal-stream-encoding-request",
                              "grpc-message",
                              "grpc-payload-bin",
                              "grpc-previous-rpc-attempts",
                              "grpc-retry-pushback-ms",
                              "grpc-server-stats-bin",
                              "grpc-status",
                              "grpc-status-details-bin",
                              "grpc-tags-bin",
                              "grpc-timeout",
                              "grpc-trace-bin",
                              "grpclb_client_stats",
                              "host",
                              "lb-cost-bin",
                              "lb-token",
                              "te",
                              "user-agent",
                              "x-envoy-peer-metadata"};

std::vector<std::string> Values() {
  return {"",         "abc",    "1",  "-1",
          "\xff\xfe", "AAECAw", "1S", std::string(1000, 'x')};
}

// Opens a call with each name and each value, alone and twice, on a connection
// that nobody else uses.
void SendAll(int port) {
  for (const char* name : kNames) {
    for (const std::string& value : Values()) {
      RawHttp2 stranger(port);
      stranger.Open("/tactus.v1.ContactService/ClassifyContact",
                    {{name, value}});
      stranger.Open("/tactus.v1.ContactService/ClassifyContact",
                    {{name, value}, {name, value}});
      // As trailers of a call that goes on.
      const uint32_t call =
          stranger.Open("/tactus.v1.ContactService/ClassifyContact");
      stranger.Trailers(call, {{name, value}});
      stranger.Flush();
      stranger.ReadFor(milliseconds(2));
    }
  }
}

TEST(HeaderThatAbortsTest, NoHeaderEndsTheServer) {
  ChildTactusd server({"--log-level=warn"});
  ASSERT_NE(server.port(), 0);
  Bystander robot(server.address());
  ASSERT_TRUE(robot.IsServed());
  SendAll(server.port());
  EXPECT_TRUE(robot.IsServed());
  EXPECT_TRUE(robot.Finish().ok());
  server.Signal(SIGTERM);
  EXPECT_EQ(server.Wait(), 0);
}

// Writes `bytes` over TLS and reads until the server closes the connection.
void SendOverTls(int port, const std::string& bytes) {
  const std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context(
      SSL_CTX_new(TLS_client_method()), SSL_CTX_free);
  SSL_CTX_set_alpn_protos(context.get(),
                          reinterpret_cast<const uint8_t*>("\2h2"), 3);
  const std::unique_ptr<BIO, decltype(&BIO_free_all)> connection(
      BIO_new_ssl_connect(context.get()), BIO_free_all);
  BIO_set_conn_hostname(connection.get(), "127.0.0.1");
  BIO_set_conn_port(connection.get(), std::to_string(port).c_str());
  ASSERT_EQ(BIO_do_connect(connection.get()), 1);
  BIO_write(connection.get(), bytes.data(), static_cast<int>(bytes.size()));
  char answer[1024];
  while (BIO_read(connection.get(), answer, sizeof(answer)) > 0) {
  }
}

TEST(HeaderThatAbortsTest, TlsDoesNotHideIt) {
  const TlsFiles files;
  ASSERT_TRUE(files.made()) << "needs the openssl program";
  ChildTactusd server({"--log-level=warn", "--tls-cert=" + files.certificate(),
                       "--tls-key=" + files.key()});
  ASSERT_NE(server.port(), 0);
  SendOverTls(server.port(),
              std::string(RawHttp2::kPreface) +
                  RawHttp2::FrameBytes(RawHttp2::kSettings, 0, 0, "") +
                  RawHttp2::FrameBytes(
                      RawHttp2::kHeaders, RawHttp2::kEndHeaders, 1,
                      RawHttp2::Block("/grpc.health.v1.Health/Check",
                                      {{"grpclb_client_stats", "1"}})));
  EXPECT_TRUE(testing::Eventually([&] {
    return server.Log().find(
               "closed a connection from a TLS peer: the header "
               "grpclb_client_stats") != std::string::npos;
  })) << server.Log();
  server.Signal(SIGTERM);
  EXPECT_EQ(server.Wait(), 0);
}

TEST(HeaderThatAbortsTest, ItsConnectionIsClosedAndTheLogSaysWhy) {
  ChildTactusd server({"--log-level=warn"});
  ASSERT_NE(server.port(), 0);
  RawHttp2 stranger(server.port());
  stranger.Open("/grpc.health.v1.Health/Check",
                {{"grpclb_client_stats", "abc"}});
  stranger.Flush();
  EXPECT_TRUE(stranger.ReadUntil([&] { return !stranger.open(); },
                                 milliseconds(10'000)));
  EXPECT_NE(server.Log().find("closed a connection from 127.0.0.1: the header "
                              "grpclb_client_stats"),
            std::string::npos)
      << server.Log();
}

}  // namespace
}  // namespace tactus::internal
