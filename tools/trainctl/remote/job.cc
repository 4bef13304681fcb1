#include "tools/trainctl/remote/job.h"

#include <algorithm>
#include <iostream>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/strip.h"
#include "client/stream/status.h"
#include "client/training/operation_watcher.h"
#include "client/training/retry.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/contacts/trained_on.h"
#include "core/eval/choice_proto.h"
#include "tools/trainctl/exit_code.h"
#include "tools/trainctl/fit/choice_text.h"
#include "tools/trainctl/interrupt.h"
#include "tools/trainctl/remote/job_display.h"
#include "tools/trainctl/remote/proto_json.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {
namespace {

std::string Subject(const v1::Operation& job) {
  switch (job.request_case()) {
    case v1::Operation::kTrain:
      return absl::StrCat(job.train().model(), " on ",
                          job.train().dataset_version());
    case v1::Operation::kEvaluate:
      return absl::StrCat(job.evaluate().model_version().empty()
                              ? job.evaluate().protocol()
                              : job.evaluate().model_version(),
                          " on ", job.evaluate().dataset_version());
    case v1::Operation::kPromote:
      return absl::StrCat(job.promote().model_version(), " as ",
                          job.promote().alias());
    default:
      return "";
  }
}

std::string AccuracyText(const v1::Accuracy& accuracy) {
  const double contacts = accuracy.contacts() > 0 ? accuracy.contacts() : 1;
  return absl::StrFormat("%s (95 %% interval %.2f to %.2f %%) of %s contacts",
                         Percent(accuracy.correct() / contacts),
                         100 * accuracy.low(), 100 * accuracy.high(),
                         WithCommas(static_cast<int>(accuracy.contacts())));
}

// A line if the model was trained on what it is tested on, or may have been.
std::string TrainedOnLine(const v1::Operation& job,
                          const v1::EvaluationReport& report) {
  if (job.kind() == v1::Operation::KIND_EVALUATE &&
      job.evaluate().model_version().empty()) {
    return "";
  }
  const std::string text = TrainedOnText(
      {.basis = static_cast<TrainingBasis>(report.training_basis()),
       .contacts = static_cast<int>(report.trained_on_contacts()),
       .tested = static_cast<int>(report.accuracy().contacts())});
  return text.empty() ? "" : text + "\n";
}

std::string DuplicatesText(const v1::OperationResult& result) {
  if (result.duplicates() == 0) return "";
  std::string text =
      absl::StrFormat("%s of the trials have frames that an earlier one has\n",
                      WithCommas(static_cast<int>(result.duplicates())));
  for (const v1::DuplicateTrial& trial : result.duplicate_trials()) {
    absl::StrAppend(&text, "  ", Printable(trial.name()), " (",
                    Printable(trial.label()), ") has the frames of ",
                    Printable(trial.first_name()), " (",
                    Printable(trial.first_label()), ")\n");
  }
  return text;
}

std::string WrongText(const v1::EvaluationReport& report) {
  std::string text;
  for (const v1::WrongAnswer& wrong : report.wrong()) {
    absl::StrAppend(&text, text.empty() ? "wrong: " : ", ",
                    Printable(wrong.name()), " (", Printable(wrong.label()),
                    " taken for ", Printable(wrong.answer()), ")");
  }
  const int count = static_cast<int>(report.accuracy().contacts()) -
                    static_cast<int>(report.accuracy().correct());
  if (count > report.wrong_size()) text += ", ...";
  return report.wrong().empty() ? "" : text + "\n";
}

std::string ReportText(const char* title, const v1::EvaluationReport& report) {
  return absl::StrFormat(
      "%s: accuracy %s, log-loss %.4f, calibration error %.4f, %s trials never "
      "felt\n",
      title, AccuracyText(report.accuracy()), report.log_loss(),
      report.calibration_error(),
      WithCommas(static_cast<int>(report.never_felt())));
}

std::string ConfusionText(const v1::EvaluationReport& report) {
  const int classes = report.class_names_size();
  if (report.confusion_size() != classes * classes) return "";
  std::string text = "true class by predicted class:\n";
  absl::StrAppendFormat(&text, "%10s", "");
  for (const std::string& name : report.class_names()) {
    absl::StrAppendFormat(&text, " %8s", name);
  }
  text += "\n";
  for (int row = 0; row < classes; ++row) {
    absl::StrAppendFormat(&text, "%10s", report.class_names(row));
    for (int column = 0; column < classes; ++column) {
      absl::StrAppendFormat(&text, " %8d",
                            report.confusion(row * classes + column));
    }
    text += "\n";
  }
  return text;
}

std::string ComparisonText(const v1::Operation& job,
                           const v1::Comparison& comparison) {
  const bool same =
      comparison.only_current() == 0 && comparison.only_candidate() == 0;
  return absl::StrCat(
      TrainedOnLine(job, comparison.current()),
      ReportText("current", comparison.current()),
      TrainedOnLine(job, comparison.candidate()),
      ReportText("candidate", comparison.candidate()),
      same
          ? "both versions are right on the same contacts (McNemar p = 1)\n"
          : absl::StrFormat(
                "only the current version is right on %d contacts, only the "
                "candidate on %d (McNemar p = %.4g; the candidate wins %.2f to "
                "%.2f %% of them, 95 %% interval)\n",
                comparison.only_current(), comparison.only_candidate(),
                comparison.mcnemar_p(), 100 * comparison.win_low(),
                100 * comparison.win_high()),
      comparison.passed()
          ? "gate passed\n"
          : absl::StrCat("gate not passed: ", comparison.failure(), "\n"));
}

std::optional<PresetChoice> ChoiceOf(const v1::OperationResult& result) {
  if (!result.has_preset_choice()) return std::nullopt;
  return FromProto(result.preset_choice());
}

// How to see the job again.
std::string WatchCommand(const v1::Operation& job, const RemoteFlags& flags) {
  return absl::StrCat("trainctl jobs watch ",
                      absl::StripPrefix(job.name(), "operations/"),
                      " --server=", flags.server);
}

}  // namespace

std::string JobLine(const v1::Operation& job) {
  const auto text = [](const google::protobuf::EnumDescriptor& type,
                       int number) {
    const auto* value = type.FindValueByNumber(number);
    return value == nullptr ? absl::StrCat(number) : EnumText(*value);
  };
  std::string line =
      absl::StrFormat("%s  %-8s  %-10s  %s  %s", job.name(),
                      text(*v1::Operation::Kind_descriptor(), job.kind()),
                      text(*v1::Operation::State_descriptor(), job.state()),
                      TimeText(job.create_time_ms()), Subject(job));
  if (job.state() == v1::Operation::STATE_RUNNING) {
    absl::StrAppendFormat(&line, "  %.0f %% %s",
                          100 * job.progress().fraction(),
                          job.progress().phase());
  }
  if (job.has_error()) absl::StrAppend(&line, "  ", job.error().message());
  return line + "\n";
}

std::string ResultText(const v1::Operation& job) {
  const v1::OperationResult& result = job.result();
  std::string text = ChoiceText(ChoiceOf(result));
  if (!result.model_version().empty()) {
    absl::StrAppendFormat(
        &text, "%s, in %s\n", result.model_version(),
        ClockText(1e-3 * static_cast<double>(job.progress().elapsed_ms())));
  }
  const int named = result.unusable_trials_size();
  const int unusable = std::max(static_cast<int>(result.unusable()), named);
  if (unusable > 0) {
    absl::StrAppendFormat(&text, "%s unusable trials were left out: %s%s\n",
                          WithCommas(unusable),
                          absl::StrJoin(result.unusable_trials(), ", "),
                          unusable > named ? ", ..." : "");
  }
  if (result.has_comparison()) text += ComparisonText(job, result.comparison());
  if (result.lagging_replicas_size() > 0) {
    absl::StrAppend(&text, "does not serve it yet: ",
                    absl::StrJoin(result.lagging_replicas(), ", "), "\n");
  }
  if (result.has_evaluation() && !result.has_comparison()) {
    text += ReportText("evaluation", result.evaluation());
    text += ConfusionText(result.evaluation());
    text += WrongText(result.evaluation());
  }
  text += DuplicatesText(result);
  if (job.kind() == v1::Operation::KIND_PROMOTE &&
      job.state() == v1::Operation::STATE_SUCCEEDED) {
    absl::StrAppend(&text, job.promote().alias(), " is now ",
                    job.promote().model_version(), "\n");
  }
  return text;
}

void PrintJob(const v1::Operation& job, const RemoteFlags& flags) {
  if (flags.json) {
    Json json = ToJson(job);
    // As `evaluate` of a file says it.
    if (job.result().has_evaluation()) {
      const v1::EvaluationReport& report = job.result().evaluation();
      json["trained_on_data"] = report.has_trained_on_data()
                                    ? Json(report.trained_on_data())
                                    : Json(nullptr);
    }
    PrintJson(json);
  } else {
    if (job.result().has_evaluation()) {
      std::cout << TrainedOnLine(job, job.result().evaluation());
    }
    std::cout << JobLine(job) << ResultText(job);
  }
  std::cout.flush();
}

absl::Status StatusOfJob(const v1::Operation& job) {
  switch (job.state()) {
    case v1::Operation::STATE_SUCCEEDED: {
      const auto& result = job.result();
      if (!result.has_comparison() || result.comparison().passed() ||
          job.promote().force()) {
        return absl::OkStatus();
      }
      return WithExitCode(GateNotPassed(result.comparison().failure()),
                          kExitGateNotPassed);
    }
    case v1::Operation::STATE_CANCELLED:
      return WithExitCode(WorkCancelled(job.name()), kExitJobCancelled);
    default:
      break;
  }
  absl::Status status = FromStatusProto(job.error());
  if (status.ok()) status = absl::UnknownError("the server gave no reason");
  const bool gate = ReasonOf(status) == "GATE_NOT_PASSED";
  return WithExitCode(Annotate(status, absl::StrCat(job.name(), " failed")),
                      gate ? kExitGateNotPassed : kExitJobFailed);
}

absl::Status FollowJob(TrainingClient& client, const RemoteFlags& flags,
                       const v1::Operation& job) {
  JobDisplay display;
  OperationWatcher watcher(&client, {});
  bool interrupted = false;
  auto ended = [&] {
    const Interrupt interrupt([&] {
      interrupted = true;
      watcher.Cancel();
    });
    return watcher.Watch(job.name(),
                         [&](const v1::Operation& now, auto points) {
                           display.Update(now, points);
                         });
  }();
  display.Clear();
  if (ended.ok()) {
    PrintJob(*ended, flags);
    return StatusOfJob(*ended);
  }
  const std::string again = absl::StrCat("The job goes on; watch it with: ",
                                         WatchCommand(job, flags));
  if (interrupted) {
    return WithExitCode(absl::CancelledError(again), kExitInterrupted);
  }
  // This command has started the job.
  if (MayRetry(ended.status()) &&
      job.kind() != v1::Operation::KIND_UNSPECIFIED) {
    std::cerr << "trainctl: " << again << "\n";
  }
  return ended.status();
}

}  // namespace tactus::internal::client
