#include "server/jobs/job_queue.h"

#include <sys/stat.h>

#include <filesystem>
#include <functional>
#include <thread>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_proto.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "spdlog/spdlog.h"
#include "tests/server/records/stores.h"

namespace tactus::internal::server {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;
using v1::Operation;

// The trainer is a shell script: $1 is the job's folder, $HERE the test's.
class JobQueueTest : public ::testing::Test {
 protected:
  JobQueueTest() {
    EXPECT_TRUE(stores_->datasets->Create(kDataset, "", kCaller).ok());
    EXPECT_TRUE(stores_->Upload(Pack(0, 2)).ok());
    WriteBytes(folder_ / "bundle", TestBundle(1));
    v1::JobOutcome outcome;
    outcome.mutable_result();
    WriteBytes(folder_ / "result", outcome.SerializeAsString());
    *outcome.mutable_error() = ToStatusProto(WorkCancelled("the training"));
    WriteBytes(folder_ / "cancelled", outcome.SerializeAsString());
  }
  ~JobQueueTest() override { queue_.reset(); }

  static constexpr char kSucceed[] =
      "cp $HERE/bundle $1/bundle.tactus; cp $HERE/result $1/result.pb\n";
  // Counts the attempts in $N.
  static constexpr char kCount[] =
      "echo >> $HERE/count; N=$(wc -l < $HERE/count)\n";
  // Until the test makes the file.
  static constexpr char kAwaitGo[] =
      "touch $HERE/begun; while [ ! -e $HERE/go ]; do sleep 0.02; done\n";

  void Start(const std::string& script, int64_t memory_bytes = 0) {
    const std::string program = folder_ / "trainer";
    WriteBytes(program, "#!/bin/bash\nHERE=" + folder_.path() + "\n" + script);
    chmod(program.c_str(), 0755);
    JobQueue::Options options;
    options.process = {.program = program, .memory_bytes = memory_bytes};
    options.host = "here";
    queue_ = std::make_unique<JobQueue>(
        stores_->data.get(), stores_->datasets.get(), stores_->models.get(),
        stores_->operations.get(), options, [] { return int64_t{5'000}; });
    queue_->Start();
  }
  void Reopen() {
    queue_.reset();
    stores_.reset();
    stores_ = std::make_unique<Stores>(&files_, folder_ / "data", vfs_.name());
  }
  std::string Request() {
    Operation request;
    request.set_kind(Operation::KIND_TRAIN);
    request.mutable_train()->set_dataset_version("datasets/d/versions/1");
    request.mutable_train()->set_model("models/m");
    const auto operation = stores_->operations->Create(request, "", kCaller);
    EXPECT_TRUE(operation.ok()) << operation.status();
    if (queue_ != nullptr) queue_->Wake();
    return operation->name();
  }
  // The operation when it has ended, or after two minutes.
  Operation End(const std::string& name) {
    OperationStore::Cursor cursor;
    const auto give_up =
        std::chrono::steady_clock::now() + std::chrono::minutes(2);
    while (true) {
      const auto update = stores_->operations->WaitForChange(
          name, &cursor, milliseconds(1'000));
      EXPECT_TRUE(update.ok()) << update.status();
      if (HasEnded(update->operation) ||
          std::chrono::steady_clock::now() > give_up) {
        return update->operation;
      }
    }
  }
  Operation Run(const std::string& script, int64_t memory_bytes = 0) {
    Start(script, memory_bytes);
    return End(Request());
  }
  void AwaitFile(const std::string& name) {
    while (!std::filesystem::exists(folder_ / name)) {
      std::this_thread::sleep_for(milliseconds(5));
    }
  }
  void Go() { WriteBytes(folder_ / "go", ""); }
  static std::string Reason(const Operation& operation) {
    return ReasonOf(FromStatusProto(operation.error()));
  }

  // Two versions; the gated alias "a" names the first. Returns the request to
  // let it name the second.
  Operation Promotion() {
    for (const int seed : {1, 2}) {
      EXPECT_TRUE(
          stores_->models->AddVersion("models/m", TestBundle(seed), {}, kCaller)
              .ok());
    }
    Operation request;
    request.set_kind(Operation::KIND_PROMOTE);
    v1::PromoteSpec& spec = *request.mutable_promote();
    spec.set_alias("aliases/a");
    spec.set_model_version("models/m/versions/1");
    EXPECT_TRUE(stores_->models->Promote(spec, false, kCaller).ok());
    v1::UpdateAliasRequest gate;
    gate.set_name("aliases/a");
    gate.mutable_gate()->set_dataset_version("datasets/d/versions/1");
    EXPECT_TRUE(stores_->models->UpdateAlias(gate, kCaller).ok());
    spec.set_model_version("models/m/versions/2");
    return request;
  }
  void WriteComparison(bool passed) {
    v1::JobOutcome outcome;
    outcome.mutable_result()->mutable_comparison()->set_passed(passed);
    outcome.mutable_result()->mutable_comparison()->set_failure("worse");
    WriteBytes(folder_ / "result", outcome.SerializeAsString());
  }

  // Lets the server's machine crash at each operation on the disk that a queued
  // job needs. Afterwards the job ends as if nothing had happened; `check` sees
  // its end.
  void CrashEverywhere(const std::string& name, const std::string& script,
                       const std::function<void(const Operation&)>& check) {
    namespace fs = std::filesystem;
    using testing::CrashFileSystem;
    spdlog::set_level(spdlog::level::off);
    stores_.reset();
    fs::rename(folder_ / "data", folder_ / "base");
    int points = 0;
    for (const CrashFileSystem::Loss loss : CrashFileSystem::kLosses) {
      bool reached = true;
      for (int k = 1; reached && !HasFailure(); ++k) {
        SCOPED_TRACE("loss " + std::to_string(static_cast<int>(loss)) +
                     ", operation " + std::to_string(k));
        fs::copy(folder_ / "base", folder_ / "data",
                 fs::copy_options::recursive);
        Reopen();
        files_.Lose(CrashFileSystem::Loss::kNothing);
        files_.StopAt(k);
        Start(script);
        bool ended = false;
        while (!files_.failed() && !ended) {
          ended = HasEnded(*stores_->operations->Get(name));
          std::this_thread::sleep_for(milliseconds(1));
        }
        queue_.reset();
        ended = HasEnded(*stores_->operations->Get(name));
        reached = files_.failed();
        stores_.reset();
        files_.Lose(loss);
        files_.Heal();
        Reopen();
        if (ended) {
          EXPECT_TRUE(HasEnded(*stores_->operations->Get(name)));
        }
        Start(script);
        const Operation job = End(name);
        EXPECT_EQ(job.state(), Operation::STATE_SUCCEEDED)
            << job.error().message();
        check(job);
        queue_.reset();
        EXPECT_TRUE(files_.List(stores_->data->JobFolder())->empty());
        stores_.reset();
        fs::remove_all(folder_ / "data");
        ++points;
      }
    }
    spdlog::set_level(spdlog::level::info);
    RecordProperty("points", points);
    std::printf("%d crash points\n", points);
    EXPECT_GE(points, 60);
  }

  ScratchDir folder_;
  testing::CrashFileSystem files_;
  testing::CrashVfs vfs_{&files_};
  std::unique_ptr<Stores> stores_ =
      std::make_unique<Stores>(&files_, folder_ / "data", vfs_.name());
  std::unique_ptr<JobQueue> queue_;
};

TEST_F(JobQueueTest, PublishesWhatTheProcessMade) {
  v1::JobEvent point;
  point.mutable_point()->set_iteration(3);
  v1::JobEvent progress;
  progress.mutable_progress()->set_phase("train");
  progress.mutable_progress()->set_fraction(0.5);
  WriteBytes(folder_ / "events", Packed(progress.SerializeAsString()) +
                                     Packed(point.SerializeAsString()));
  const Operation job =
      Run(std::string("cat $HERE/events; echo hello >&2\n") + kSucceed);
  ASSERT_EQ(job.state(), Operation::STATE_SUCCEEDED) << job.error().message();
  EXPECT_EQ(job.attempts(), 1u);
  EXPECT_EQ(job.progress().phase(), "train");
  const auto points = stores_->operations->Points(job.name());
  ASSERT_EQ(points->size(), 1u);
  EXPECT_EQ(points->front().iteration(), 3u);
  const auto version = stores_->models->Get(job.result().model_version());
  ASSERT_TRUE(version.ok()) << version.status();
  EXPECT_EQ(version->name(), "models/m/versions/1");
  EXPECT_EQ(version->operation(), job.name());
  EXPECT_EQ(version->train().dataset_version(), "datasets/d/versions/1");
  EXPECT_EQ(version->dataset_sha256(),
            stores_->datasets->Version(kDataset)->sha256());
  EXPECT_EQ(version->host(), "here");
  queue_.reset();
  EXPECT_TRUE(files_.List(stores_->data->JobFolder())->empty());
}

TEST_F(JobQueueTest, ThePriorityIsTheLowest) {
  const Operation job = Run(std::string("nice > $HERE/nice\n") + kSucceed);
  EXPECT_EQ(job.state(), Operation::STATE_SUCCEEDED) << job.error().message();
  EXPECT_EQ(ReadBytes(folder_ / "nice"), "19\n");
}

TEST_F(JobQueueTest, GoesOnAfterACrash) {
  const Operation job = Run(std::string(kCount) +
                            "if [ $N = 1 ]; then exit 3; fi\n"
                            "if [ $N = 2 ]; then kill -9 $$; fi\n" +
                            kSucceed);
  EXPECT_EQ(job.state(), Operation::STATE_SUCCEEDED) << job.error().message();
  EXPECT_EQ(job.attempts(), 3u);
}

TEST_F(JobQueueTest, FailsAfterTheLastAttempt) {
  const Operation job = Run(std::string(kCount) + "kill -SEGV $$\n");
  EXPECT_EQ(job.state(), Operation::STATE_FAILED);
  EXPECT_EQ(Reason(job), "JOB_CRASHED");
  EXPECT_THAT(job.error().message(), HasSubstr("SIGSEGV"));
  EXPECT_EQ(job.attempts(), 3u);
  EXPECT_EQ(ReadBytes(folder_ / "count"), "\n\n\n");
}

TEST_F(JobQueueTest, CancelsQueuedAndRunningJobs) {
  Start(std::string("trap 'cp $HERE/cancelled $1/result.pb; exit 0' TERM\n") +
        kAwaitGo);
  const std::string running = Request();
  AwaitFile("begun");
  const std::string queued = Request();
  EXPECT_EQ(queue_->Cancel(queued)->state(), Operation::STATE_CANCELLED);
  EXPECT_EQ(queue_->Cancel(running)->state(), Operation::STATE_CANCELLING);
  const Operation job = End(running);
  EXPECT_EQ(job.state(), Operation::STATE_CANCELLED);
  EXPECT_EQ(Reason(job), "CANCELLED");
  EXPECT_EQ(job.attempts(), 1u);
  // A job that has ended stays as it is.
  EXPECT_EQ(queue_->Cancel(running)->state(), Operation::STATE_CANCELLED);
  EXPECT_EQ(ReasonOf(queue_->Cancel("operations/9").status()),
            "OPERATION_NOT_FOUND");
}

TEST_F(JobQueueTest, KillsAProcessThatDoesNotEnd) {
  Start(std::string("trap '' TERM\n") + kAwaitGo);
  const std::string name = Request();
  AwaitFile("begun");
  ASSERT_TRUE(queue_->Cancel(name).ok());
  EXPECT_EQ(End(name).state(), Operation::STATE_CANCELLED);
}

// A service manager that stops the server asks its jobs to end too.
TEST_F(JobQueueTest, AnInterruptionIsNoCancellation) {
  const Operation job =
      Run(std::string(kCount) +
          "if [ $N = 1 ]; then cp $HERE/cancelled $1/result.pb; exit 0; fi\n" +
          kSucceed);
  EXPECT_EQ(job.state(), Operation::STATE_SUCCEEDED) << job.error().message();
  EXPECT_EQ(job.attempts(), 2u);
}

TEST_F(JobQueueTest, ResultsThatCannotBeUsed) {
  const std::pair<const char*, const char*> cases[] = {
      {"printf garbage > $1/result.pb", "DATA_LOST"},
      {"true", "DATA_LOST"},
      {"cp $HERE/result $1/result.pb", "DATA_LOST"},
      {"cp $HERE/result $1/result.pb; echo x > $1/bundle.tactus",
       "BUNDLE_CORRUPT"}};
  for (const auto& [script, reason] : cases) {
    const Operation job = Run(script);
    EXPECT_EQ(job.state(), Operation::STATE_FAILED) << script;
    EXPECT_EQ(Reason(job), reason) << script;
  }
  EXPECT_EQ(ReasonOf(stores_->models->Get("models/m").status()),
            "MODEL_NOT_FOUND");
}

TEST_F(JobQueueTest, AProcessThatWritesGarbageIsKilled) {
  for (const char* garbage :
       {"'\\377\\377\\377\\377'", "'\\003\\000\\000\\000\\377\\377\\377'"}) {
    const Operation job =
        Run(std::string("printf ") + garbage + "\nsleep 1000\n");
    EXPECT_EQ(job.state(), Operation::STATE_FAILED);
    EXPECT_EQ(Reason(job), "JOB_CRASHED");
  }
}

TEST_F(JobQueueTest, AProcessThatClosesItsOutputIsKilled) {
  const Operation job =
      Run(std::string(kCount) + "exec 1>&-\n[ $N = 1 ] && exec sleep 1000\n" +
          kSucceed);
  EXPECT_EQ(job.state(), Operation::STATE_SUCCEEDED) << job.error().message();
  EXPECT_EQ(job.attempts(), 2u);
}

TEST_F(JobQueueTest, MemoryIsLimited) {
  const std::string script =
      std::string(
          "head -c 200000000 /dev/zero | tail -c 190000000 | wc -c >&2"
          "\n[ ${PIPESTATUS[1]} = 0 ] || exit 1\n") +
      kSucceed;
  const Operation job = Run(script, 64L << 20);
  EXPECT_EQ(job.state(), Operation::STATE_FAILED);
  EXPECT_EQ(Reason(job), "JOB_CRASHED");
  EXPECT_EQ(Run(script).state(), Operation::STATE_SUCCEEDED);
}

TEST_F(JobQueueTest, AProgramThatIsNotThere) {
  Start("");
  std::filesystem::remove(folder_ / "trainer");
  const Operation job = End(Request());
  EXPECT_EQ(job.state(), Operation::STATE_FAILED);
  EXPECT_EQ(Reason(job), "IO");
}

TEST_F(JobQueueTest, GoesOnAfterTheServerEnded) {
  Start(kAwaitGo);
  const std::string name = Request();
  for (int i = 0; i < 4; ++i) {
    AwaitFile("begun");
    Reopen();
    EXPECT_EQ(stores_->operations->Get(name)->state(), Operation::STATE_QUEUED);
    std::filesystem::remove(folder_ / "begun");
    // More restarts than attempts; then a crash, which is the first one.
    Start(i < 3 ? kAwaitGo
                : std::string(kCount) + "[ $N = 1 ] && exit 3\n" + kSucceed);
  }
  const Operation job = End(name);
  EXPECT_EQ(job.state(), Operation::STATE_SUCCEEDED) << job.error().message();
  EXPECT_EQ(job.attempts(), 6u);
}

TEST_F(JobQueueTest, FoldersOfEndedJobsAreRemoved) {
  const std::string name = Request();
  ASSERT_TRUE(stores_->operations
                  ->Change(name,
                           [](Operation& job) {
                             job.set_state(Operation::STATE_CANCELLED);
                             return absl::OkStatus();
                           })
                  .ok());
  ASSERT_TRUE(files_.MakeDirectory(stores_->data->JobPath("1")).ok());
  ASSERT_TRUE(files_.MakeDirectory(stores_->data->JobPath("other")).ok());
  Start("");
  EXPECT_THAT(*files_.List(stores_->data->JobFolder()),
              ::testing::ElementsAre("other"));
}

// A training, from its start to its end.
TEST_F(JobQueueTest, ATrainingSurvivesACrashAtEachOperation) {
  const std::string name = Request();
  CrashEverywhere(name, kSucceed, [&](const Operation& job) {
    EXPECT_EQ(job.result().model_version(), "models/m/versions/1");
    const auto page = stores_->models->List("models/m", 10, "");
    ASSERT_EQ(page->items.size(), 1u);
    const auto bundle = stores_->models->Bundle(page->items.front());
    ASSERT_TRUE(bundle.ok()) << bundle.status();
    EXPECT_EQ(*bundle, TestBundle(1));
  });
}

// A promotion that names the alias's etag moves it once.
TEST_F(JobQueueTest, APromotionSurvivesACrashAtEachOperation) {
  Operation request = Promotion();
  request.mutable_promote()->set_etag(
      stores_->models->GetAlias("aliases/a")->etag());
  const std::string name =
      stores_->operations->Create(request, "", kCaller)->name();
  WriteComparison(true);
  CrashEverywhere(
      name, "cp $HERE/result $1/result.pb\n", [&](const Operation&) {
        const auto alias = stores_->models->GetAlias("aliases/a");
        EXPECT_EQ(alias->model_version(), "models/m/versions/2");
        EXPECT_EQ(alias->previous_version(), "models/m/versions/1");
        EXPECT_EQ(stores_->models->History("aliases/a")->size(), 2u);
      });
}

// The disk fails when the job ends: it must not be RUNNING for ever.
TEST_F(JobQueueTest, AnEndIsStoredWhenTheDiskIsSoundAgain) {
  Start(std::string(kAwaitGo) + "exit 3\n");
  const std::string name = Request();
  AwaitFile("begun");
  files_.StopAt(1);
  Go();
  while (!files_.failed()) std::this_thread::sleep_for(milliseconds(5));
  EXPECT_EQ(stores_->operations->Get(name)->state(), Operation::STATE_RUNNING);
  files_.Heal();
  EXPECT_EQ(End(name).state(), Operation::STATE_FAILED);
}

TEST_F(JobQueueTest, TheGateDecidesOverTheAlias) {
  const Operation request = Promotion();
  for (const bool passes : {false, true}) {
    WriteComparison(passes);
    Start("cp $1/job.pb $HERE/job\ncp $HERE/result $1/result.pb\n");
    const auto created = stores_->operations->Create(request, "", kCaller);
    queue_->Wake();
    const Operation job = End(created->name());
    EXPECT_EQ(job.state(),
              passes ? Operation::STATE_SUCCEEDED : Operation::STATE_FAILED);
    EXPECT_EQ(Reason(job), passes ? "" : "GATE_NOT_PASSED");
    EXPECT_TRUE(job.result().has_comparison());
    // The job reads both bundles where they are.
    v1::JobSpec spec;
    ASSERT_TRUE(spec.ParseFromString(ReadBytes(folder_ / "job")));
    const auto sha256_of = [&](const char* version) {
      return stores_->models->Get(version)->blob_sha256();
    };
    EXPECT_EQ(spec.model(), sha256_of("models/m/versions/2"));
    EXPECT_EQ(spec.current_model(), sha256_of("models/m/versions/1"));
    EXPECT_NE(spec.model(), spec.current_model());
    EXPECT_EQ(stores_->models->GetAlias("aliases/a")->model_version(),
              passes ? "models/m/versions/2" : "models/m/versions/1");
  }
}

TEST_F(JobQueueTest, TheEndOfTheLogOutlivesTheJob) {
  Start("printf begin >&2\n" + std::string(kAwaitGo) +
        "head -c 70000 /dev/zero | tr '\\0' x >&2; printf end >&2\n" +
        kSucceed);
  const std::string name = Request();
  AwaitFile("begun");
  EXPECT_EQ(queue_->Log(name)->data(), "begin") << "while it runs";
  Go();
  ASSERT_EQ(End(name).state(), Operation::STATE_SUCCEEDED);
  for (int i = 0; i < 2; ++i) {
    const auto log = queue_->Log(name);
    ASSERT_TRUE(log.ok()) << log.status();
    EXPECT_EQ(log->data().size(), static_cast<size_t>(limits::kMaxJobLogBytes));
    EXPECT_EQ(log->data().substr(log->data().size() - 4), "xend");
    EXPECT_EQ(log->omitted_bytes(), 70'008 - limits::kMaxJobLogBytes);
    Reopen();
    Start(kSucceed);
  }
  EXPECT_EQ(ReasonOf(queue_->Log("operations/9").status()),
            "OPERATION_NOT_FOUND");
  // A job that has not begun has no log.
  queue_.reset();
  const std::string waiting = Request();
  Start(kAwaitGo);
  EXPECT_TRUE(queue_->Log(waiting)->data().empty());
}

TEST_F(JobQueueTest, AFailedJobHasItsLog) {
  const Operation failed = Run("echo \"no memory\" >&2; exit 3\n");
  ASSERT_EQ(failed.state(), Operation::STATE_FAILED);
  EXPECT_EQ(queue_->Log(failed.name())->data(),
            "no memory\nno memory\nno memory\n")
      << "of all attempts";
}

}  // namespace
}  // namespace tactus::internal::server
