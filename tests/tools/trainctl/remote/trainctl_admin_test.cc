// trainctl server, jobs logs and doctor against a server with a data directory.
#include <atomic>
#include <cstdlib>
#include <fstream>
#include <optional>

#include "core/access/access_table.h"
#include "core/base/sha256.h"
#include "core/base/version.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/ops/authorizer.h"
#include "spdlog/spdlog.h"
#include "tests/server/support/test_authority.h"
#include "tests/server/support/tls_files.h"
#include "tests/server/support/training_server.h"
#include "tests/support/scratch_dir.h"
#include "tools/common/json.h"
#include "tools/trainctl/app.h"
#include "tools/trainctl/exit_code.h"

namespace tactus::internal::client {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

struct AdminRun {
  int exit = -1;
  std::string out;
  std::string err;

  // The check `name` of doctor --json.
  Json Check(const std::string& name) const {
    for (const Json& check : Json::parse(out)) {
      if (check["check"] == name) return check;
    }
    return Json::object();
  }
  std::string Severity(const std::string& name) const {
    return Check(name).value("severity", "absent");
  }
};

AdminRun RunAdmin(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "trainctl");
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  AdminRun run;
  run.exit = RunTrainctl(static_cast<int>(argv.size()), argv.data());
  run.out = ::testing::internal::GetCapturedStdout();
  run.err = ::testing::internal::GetCapturedStderr();
  return run;
}

class TrainctlAdminTest : public ::testing::Test {
 protected:
  // The log of the server goes to stdout, as the results do.
  TrainctlAdminTest() { spdlog::set_level(spdlog::level::off); }

  // A server at the unix socket; `serving` may add addresses.
  void Start(server::TactusServer::Options serving = {},
             const std::string& data = "") {
    serving.listen.insert(serving.listen.begin(), address_);
    serving.on_drain = [this] { ++drains_; };
    server_.emplace(server::TrainingBackend::Options{.folder = data}, serving);
  }
  AdminRun Run(std::vector<std::string> arguments) const {
    arguments.push_back("--server=" + address_);
    return RunAdmin(arguments);
  }

  ScratchDir folder_;
  const std::string address_ = "unix:" + (folder_ / "s");
  std::atomic<int> drains_ = 0;
  std::optional<tactus::internal::testing::TrainingServer> server_;
};

TEST_F(TrainctlAdminTest, ShowsTheStateOfTheServer) {
  Start();
  server_->Upload("datasets/arm", tactus::internal::testing::SmallPack());
  AdminRun run = Run({"server", "info"});
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr(kVersion), HasSubstr("0 of 2000"),
                             HasSubstr("blobs"), HasSubstr("queued jobs")));
  run = Run({"server", "info", "--json"});
  EXPECT_GT(Json::parse(run.out)["data"]["blob_bytes"], 0);
}

TEST_F(TrainctlAdminTest, ListsTheAuditLog) {
  Start();
  server_->Upload("datasets/arm", tactus::internal::testing::SmallPack());
  AdminRun run = Run({"server", "audit"});
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(run.out,
              AllOf(HasSubstr("create"), HasSubstr("datasets/arm/versions/1"),
                    HasSubstr("uploads/1")));
  run = Run({"server", "audit", "--resource=uploads/", "--json"});
  EXPECT_EQ(Json::parse(run.out).size(), 1u);
  run = Run({"server", "audit", "--limit=1", "--json"});
  EXPECT_EQ(Json::parse(run.out)[0]["resource"], "datasets/arm/versions/1");
}

TEST_F(TrainctlAdminTest, DrainsTheServer) {
  Start();
  const AdminRun run = Run({"server", "drain"});
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("0 open streams have 5000 ms"));
  EXPECT_EQ(drains_, 1);
}

TEST_F(TrainctlAdminTest, PrintsTheLogOfAJob) {
  Start();
  v1::Operation ended;
  ended.set_state(v1::Operation::STATE_FAILED);
  auto& operations = server_->backend().operations();
  ASSERT_TRUE(operations.Create(ended, "", {"a", ""}).ok());
  v1::StoredLog log;
  log.set_data("one\ntwo \x1b[2J\n");
  log.set_omitted_bytes(9);
  ASSERT_TRUE(operations.SaveLog("operations/1", log).ok());
  AdminRun run = Run({"jobs", "logs", "1"});
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_EQ(run.out, "one\ntwo ?[2J\n");
  EXPECT_THAT(run.err, HasSubstr("9 bytes"));
  run = Run({"jobs", "logs", "1", "--json"});
  EXPECT_EQ(Json::parse(run.out)["text"], "one\ntwo ?[2J\n");
  EXPECT_EQ(Run({"jobs", "logs", "2"}).exit, kExitError);
}

TEST_F(TrainctlAdminTest, DeletesAJobThatHasEnded) {
  Start();
  v1::Operation job;
  job.set_kind(v1::Operation::KIND_EVALUATE);
  job.set_state(v1::Operation::STATE_SUCCEEDED);
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(
        server_->backend().operations().Create(job, "", {"ada", ""}).ok());
  }
  AdminRun run = Run({"jobs", "delete", "1"});
  EXPECT_EQ(run.exit, 0) << run.err;
  EXPECT_EQ(run.out, "operations/1 deleted\n");
  EXPECT_EQ(Run({"jobs", "delete", "1"}).exit, kExitError);
  run = Run({"jobs", "delete", "2", "--json"});
  EXPECT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("\"operations/2\""));
}

TEST_F(TrainctlAdminTest, DoctorFindsAGoodServerWell) {
  Start();
  AdminRun run = Run({"doctor"});
  EXPECT_EQ(run.exit, 0) << run.out << run.err;
  EXPECT_THAT(
      run.out,
      AllOf(HasSubstr("ok       connection"), HasSubstr("with the role admin"),
            HasSubstr("models/default/versions/1"), Not(HasSubstr("To do"))));
  run = Run({"doctor", "--json"});
  EXPECT_EQ(run.Severity("clock"), "ok");
  EXPECT_EQ(run.Severity("version"), "ok");
  EXPECT_EQ(run.Severity("data directory"), "ok");
}

TEST_F(TrainctlAdminTest, DoctorSaysWhatToDoWithoutAServer) {
  AdminRun run = Run({"doctor", "--json"});
  EXPECT_EQ(run.exit, kExitDoctorErrors);
  EXPECT_EQ(run.Severity("connection"), "error");
  EXPECT_THAT(run.out, HasSubstr("tactusd --data-dir"));
  EXPECT_EQ(RunAdmin({"doctor"}).exit, kExitUsage);
  EXPECT_EQ(Run({"doctor", "--repair"}).exit, kExitUsage);
}

TEST_F(TrainctlAdminTest, DoctorKnowsTheRoleOfAToken) {
  const std::string tokens = folder_ / "tokens";
  std::ofstream(tokens) << *TokenLine("tim", Role::kTrainer, "trainer-token")
                        << *TokenLine("ada", Role::kAdmin, "admin-token");
  const auto authorizer = *server::Authorizer::Open(tokens);
  server::TactusServer::Options serving;
  serving.authorizer = authorizer.get();
  Start(serving);
  const auto doctor = [&](const std::string& token) {
    const std::string file = folder_ / "token";
    std::ofstream(file) << token << "\n";
    return Run({"doctor", "--json", "--token-file=" + file});
  };
  AdminRun run = doctor("admin-token");
  EXPECT_EQ(run.exit, 0) << run.out << run.err;
  EXPECT_THAT(run.Check("credential")["text"], HasSubstr("ada"));
  run = doctor("trainer-token");
  EXPECT_EQ(run.exit, kExitDoctorWarnings) << run.out << run.err;
  EXPECT_THAT(run.Check("credential")["text"], HasSubstr("role trainer"));
  EXPECT_EQ(run.Severity("default model"), "ok");
  run = doctor("wrong-token");
  EXPECT_EQ(run.exit, kExitDoctorErrors);
  EXPECT_EQ(run.Severity("credential"), "error");
}

TEST_F(TrainctlAdminTest, DoctorSeesAModelThatIsNotServed) {
  const std::string data = folder_ / "data";
  const std::string bundle =
      *EncodeBundle(tactus::internal::testing::SmallModel());
  {
    server::ModelRegistry registry;
    const auto backend =
        *server::TrainingBackend::Open({.folder = data}, &registry);
    v1::PromoteSpec spec;
    spec.set_alias("aliases/default");
    spec.set_model_version("models/arm/versions/1");
    const server::Caller ada = {"ada", ""};
    ASSERT_TRUE(
        backend->models().AddVersion("models/arm", bundle, {}, ada).ok());
    ASSERT_TRUE(backend->models().Promote(spec, false, ada).ok());
  }
  const std::string sha256 = Sha256Hex(bundle);
  std::ofstream(data + "/blobs/" + sha256.substr(0, 2) + "/" + sha256) << "x";
  Start({}, data);
  const AdminRun run = Run({"doctor", "--json"});
  EXPECT_EQ(run.exit, kExitDoctorErrors) << run.out;
  EXPECT_EQ(run.Severity("stored models"), "error");
  EXPECT_EQ(run.Severity("default model"), "error");
}

TEST_F(TrainctlAdminTest, DoctorJudgesTheCertificate) {
  const tactus::internal::testing::TlsFiles tls;
  server::TactusServer::Options serving;
  serving.tls = *server::ReadTlsIdentity(tls.certificate(), tls.key());
  serving.listen = {"127.0.0.1:0"};
  Start(serving);
  const std::string port = std::to_string(server_->port(1));
  const auto doctor = [&](const std::string& host, const std::string& ca) {
    return RunAdmin({"doctor", "--json", "--tls-ca=" + ca,
                     "--server=" + host + ":" + port});
  };
  AdminRun run = doctor("127.0.0.1", tls.certificate());
  EXPECT_EQ(run.Severity("connection"), "ok") << run.out;
  // The certificate of the test is valid for some days only.
  EXPECT_EQ(run.Severity("certificate"), "warning") << run.out;
  EXPECT_THAT(run.Check("certificate")["text"], HasSubstr("ends in"));
  EXPECT_EQ(run.exit, kExitDoctorWarnings);
  const tactus::internal::testing::TestAuthority other;
  run = doctor("127.0.0.1", other.file());
  EXPECT_EQ(run.exit, kExitDoctorErrors);
  EXPECT_EQ(run.Severity("certificate"), "error") << run.out;
  EXPECT_EQ(run.Severity("connection"), "error") << run.out;
}

// gRPC only reports a handshake that failed.
TEST_F(TrainctlAdminTest, DoctorSaysThatACertificateHasEnded) {
  const tactus::internal::testing::TestAuthority authority;
  const auto identity = authority.Issue("localhost", -1);
  ASSERT_FALSE(identity.certificate.empty()) << "needs the openssl program";
  server::TactusServer::Options serving;
  serving.tls = {.certificate_chain = identity.certificate,
                 .private_key = identity.key};
  serving.listen = {"127.0.0.1:0"};
  Start(serving);
  const AdminRun run =
      RunAdmin({"doctor", "--json", "--tls-ca=" + authority.file(),
                "--server=localhost:" + std::to_string(server_->port(1))});
  EXPECT_EQ(run.exit, kExitDoctorErrors);
  EXPECT_THAT(run.Check("certificate")["text"], HasSubstr("expired"));
}

TEST_F(TrainctlAdminTest, DoctorChecksADirectory) {
  const std::string data = folder_ / "data";
  server::ModelRegistry registry;
  ASSERT_TRUE(server::TrainingBackend::Open({.folder = data}, &registry).ok());
  AdminRun run = RunAdmin({"doctor", "--data-dir=" + data});
  EXPECT_THAT(run.out, HasSubstr("ok       blobs"));
  std::ofstream(data + "/uploads/5") << "stray";
  run = RunAdmin({"doctor", "--data-dir=" + data, "--json"});
  EXPECT_EQ(run.exit, kExitDoctorWarnings);
  EXPECT_EQ(run.Severity("stray uploads"), "warning");
  EXPECT_THAT(run.Check("stray uploads")["advice"], HasSubstr("--repair"));
  run = RunAdmin({"doctor", "--data-dir=" + data, "--repair"});
  EXPECT_THAT(run.out, HasSubstr("lost+found/1: 1 files of uploads"));
  run = RunAdmin({"doctor", "--data-dir=" + (folder_ / "none")});
  EXPECT_EQ(run.exit, kExitDoctorErrors);
}

}  // namespace
}  // namespace tactus::internal::client
