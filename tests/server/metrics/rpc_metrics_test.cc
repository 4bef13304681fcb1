#include "server/metrics/rpc_metrics.h"

#include "gtest/gtest.h"
#include "server/metrics/open_metrics.h"
#include "tactus/v1/models.pb.h"

namespace tactus::internal::server {
namespace {

constexpr char kList[] = "/tactus.v1.ModelService/ListAliases";

TEST(RpcMetricsTest, CountsCallsUnderTheUsualNames) {
  // The contract is linked.
  v1::ListAliasesRequest::descriptor();
  RpcMetrics metrics;
  metrics.Start(kList);
  metrics.Start(kList);
  metrics.Handle(kList, absl::StatusCode::kOk, 0.03);
  metrics.Handle(kList, absl::StatusCode::kInvalidArgument, 0.03);
  Families families;
  metrics.Collect(&families);
  const std::string text = OpenMetricsText(families);
  const std::string labels =
      "grpc_type=\"unary\",grpc_service=\"tactus.v1.ModelService\","
      "grpc_method=\"ListAliases\"";
  for (const std::string& line :
       {"grpc_server_started_total{" + labels + "} 2\n",
        "grpc_server_handled_total{" + labels + ",grpc_code=\"OK\"} 1\n",
        "grpc_server_handled_total{" + labels +
            ",grpc_code=\"InvalidArgument\"} 1\n",
        "grpc_server_handling_seconds_count{" + labels + "} 2\n"}) {
    EXPECT_NE(text.find(line), std::string::npos) << line << text;
  }
}

// A stranger may call any name; none of them becomes a label.
TEST(RpcMetricsTest, MethodsThatDoNotExistAreOne) {
  RpcMetrics metrics;
  for (const char* method : {"/a/b", "/tactus.v1.ModelService/No", "", "x"}) {
    metrics.Start(method);
    metrics.Handle(method, absl::StatusCode::kUnimplemented, 0);
  }
  Families families;
  metrics.Collect(&families);
  ASSERT_EQ(families[0].name, "grpc_server_started_total");
  ASSERT_EQ(families[0].metric.size(), 1u);
  EXPECT_EQ(families[0].metric[0].counter.value, 4);
  EXPECT_EQ(families[0].metric[0].label[2].value, "unknown");
}

}  // namespace
}  // namespace tactus::internal::server
