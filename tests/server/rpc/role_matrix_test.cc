// Every RPC of the contract with every kind of credential.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <set>

#include "core/access/access_table.h"
#include "core/base/errors.h"
#include "google/protobuf/descriptor.pb.h"
#include "gtest/gtest.h"
#include "tests/server/support/raw_call.h"
#include "tests/server/support/test_authority.h"
#include "tests/server/support/test_server.h"
#include "tests/server/support/tls_files.h"

namespace tactus::internal {
namespace {

// The lowest role that may call a method; nothing: everyone may.
using Matrix = std::map<std::string, std::optional<Role>>;

Matrix Expected() {
  Matrix matrix = {{"/grpc.health.v1.Health/Check", std::nullopt},
                   {"/grpc.health.v1.Health/Watch", std::nullopt}};
  const auto add = [&](const std::string& service, Role role,
                       const std::vector<std::string>& methods) {
    for (const std::string& method : methods) {
      matrix["/tactus.v1." + service + "/" + method] = role;
    }
  };
  add("ContactService", Role::kRobot, {"ClassifyContact", "ClassifyTrial"});
  add("ModelService", Role::kRobot,
      {"ListModelVersions", "GetModelVersion", "ListAliases",
       "ListAliasHistory"});
  add("MonitorService", Role::kViewer,
      {"ListStreams", "WatchStream", "WatchAll"});
  add("ContactLogService", Role::kViewer, {"ListContacts", "ReplayContact"});
  add("ContactLogService", Role::kTrainer, {"LabelContacts"});
  add("ModelService", Role::kTrainer, {"ExportModel", "ImportModel"});
  add("ModelService", Role::kAdmin,
      {"DeleteModelVersion", "UpdateAlias", "PromoteModel", "RollbackAlias"});
  add("OperationService", Role::kTrainer,
      {"GetOperation", "ListOperations", "WaitOperation", "WatchOperation",
       "CancelOperation", "DeleteOperation", "ReadOperationLog"});
  add("TrainingService", Role::kTrainer,
      {"CreateDataset", "GetDataset", "ListDatasets", "GetDatasetVersion",
       "ListTrials", "DownloadTrials", "CreateUpload", "WriteUpload",
       "QueryWriteStatus", "FinishUpload", "RelabelTrials", "RemoveTrials",
       "TrainModel", "EvaluateModel"});
  add("TrainingService", Role::kAdmin, {"DeleteDataset"});
  add("AdminService", Role::kAdmin, {"GetServerInfo", "ListAuditLog", "Drain"});
  return matrix;
}

TEST(RoleMatrixTest, HasEveryRpcOfTheContract) {
  google::protobuf::FileDescriptorSet files;
  std::ifstream in(TACTUS_DESCRIPTOR_SET, std::ios::binary);
  ASSERT_TRUE(files.ParseFromIstream(&in)) << TACTUS_DESCRIPTOR_SET;
  std::set<std::string> found = {"/grpc.health.v1.Health/Check",
                                 "/grpc.health.v1.Health/Watch"};
  for (const auto& file : files.file()) {
    for (const auto& service : file.service()) {
      for (const auto& method : service.method()) {
        found.insert(absl::StrCat("/", file.package(), ".", service.name(), "/",
                                  method.name()));
      }
    }
  }
  std::set<std::string> rows;
  for (const auto& [method, role] : Expected()) rows.insert(method);
  EXPECT_EQ(found, rows);
}

// What came of a call, as far as the matrix says.
std::string Outcome(const std::shared_ptr<grpc::Channel>& channel,
                    const std::string& method,
                    const std::string& authorization) {
  const auto answer =
      testing::RawCall(channel, method, "",
                       {.authorization = authorization,
                        .first_only = method.ends_with("/Watch") ||
                                      method.ends_with("WatchAll")});
  const std::string reason = ReasonOf(answer.status);
  if (reason == "UNAUTHENTICATED" || reason == "PERMISSION_DENIED") {
    return reason;
  }
  if (absl::IsUnavailable(answer.status)) return "no connection";
  if (method.find("Health") != std::string::npos) {
    return answer.bytes.empty() ? answer.status.ToString() : "served";
  }
  if (method.find("ContactLog") != std::string::npos) {
    return reason == "NO_CONTACT_LOG" ? "served" : answer.status.ToString();
  }
  if (method.find("ContactService") != std::string::npos) {
    // The request is empty.
    return absl::IsInvalidArgument(answer.status) ? "served"
                                                  : answer.status.ToString();
  }
  // What needs no data directory.
  if (method.find("Monitor") != std::string::npos) {
    // There is no stream.
    const bool ok = method.find("WatchStream") == std::string::npos
                        ? answer.status.ok() || absl::IsCancelled(answer.status)
                        : reason == "STREAM_NOT_FOUND";
    return ok ? "served" : answer.status.ToString();
  }
  if (method == "/tactus.v1.AdminService/GetServerInfo" ||
      method == "/tactus.v1.AdminService/Drain") {
    return answer.bytes.empty() ? answer.status.ToString() : "served";
  }
  return reason == "NO_DATA_DIRECTORY" ? "served" : answer.status.ToString();
}

// What the matrix wants for a caller with a role, or without one.
std::string Want(std::optional<Role> least, std::optional<Role> role) {
  if (!least) return "served";
  if (!role) return "UNAUTHENTICATED";
  return *role < *least ? "PERMISSION_DENIED" : "served";
}

constexpr Role kRoles[] = {Role::kRobot, Role::kViewer, Role::kTrainer,
                           Role::kAdmin};

class RoleServer {
 public:
  RoleServer() {
    std::string text;
    for (const Role role : kRoles) {
      const std::string name(RoleName(role));
      text += *TokenLine(name, role, name + "-token");
      text += "certificate " + name + "-pc " + name + "\n";
    }
    std::ofstream(path_) << text;
    authorizer_ = *server::Authorizer::Open(path_);
    std::filesystem::remove(path_);
    auto identity = *server::ReadTlsIdentity(tls_.certificate(), tls_.key());
    roots_ = identity.certificate_chain;
    identity.client_roots = authority_.certificate();
    server::TactusServer::Options options;
    options.listen = {"127.0.0.1:0", "unix:" + path_ + ".sock"};
    options.tls = identity;
    options.authorizer = authorizer_.get();
    options.on_drain = [] {};
    server_ = *server::TactusServer::Start(&models_, options);
  }

  const testing::TestAuthority& authority() const { return authority_; }
  server::TactusServer& server() { return *server_; }
  std::shared_ptr<grpc::Channel> UnixChannel() const {
    return grpc::CreateChannel("unix:" + path_ + ".sock",
                               grpc::InsecureChannelCredentials());
  }
  // Over TLS, without a certificate if the identity is empty.
  std::shared_ptr<grpc::Channel> Channel(
      const testing::TestAuthority::Identity& identity = {}) const {
    grpc::ChannelArguments arguments;
    // No other channel's connection, which has another certificate.
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    return grpc::CreateCustomChannel(
        absl::StrCat("127.0.0.1:", server_->ports()[0]),
        grpc::SslCredentials({.pem_root_certs = roots_,
                              .pem_private_key = identity.key,
                              .pem_cert_chain = identity.certificate}),
        arguments);
  }

 private:
  const std::string path_ =
      absl::StrCat(::testing::TempDir(), "/roles-", getpid());
  const testing::TlsFiles tls_;
  const testing::TestAuthority authority_;
  std::string roots_;
  testing::TestModels models_;
  std::unique_ptr<server::Authorizer> authorizer_;
  std::unique_ptr<server::TactusServer> server_;
};

struct Column {
  std::string name;
  std::shared_ptr<grpc::Channel> channel;
  std::string authorization;
  std::optional<Role> role;
};

TEST(RoleMatrixTest, EachCredentialMayDoWhatItsRoleMay) {
  RoleServer server;
  const auto& authority = server.authority();
  const auto plain = server.Channel();
  std::vector<Column> columns = {
      {"none", plain, "", {}},
      {"none, unix", server.UnixChannel(), "", {}},
      {"none, in-process", server.server().InProcessChannel(), "", {}},
      {"wrong token", plain, "Bearer root-token", {}},
      {"wrong token, unix", server.UnixChannel(), "Bearer x", {}},
      {"wrong scheme", plain, "Basic admin-token", {}},
      {"certificate without a line",
       server.Channel(authority.Issue("other")),
       "",
       {}},
      {"wrong token, right certificate",
       server.Channel(authority.Issue("admin-pc")),
       "Bearer x",
       {}},
  };
  for (const Role role : kRoles) {
    const std::string name(RoleName(role));
    const auto identity = authority.Issue(name + "-pc");
    ASSERT_FALSE(identity.certificate.empty()) << "needs the openssl program";
    const std::string bearer = "Bearer " + name + "-token";
    columns.push_back({name + " token", plain, bearer, role});
    columns.push_back(
        {name + " token, unix", server.UnixChannel(), bearer, role});
    columns.push_back(
        {name + " certificate", server.Channel(identity), "", role});
  }
  for (const Column& column : columns) {
    for (const auto& [method, least] : Expected()) {
      EXPECT_EQ(Outcome(column.channel, method, column.authorization),
                Want(least, column.role))
          << method << ": " << column.name;
    }
  }
}

// TLS refuses them, so no call arrives, whatever the token.
TEST(RoleMatrixTest, ExpiredAndForeignCertificatesDoNotConnect) {
  RoleServer server;
  const testing::TestAuthority foreign;
  const auto expired = server.authority().Issue("admin-pc", -1);
  const auto unknown = foreign.Issue("admin-pc");
  ASSERT_FALSE(expired.certificate.empty());
  ASSERT_FALSE(unknown.certificate.empty());
  for (const auto& identity : {expired, unknown}) {
    const auto channel = server.Channel(identity);
    for (const auto& [method, least] : Expected()) {
      EXPECT_EQ(Outcome(channel, method, "Bearer admin-token"), "no connection")
          << method;
    }
  }
  EXPECT_EQ(Outcome(server.Channel(), "/grpc.health.v1.Health/Check", ""),
            "served");
}

TEST(RoleMatrixTest, WithoutTokensEverythingIsOpenOnThisHost) {
  server::TactusServer::Options options;
  options.listen = {"127.0.0.1:0"};
  options.on_drain = [] {};
  testing::TestServer server(options);
  for (const auto& channel :
       {server.channel(), server.server().InProcessChannel()}) {
    for (const auto& [method, least] : Expected()) {
      EXPECT_EQ(Outcome(channel, method, ""), "served") << method;
    }
  }
}

}  // namespace
}  // namespace tactus::internal
