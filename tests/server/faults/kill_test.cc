// Kills of server and trainer at random moments while a client uploads, trains
// and promotes. Whatever the server acknowledged is there after each restart,
// and all of it is as if nothing had been killed.
//
// TACTUS_KILLS sets how many kills, TACTUS_SEED the seed.
#include <chrono>
#include <cstdlib>
#include <functional>

#include "core/base/crc32c.h"
#include "core/base/errors.h"
#include "core/base/status_proto.h"
#include "gtest/gtest.h"
#include "tests/server/faults/acknowledged.h"
#include "tests/server/faults/killed_server.h"
#include "tests/support/scratch_dir.h"
#include "tests/support/small_trials.h"

namespace tactus::internal {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using std::chrono::steady_clock;
using testing::Acknowledged;
using testing::KilledServer;
using v1::Operation;

constexpr char kArm[] = "datasets/arm";
constexpr char kAlias[] = "aliases/default";

uint64_t FromEnvironment(const char* name, uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

// A client that repeats each call until the server has answered it. Every call
// of it has the same effect however often it arrives.
class Script {
 private:
  // The answer to `call`, which is made again after each restart.
  template <typename Call>
  auto Do(const Call& call) {
    while (true) {
      auto answer = call(server_.client());
      if (answer.ok()) return *std::move(answer);
      if (!server_.Died()) {
        ADD_FAILURE() << phase_ << ": " << answer.status();
        return std::decay_t<decltype(*answer)>();
      }
      server_.Restart();
      log_.Check(server_.client(), /*whole=*/false);
      server_.Arm(phase_, longest_);
      if (::testing::Test::HasFailure()) {
        return std::decay_t<decltype(*answer)>();
      }
    }
  }

 public:
  explicit Script(KilledServer* server) : server_(*server) {}

  const Acknowledged& log() const { return log_; }

  void Prepare() {
    Do([](auto& client) {
      auto made = client.CreateDataset(kArm, "");
      return ReasonOf(made.status()) == "DATASET_EXISTS"
                 ? absl::StatusOr<v1::Dataset>(v1::Dataset())
                 : made;
    });
  }

  // Upload, train, promote; sometimes roll back. `round` counts from 1.
  void Round(int round) {
    UploadTrials(round);
    const Operation trained = Train(round);
    if (::testing::Test::HasFailure()) return;
    Promote(round, trained.result().model_version());
    if (round == 1) SetGate();
    if (round % 3 == 0) Rollback();
  }

  // Everything is there, whole, and nothing is left that has not ended.
  void CheckAll() {
    log_.Check(server_.client(), /*whole=*/true);
    for (const auto state : {Operation::STATE_QUEUED, Operation::STATE_RUNNING,
                             Operation::STATE_CANCELLING}) {
      const auto left = server_.client().ListOperations(state, 10);
      ASSERT_TRUE(left.ok()) << left.status();
      EXPECT_TRUE(left->empty());
    }
    const auto all =
        server_.client().ListOperations(Operation::STATE_UNSPECIFIED, 100'000);
    ASSERT_TRUE(all.ok()) << all.status();
    EXPECT_EQ(all->size(), log_.operations.size());
  }

 private:
  void Begin(const char* phase, milliseconds longest) {
    phase_ = phase;
    longest_ = longest;
    server_.Arm(phase, longest);
  }

  void UploadTrials(int round) {
    Begin("upload", milliseconds(25));
    const std::string pack = testing::SmallPack(round, round + 16);
    v1::CreateUploadRequest create;
    create.set_dataset(kArm);
    create.set_request_id("upload-" + std::to_string(round));
    create.set_replace(true);
    const auto upload =
        Do([&](auto& client) { return client.CreateUpload(create); });
    log_.upload = upload.upload();
    log_.committed = upload.committed_size();
    while (log_.committed < static_cast<int64_t>(pack.size()) &&
           !::testing::Test::HasFailure()) {
      log_.committed = Do([&](auto& client) { return Write(client, pack); });
    }
    Begin("check of an upload", milliseconds(15));
    v1::FinishUploadRequest finish;
    finish.set_upload(log_.upload);
    finish.set_size(static_cast<int64_t>(pack.size()));
    finish.set_crc32c(ExtendCrc32c(0, pack));
    const auto finished =
        Do([&](auto& client) { return client.FinishUpload(finish); });
    log_.upload.clear();
    const v1::DatasetVersion& version = finished.version();
    EXPECT_EQ(version.name(), VersionOf(kArm, round));
    log_.versions[version.name()] = {version.sha256(), Do([&](auto& client) {
                                       return testing::Download(client,
                                                                version.name());
                                     })};
  }
  static std::string VersionOf(const std::string& parent, int number) {
    return parent + "/versions/" + std::to_string(number);
  }

  // Two chunks from what the server has on; returns what it then has.
  absl::StatusOr<int64_t> Write(client::TrainingClient& client,
                                const std::string& pack) {
    constexpr size_t kChunk = 3'000;
    const auto status = client.QueryWriteStatus(log_.upload);
    if (!status.ok()) return status.status();
    EXPECT_GE(status->committed_size(), log_.committed);
    auto offset = static_cast<size_t>(status->committed_size());
    // The server may have all of it, and its answer was lost.
    if (offset == pack.size()) return status->committed_size();
    const auto context = client.NewContext(client.timeout());
    v1::WriteUploadResponse response;
    const auto writer = client.training().WriteUpload(context.get(), &response);
    for (int i = 0; i < 2 && offset < pack.size(); ++i) {
      v1::WriteUploadRequest chunk;
      chunk.set_upload(log_.upload);
      chunk.set_write_offset(static_cast<int64_t>(offset));
      chunk.set_data(pack.substr(offset, kChunk));
      chunk.set_crc32c(ExtendCrc32c(0, chunk.data()));
      offset += chunk.data().size();
      if (!writer->Write(chunk)) break;
    }
    writer->WritesDone();
    const absl::Status end = client::TrainingClient::ErrorOf(
        writer->Finish(), "WriteUpload", client.timeout());
    if (!end.ok()) return end;
    return response.committed_size();
  }

  Operation Train(int round) {
    Begin("training", milliseconds(250));
    v1::TrainModelRequest request;
    request.mutable_spec()->set_dataset_version(VersionOf(kArm, round));
    request.mutable_spec()->set_model("models/arm");
    request.mutable_spec()->set_preset("paper");
    request.mutable_spec()->set_networks(1);
    request.mutable_spec()->set_epochs(20);
    request.set_request_id("train-" + std::to_string(round));
    const auto operation =
        Do([&](auto& client) { return client.TrainModel(request); });
    log_.operations[request.request_id()] = operation.name();
    const Operation done = End(operation.name());
    const std::string version = done.result().model_version();
    EXPECT_EQ(version, VersionOf("models/arm", round));
    const auto bundle =
        Do([&](auto& client) { return client.ExportModel(version); });
    log_.bundles[version] = bundle;
    return done;
  }
  // Waits for the end, which must come and be a success.
  Operation End(const std::string& name) {
    const auto give_up = steady_clock::now() + seconds(120);
    Operation operation;
    do {
      operation = Do([&](auto& client) { return Wait(client, name); });
    } while (!client::HasEnded(operation) && !::testing::Test::HasFailure() &&
             steady_clock::now() < give_up);
    EXPECT_EQ(operation.state(), Operation::STATE_SUCCEEDED)
        << operation.ShortDebugString();
    log_.ended[name] = operation;
    return operation;
  }
  static absl::StatusOr<Operation> Wait(client::TrainingClient& client,
                                        const std::string& name) {
    v1::WaitOperationRequest request;
    request.set_name(name);
    request.set_timeout_ms(1'000);
    v1::WaitOperationResponse response;
    const auto context = client.NewContext(client.timeout());
    const absl::Status status = client::TrainingClient::ErrorOf(
        client.operations().WaitOperation(context.get(), request, &response),
        "WaitOperation", client.timeout());
    if (!status.ok()) return status;
    return response.operation();
  }

  // Through the gate in odd rounds, by force in even ones.
  void Promote(int round, const std::string& version) {
    Begin("promotion", milliseconds(60));
    v1::PromoteModelRequest request;
    request.mutable_spec()->set_alias(kAlias);
    request.mutable_spec()->set_model_version(version);
    request.mutable_spec()->set_force(round % 2 == 0);
    request.set_request_id("promote-" + std::to_string(round));
    log_.change_requested = true;
    const auto operation =
        Do([&](auto& client) { return client.PromoteModel(request); });
    log_.operations[request.request_id()] = operation.name();
    End(operation.name());
    Changed({version, round % 2 == 0, false});
  }
  // The newest change of the alias is known, as `change`.
  void Changed(const Acknowledged::Change& change) {
    log_.change_requested = false;
    log_.changes.push_back(change);
    log_.etag.clear();
    const v1::Alias alias = TheAlias();
    EXPECT_EQ(alias.model_version(), change.model_version);
    log_.etag = alias.etag();
  }
  v1::Alias TheAlias() {
    return Do([](auto& client) -> absl::StatusOr<v1::Alias> {
      const auto aliases = client.ListAliases();
      if (!aliases.ok()) return aliases.status();
      return aliases->empty() ? v1::Alias() : aliases->front();
    });
  }
  void SetGate() {
    v1::UpdateAliasRequest request;
    request.set_name(kAlias);
    request.mutable_gate()->set_dataset_version(VersionOf(kArm, 1));
    request.mutable_gate()->set_accuracy_margin(1);
    request.mutable_gate()->set_log_loss_margin(1e6);
    request.mutable_gate()->set_calibration_margin(1);
    // The call may have changed it before the server is killed.
    log_.etag.clear();
    Do([&](auto& client) { return client.UpdateAlias(request); });
    log_.etag = TheAlias().etag();
  }
  void Rollback() {
    Begin("rollback", milliseconds(10));
    const v1::Alias before = TheAlias();
    log_.change_requested = true;
    const auto after = Do([&](auto& client) -> absl::StatusOr<v1::Alias> {
      auto alias = client.RollbackAlias(kAlias, before.etag());
      if (ReasonOf(alias.status()) != "ETAG_MISMATCH") return alias;
      // It was done before the server was killed.
      const auto aliases = client.ListAliases();
      if (!aliases.ok()) return aliases.status();
      return aliases->front();
    });
    EXPECT_EQ(after.model_version(), before.previous_version());
    Changed({after.model_version(), false, true});
  }

  KilledServer& server_;
  Acknowledged log_;
  const char* phase_ = "preparation";
  milliseconds longest_{0};
};

TEST(KillTest, NothingThatWasAcknowledgedIsLost) {
  const auto kills = static_cast<int>(FromEnvironment("TACTUS_KILLS", 10));
  const uint64_t seed = FromEnvironment("TACTUS_SEED", 20261122);
  std::printf("seed %lu\n", seed);
  const auto begin = steady_clock::now();
  const ScratchDir folder;
  KilledServer server(folder / "killed", seed);
  if (HasFailure()) return;
  Script script(&server);
  script.Prepare();
  int rounds = 0;
  while (server.kills() < kills && !HasFailure()) {
    script.Round(++rounds);
    std::printf("round %d, %d kills\n", rounds, server.kills());
    std::fflush(stdout);
  }
  server.Calm();
  if (HasFailure()) return;
  if (server.Died()) server.Restart();
  script.CheckAll();
  std::printf(
      "%d kills in %d rounds, %.1f s\n", server.kills(), rounds,
      std::chrono::duration<double>(steady_clock::now() - begin).count());
  server.Report();

  // The same requests to a server that nobody kills.
  KilledServer calm(folder / "calm");
  if (HasFailure()) return;
  Script undisturbed(&calm);
  undisturbed.Prepare();
  for (int round = 1; round <= rounds && !HasFailure(); ++round) {
    undisturbed.Round(round);
  }
  undisturbed.CheckAll();
  EXPECT_EQ(script.log().versions, undisturbed.log().versions);
  EXPECT_EQ(script.log().operations, undisturbed.log().operations);
  EXPECT_TRUE(script.log().bundles == undisturbed.log().bundles);
  EXPECT_EQ(script.log().changes, undisturbed.log().changes);
  std::printf(
      "%.1f s with the undisturbed run\n",
      std::chrono::duration<double>(steady_clock::now() - begin).count());
}

}  // namespace
}  // namespace tactus::internal
