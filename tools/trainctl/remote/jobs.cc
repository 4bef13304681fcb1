// trainctl jobs: training and evaluation jobs of a server.
#include <iostream>
#include <map>
#include <vector>

#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "client/training/admin_client.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "tools/trainctl/remote/flags.h"
#include "tools/trainctl/remote/job.h"
#include "tools/trainctl/remote/proto_json.h"

namespace tactus::internal::client {
namespace {

const std::map<std::string, v1::Operation::State>& States() {
  static const auto* const states = [] {
    auto* names = new std::map<std::string, v1::Operation::State>;
    const auto* type = v1::Operation::State_descriptor();
    for (int i = 0; i < type->value_count(); ++i) {
      const auto& value = *type->value(i);
      if (value.number() == v1::Operation::STATE_UNSPECIFIED) continue;
      (*names)[EnumText(value)] =
          static_cast<v1::Operation::State>(value.number());
    }
    return names;
  }();
  return *states;
}

absl::Status ListJobs(TrainingClient& client, v1::Operation::State state,
                      size_t limit, bool json) {
  TACTUS_ASSIGN_OR_RETURN(const auto jobs, client.ListOperations(state, limit));
  if (json) {
    PrintJson(ArrayToJson(jobs));
  } else {
    for (const v1::Operation& job : jobs) std::cout << JobLine(job);
  }
  return absl::OkStatus();
}

absl::Status ShowJob(TrainingClient& client, const RemoteFlags& flags,
                     const std::string& name) {
  TACTUS_ASSIGN_OR_RETURN(const v1::Operation job, client.GetOperation(name));
  PrintJob(job, flags);
  if (!flags.json && !job.request_id().empty()) {
    std::cout << "request id, as in the server's log: "
              << Printable(job.request_id()) << "\n";
  }
  return absl::OkStatus();
}

absl::Status Watch(TrainingClient& client, const RemoteFlags& flags,
                   const std::string& name) {
  v1::Operation job;
  job.set_name(name);
  return FollowJob(client, flags, job);
}

absl::Status Cancel(TrainingClient& client, const RemoteFlags& flags,
                    const std::string& name) {
  TACTUS_ASSIGN_OR_RETURN(const v1::Operation job,
                          client.CancelOperation(name));
  PrintJob(job, flags);
  return absl::OkStatus();
}

absl::Status Delete(TrainingClient& client, const RemoteFlags& flags,
                    const std::string& name) {
  TACTUS_RETURN_IF_ERROR(client.DeleteOperation(name));
  if (flags.json) {
    PrintJson({{"deleted", name}});
  } else {
    std::cout << name << " deleted\n";
  }
  return absl::OkStatus();
}

// The log with a question mark for what a terminal could take as a command.
std::string PrintableLines(const std::string& log) {
  std::vector<std::string> lines = absl::StrSplit(log, '\n');
  for (std::string& line : lines) line = Printable(line);
  return absl::StrJoin(lines, "\n");
}

absl::Status Logs(TrainingClient& client, const RemoteFlags& flags,
                  const std::string& name) {
  TACTUS_ASSIGN_OR_RETURN(const auto log,
                          AdminClient(&client).ReadOperationLog(name));
  if (flags.json) {
    Json json;
    json["operation"] = name;
    json["omitted_bytes"] = log.omitted_bytes;
    json["text"] = PrintableLines(log.text);
    PrintJson(json);
    return absl::OkStatus();
  }
  if (log.omitted_bytes > 0) {
    std::cerr << "trainctl: the first " << log.omitted_bytes
              << " bytes of the log are not kept\n";
  }
  std::cout << PrintableLines(log.text);
  return absl::OkStatus();
}

}  // namespace

void AddJobs(CLI::App& app, const SelectCommand& select) {
  CLI::App& group = CommandGroup(
      app, "jobs", "See, watch, cancel and delete jobs of a server", "watch 7");
  CLI::App* list = &AddVerb(group, "list", "List jobs, the newest first",
                            "list --state=running");
  auto state =
      std::make_shared<v1::Operation::State>(v1::Operation::STATE_UNSPECIFIED);
  auto limit = std::make_shared<size_t>(100);
  list->add_option("--state", *state, "Only jobs in this state")
      ->transform(CLI::CheckedTransformer(States()));
  list->add_option("--limit", *limit, "At most this many")
      ->capture_default_str();
  AddRemoteCommand(*list, select,
                   [=](TrainingClient& client, const RemoteFlags& flags) {
                     return ListJobs(client, *state, *limit, flags.json);
                   });

  struct Verb {
    const char* name;
    const char* description;
    absl::Status (*run)(TrainingClient&, const RemoteFlags&,
                        const std::string&);
  };
  const Verb verbs[] = {
      {"show", "Show a job and what it made", ShowJob},
      {"watch",
       "Watch a job until it ends. Exit codes: 3 it failed, 4 it was "
       "cancelled, 5 the gate was not passed. Ctrl-C ends the watch, not the "
       "job",
       Watch},
      {"cancel", "Ask a job to stop", Cancel},
      {"delete",
       "Delete a job that has ended, with its learning curve and its log; what "
       "it made stays",
       Delete},
      {"logs",
       "Print the end of what a job's process wrote to its log, also after the "
       "job has ended",
       Logs}};
  for (const Verb& verb : verbs) {
    CLI::App* command = &AddVerb(group, verb.name, verb.description,
                                 absl::StrCat(verb.name, " 7"));
    auto name = std::make_shared<std::string>();
    command->add_option("job", *name, "Name of the job, like 7")->required();
    AddRemoteCommand(*command, select,
                     [name, run = verb.run](TrainingClient& client,
                                            const RemoteFlags& flags) {
                       return run(client, flags, FullName("operations", *name));
                     });
  }
}

}  // namespace tactus::internal::client
