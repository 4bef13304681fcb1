#include "server/jobs/slurm_job.h"

#include <algorithm>
#include <optional>
#include <thread>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "core/base/errors.h"
#include "core/base/sha256.h"
#include "core/base/status_macros.h"
#include "core/store/file_system.h"
#include "server/trainer/exit_status.h"

namespace tactus::internal::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kCommandPatience(20'000);
constexpr milliseconds kCancelPatience(60'000);
constexpr milliseconds kSlurmPoll(100);
constexpr int64_t kEventReadBytes = 64 * 1024;
constexpr int64_t kSlurmMib = 1024L * 1024;
constexpr size_t kNameDigits = 16;

// As the shell takes it for one word.
std::string Quoted(const std::string& word) {
  return absl::StrCat("'", absl::StrReplaceAll(word, {{"'", "'\\''"}}), "'");
}

// exec, so that Slurm's signals reach the trainer.
std::string ScriptOf(const SlurmJob::Options& options,
                     const std::string& folder) {
  const std::string launcher =
      options.ranks > 1
          ? absl::StrCat("mpirun -n ", options.ranks, " --bind-to none ")
          : "";
  return absl::StrCat(
      "#!/bin/sh\nexec ", launcher, Quoted(options.process.program), " ",
      Quoted(folder), " ", options.process.start_threads, " ",
      options.process.threads, " >", Quoted(folder + "/events."),
      "\"${SLURM_RESTART_COUNT:-0}\" 2>>", Quoted(folder + "/log"), "\n");
}

// The value of "Key=" in what scontrol prints.
absl::string_view ValueOf(absl::string_view key, absl::string_view text) {
  for (const absl::string_view word :
       absl::StrSplit(text, absl::ByAnyChar(" \n"))) {
    absl::string_view value = word;
    if (absl::ConsumePrefix(&value, key)) return value;
  }
  return {};
}

// How a job ended that has left no exit status, by what Slurm calls it.
std::string TextOf(absl::string_view state) {
  if (state == "TIMEOUT" || state == "DEADLINE") {
    return "reached the time limit of its Slurm job";
  }
  if (state == "NODE_FAIL" || state == "BOOT_FAIL") {
    return "lost its node in Slurm";
  }
  if (state == "CANCELLED") return "was cancelled in Slurm";
  if (state == "PREEMPTED") return "gave way to another job in Slurm";
  if (state == "OUT_OF_MEMORY") return "ran out of memory in Slurm";
  return absl::StrCat("ended in Slurm as ", state);
}

// What Slurm's programs say if they do not reach it.
bool IsSilence(absl::string_view output) {
  for (const char* const words :
       {"Unable to contact slurm controller", "Unable to establish controller",
        "backup controller in standby", "Socket timed out",
        "Connection refused", "Zero Bytes were transmitted"}) {
    if (absl::StrContains(output, words)) return true;
  }
  return false;
}

// What a program of Slurm printed; nothing if Slurm does not answer. IO with
// what it says if it refuses.
absl::StatusOr<std::optional<std::string>> Asked(
    const std::vector<std::string>& words) {
  TACTUS_ASSIGN_OR_RETURN(const CommandResult result,
                          RunCommand(words, kCommandPatience));
  if (result.late || (result.status != 0 && IsSilence(result.output))) {
    return std::optional<std::string>();
  }
  if (result.status != 0) {
    return IoError(words[0], absl::StripAsciiWhitespace(result.output));
  }
  return std::optional<std::string>(result.output);
}

// Slurm's name of the jobs of a folder: it finds those of which no server has
// heard the number.
std::string NameOf(const std::string& folder) {
  return absl::StrCat("tactus-", Sha256Hex(folder).substr(0, kNameDigits));
}

absl::StatusOr<SlurmState> StateOf(const std::string& number) {
  const auto shown = RunCommand(
      {"scontrol", "--oneliner", "show", "job", number}, kCommandPatience);
  TACTUS_RETURN_IF_ERROR(shown.status());
  if (shown->status == 0) return ParseSlurmState(shown->output);
  // Slurm forgets a job some minutes after its end.
  if (absl::StrContains(shown->output, "Invalid job id")) {
    return SlurmState{.ended = true,
                      .end = {.text = "is not known to Slurm any more"}};
  }
  return IoError("scontrol", absl::StripAsciiWhitespace(shown->output));
}

// A new try must not read the events of an earlier one.
absl::Status RemoveEvents(const std::string& folder) {
  FileSystem& files = PosixFileSystem();
  TACTUS_ASSIGN_OR_RETURN(const auto names, files.List(folder));
  for (const std::string& name : names) {
    if (!absl::StartsWith(name, "events.")) continue;
    TACTUS_RETURN_IF_ERROR(files.Remove(absl::StrCat(folder, "/", name)));
  }
  return absl::OkStatus();
}

}  // namespace

SlurmState ParseSlurmState(absl::string_view text) {
  const absl::string_view state = ValueOf("JobState=", text);
  if (state == "PENDING") return {.waits = true};
  for (const char* const running :
       {"CONFIGURING", "RUNNING", "COMPLETING", "SUSPENDED", "STOPPED",
        "RESIZING", "SIGNALING", "STAGE_OUT", "REQUEUED", "REQUEUE_FED",
        "REQUEUE_HOLD", "SPECIAL_EXIT", "RESV_DEL_HOLD"}) {
    if (state == running) return {};
  }
  SlurmState ended = {.ended = true};
  if (state == "COMPLETED") {
    ended.end = {.ok = true, .status = kExitDone, .text = "ended"};
    return ended;
  }
  if (state == "OUT_OF_MEMORY") ended.end.status = kExitOutOfMemory;
  ended.end.text = TextOf(state);
  // "3:0" is exit status 3, "0:9" signal 9.
  const std::vector<absl::string_view> code =
      absl::StrSplit(ValueOf("ExitCode=", text), ':');
  int status = 0;
  if (state == "FAILED" && absl::SimpleAtoi(code[0], &status) && status != 0) {
    ended.end.status = status;
    ended.end.text = absl::StrCat("exited with status ", status);
  }
  return ended;
}

absl::StatusOr<std::unique_ptr<SlurmJob>> SlurmJob::Start(
    const Options& options, const std::string& folder) {
  std::unique_ptr<SlurmJob> job(new SlurmJob(options, folder));
  TACTUS_RETURN_IF_ERROR(job->Submit());
  return job;
}

absl::StatusOr<bool> SlurmJob::EndEarlier() const {
  TACTUS_ASSIGN_OR_RETURN(const auto listed,
                          Asked({"squeue", "--me", "--noheader", "--format=%A",
                                 absl::StrCat("--name=", NameOf(folder_))}));
  if (!listed) return false;
  const std::vector<std::string> numbers =
      absl::StrSplit(*listed, absl::ByAnyChar(" \n"), absl::SkipEmpty());
  if (numbers.empty()) return true;
  std::vector<std::string> words = {"scancel"};
  words.insert(words.end(), numbers.begin(), numbers.end());
  TACTUS_RETURN_IF_ERROR(Asked(words).status());
  return false;
}

absl::Status SlurmJob::Submit() {
  tried_ = steady_clock::now();
  TACTUS_ASSIGN_OR_RETURN(const bool alone, EndEarlier());
  if (!alone) return absl::OkStatus();
  TACTUS_RETURN_IF_ERROR(RemoveEvents(folder_));
  const std::string script = folder_ + "/batch.sh";
  TACTUS_RETURN_IF_ERROR(
      WriteAtomically(PosixFileSystem(), script, ScriptOf(options_, folder_)));
  std::vector<std::string> words = {
      "sbatch",
      "--parsable",
      "--requeue",
      absl::StrCat("--job-name=", NameOf(folder_)),
      absl::StrCat("--chdir=", folder_),
      absl::StrCat("--output=", folder_, "/log"),
      "--open-mode=append",
      absl::StrCat("--ntasks=", options_.ranks),
      absl::StrCat("--cpus-per-task=", std::max(options_.process.start_threads,
                                                options_.process.threads))};
  if (options_.process.memory_bytes > 0) {
    const int64_t mib = options_.process.memory_bytes / kSlurmMib;
    words.push_back(absl::StrCat("--mem=", mib * options_.ranks, "M"));
  }
  words.insert(words.end(), options_.sbatch.begin(), options_.sbatch.end());
  words.push_back(script);
  TACTUS_ASSIGN_OR_RETURN(const auto printed, Asked(words));
  // It may have the job all the same; the next try ends that.
  if (!printed) return absl::OkStatus();
  // "42", or "42;cluster" of several clusters.
  const std::string number(absl::StripAsciiWhitespace(
      printed->substr(0, printed->find_first_of(";\n"))));
  int64_t value = 0;
  if (!absl::SimpleAtoi(number, &value)) {
    return IoError("sbatch",
                   absl::StrCat("printed no number of a job: ",
                                absl::StripAsciiWhitespace(*printed)));
  }
  number_ = number;
  return absl::OkStatus();
}

void SlurmJob::EndUnsubmitted(const std::string& text) {
  state_.ended = true;
  state_.end = {.text = text};
}

void SlurmJob::Ask() {
  const auto now = steady_clock::now();
  if (state_.ended || now - tried_ < options_.interval) return;
  if (number_.empty()) {
    const absl::Status submitted = Submit();
    if (!submitted.ok()) {
      EndUnsubmitted(
          absl::StrCat("was not taken by Slurm: ", submitted.message()));
    }
    return;
  }
  tried_ = now;
  const auto state = StateOf(number_);
  if (state.ok()) state_ = *state;
}

bool SlurmJob::Read() {
  // What is there before is of an earlier submission.
  if (number_.empty()) return false;
  FileSystem& files = PosixFileSystem();
  const auto path = [&](int start) {
    return absl::StrCat(folder_, "/events.", start);
  };
  const auto size = files.Size(path(starts_));
  if (size.ok() && *size > at_) {
    const auto bytes =
        files.Read(path(starts_), at_, std::min(*size - at_, kEventReadBytes));
    if (!bytes.ok()) return false;
    bytes_.Append(*bytes);
    at_ += static_cast<int64_t>(bytes->size());
    return true;
  }
  const auto next = files.Size(path(starts_ + 1));
  if (!next.ok() || *next < 0) return false;
  // The script was started again; what it was writing then has no end.
  ++starts_;
  at_ = 0;
  bytes_.Clear();
  return true;
}

JobRun::News SlurmJob::Next(milliseconds timeout, v1::JobEvent* event) {
  const auto deadline = steady_clock::now() + timeout;
  while (true) {
    switch (bytes_.Take(event)) {
      case EventBytes::Found::kEvent:
        return News::kEvent;
      case EventBytes::Found::kGarbage:
        Terminate(true);
        return News::kClosed;
      case EventBytes::Found::kNone:
        break;
    }
    // What is there when it has ended is all.
    const bool ended = state_.ended;
    if (Read()) continue;
    if (ended) return News::kClosed;
    Ask();
    if (state_.ended) continue;
    if (steady_clock::now() >= deadline) return News::kNone;
    std::this_thread::sleep_for(std::min(timeout, kSlurmPoll));
  }
}

void SlurmJob::Terminate(bool kill) {
  const auto now = steady_clock::now();
  if (now - terminated_ < options_.interval && kill == killed_) return;
  terminated_ = now;
  killed_ = kill;
  if (number_.empty()) return EndUnsubmitted("had not begun in Slurm");
  // It may have begun since.
  if (const auto state = StateOf(number_); state.ok()) state_ = *state;
  // A job that waits has no process that could hear. What fails here is seen by
  // Wait.
  if (!kill && !state_.waits) {
    Asked({"scancel", "--batch", "--signal=TERM", number_}).IgnoreError();
  } else {
    Asked({"scancel", number_}).IgnoreError();
  }
}

JobRun::End SlurmJob::Wait(milliseconds patience) {
  const auto begin = steady_clock::now();
  while (true) {
    Ask();
    if (state_.ended) return state_.end;
    const auto waited = steady_clock::now() - begin;
    if (waited >= patience) Terminate(true);
    if (waited >= patience + kCancelPatience) {
      return {.text = "does not end in Slurm"};
    }
    std::this_thread::sleep_for(kSlurmPoll);
  }
}

}  // namespace tactus::internal::server
