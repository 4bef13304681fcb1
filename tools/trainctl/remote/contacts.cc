// trainctl contacts: what robots have touched, and labels for it.
#include <iostream>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "client/training/contact_log_client.h"
#include "client/training/retry.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "tools/common/event_line.h"
#include "tools/trainctl/remote/dataset_text.h"
#include "tools/trainctl/remote/flags.h"
#include "tools/trainctl/remote/proto_json.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {
namespace {

struct ListFlags {
  v1::ListContactsRequest request;
  std::string model;
  bool uncertain = false;
  bool unknown = false;
  bool undecided = false;
  bool revised = false;
  bool disagreeing = false;
  bool labelled = false;
  bool unlabelled = false;
  double below = 0;
  size_t most = 50;
};

std::string AnswerText(const v1::LoggedAnswer& answer) {
  return absl::StrFormat(
      "%s=%s %s%s%s", Printable(answer.question()), Printable(answer.value()),
      Percent(answer.probability()), answer.decided() ? "" : " (undecided)",
      answer.revised() ? " (revised)" : "");
}

std::string ContactText(const v1::LoggedContact& contact) {
  constexpr double kNsPerS = 1e9;
  std::string text = absl::StrFormat(
      "%-14s %s  %-16s %s %s  %.2f s", Printable(contact.name()),
      TimeText(contact.begin_time_ms()), Printable(contact.robot()),
      Printable(contact.label()), Percent(contact.confidence()),
      static_cast<double>(contact.duration_ns()) / kNsPerS);
  for (const v1::LoggedAnswer& answer : contact.answers()) {
    absl::StrAppend(&text, "  ", AnswerText(answer));
  }
  if (contact.unknown() > 0.5) {
    absl::StrAppend(&text, "  unknown ", Percent(contact.unknown()));
  }
  if (contact.has_shadow() && contact.shadow().label() != contact.label()) {
    absl::StrAppend(&text, "  shadow ", Printable(contact.shadow().label()),
                    " ", Percent(contact.shadow().confidence()));
  }
  if (contact.has_given()) {
    absl::StrAppend(&text, "  labelled ", Printable(contact.given().label()),
                    " by ", Printable(contact.given().labelling().by()));
  }
  return text;
}

absl::Status ListLogged(TrainingClient& client, const RemoteFlags& remote,
                        ListFlags flags) {
  v1::ListContactsRequest& request = flags.request;
  if (!flags.model.empty()) request.set_model(FullName("models", flags.model));
  if (flags.uncertain) {
    request.set_order(v1::ListContactsRequest::ORDER_UNCERTAIN);
  }
  request.set_only_unknown(flags.unknown);
  request.set_only_undecided(flags.undecided);
  request.set_only_revised(flags.revised);
  request.set_only_disagreeing(flags.disagreeing);
  request.set_confidence_below(flags.below);
  if (flags.labelled || flags.unlabelled) request.set_labelled(flags.labelled);
  TACTUS_ASSIGN_OR_RETURN(const v1::ListContactsResponse response,
                          ContactLogClient(&client).List(request, flags.most));
  if (remote.json) {
    PrintJson(ToJson(response));
    return absl::OkStatus();
  }
  for (const v1::LoggedContact& contact : response.contacts()) {
    absl::PrintF("%s\n", ContactText(contact));
  }
  absl::PrintF("%d of %d that match, of %d that are kept in %d of %d bytes\n",
               response.contacts_size(), response.matching(), response.kept(),
               response.bytes(), response.max_bytes());
  if (response.left_out() > 0) {
    absl::PrintF("%d could not be kept\n", response.left_out());
  }
  return absl::OkStatus();
}

// "17" as users write it.
std::string ContactNameOf(absl::string_view text) {
  return FullName("contacts", text);
}

// What a replay answers to the contact, and when.
void PrintOpinion(const v1::ReplayContactResponse& response) {
  for (const v1::WatchedFrame& frame : response.frames()) {
    const v1::Answer& answer = frame.answer();
    for (const v1::ContactEvent& event : answer.events()) {
      for (const v1::Contact& contact : answer.contacts()) {
        if (contact.id() != event.contact_id()) continue;
        absl::PrintF("  %s\n",
                     EventLine(event, contact.time_since_onset_ns() / 1'000'000,
                               response.started(), /*json=*/false));
      }
    }
  }
  absl::PrintF("%s:", Printable(response.started().model_version()));
  if (!response.has_replayed()) {
    absl::PrintF(" finds no such contact\n");
    return;
  }
  const v1::LoggedContact& replayed = response.replayed();
  absl::PrintF("  %s %s", Printable(replayed.label()),
               Percent(replayed.confidence()));
  for (const v1::LoggedAnswer& answer : replayed.answers()) {
    absl::PrintF("  %s", AnswerText(answer));
  }
  absl::PrintF("  unknown %s\n", Percent(replayed.unknown()));
}

absl::Status ShowLogged(TrainingClient& client, const RemoteFlags& remote,
                        const std::string& name, const std::string& model) {
  v1::ReplayContactRequest request;
  request.set_name(ContactNameOf(name));
  request.set_model(model);
  request.set_without_taxels(!remote.json);
  TACTUS_ASSIGN_OR_RETURN(const v1::ReplayContactResponse response,
                          ContactLogClient(&client).Replay(request));
  if (remote.json) {
    PrintJson(ToJson(response));
    return absl::OkStatus();
  }
  absl::PrintF("%s\n%s\n", ContactText(response.contact()),
               response.contact().model_version());
  if (response.contact().together() > 1) {
    absl::PrintF("one of %d contacts at the same time\n",
                 response.contact().together());
  }
  PrintOpinion(response);
  if (model.empty()) {
    absl::PrintF("%s\n",
                 response.same_answers()
                     ? "its frames give the same answers again, bit for bit"
                     : "its frames give other answers again");
  }
  return absl::OkStatus();
}

struct LabelFlags {
  std::string dataset;
  std::vector<std::string> labels;
  std::string object;
  std::string condition;
  std::string material;
  std::string reason;
  std::string request_id;
};

// Labels without "=LABEL" are what was answered.
absl::Status AddAnswered(ContactLogClient& log,
                         v1::LabelContactsRequest& request) {
  v1::ListContactsRequest list;
  for (const v1::ContactLabel& label : request.labels()) {
    if (label.label().empty()) list.add_names(label.contact());
  }
  if (list.names().empty()) return absl::OkStatus();
  TACTUS_ASSIGN_OR_RETURN(const v1::ListContactsResponse response,
                          log.List(list, list.names_size()));
  for (v1::ContactLabel& label : *request.mutable_labels()) {
    if (!label.label().empty()) continue;
    for (const v1::LoggedContact& contact : response.contacts()) {
      if (contact.name() != label.contact()) continue;
      label.set_label(contact.label());
      label.set_prefilled(true);
    }
  }
  return absl::OkStatus();
}

absl::Status LabelLogged(TrainingClient& client, const RemoteFlags& remote,
                         const LabelFlags& flags) {
  v1::LabelContactsRequest request;
  request.set_dataset(FullName("datasets", flags.dataset));
  request.set_reason(flags.reason);
  request.set_request_id(flags.request_id.empty() ? NewRequestId()
                                                  : flags.request_id);
  for (const std::string& text : flags.labels) {
    const std::pair<std::string, std::string> parts =
        absl::StrSplit(text, absl::MaxSplits('=', 1));
    if (parts.second.empty() && absl::StrContains(text, '=')) {
      return InvalidConfig("label", Quoted(text),
                           "CONTACT=LABEL, or CONTACT "
                           "to take what was answered");
    }
    v1::ContactLabel& label = *request.add_labels();
    label.set_contact(ContactNameOf(parts.first));
    label.set_label(parts.second);
    label.set_object(flags.object);
    label.set_condition(flags.condition);
    label.set_material(flags.material);
  }
  ContactLogClient log(&client);
  TACTUS_RETURN_IF_ERROR(AddAnswered(log, request));
  TACTUS_ASSIGN_OR_RETURN(const v1::DatasetVersion version,
                          Repeated({}, [&] { return log.Label(request); }));
  if (remote.json) {
    PrintJson(ToJson(version));
  } else {
    std::cout << VersionText(version) << OriginText(version);
  }
  return absl::OkStatus();
}

void AddList(CLI::App& group, const SelectCommand& select) {
  CLI::App& list = AddVerb(
      group, "list", "List contacts that the server has kept, the newest first",
      "list --uncertain --unlabelled");
  auto flags = std::make_shared<ListFlags>();
  list.add_flag("--uncertain", flags->uncertain, "The least confident first");
  list.add_option_function<std::string>(
      "--robot",
      [flags](const std::string& name) { flags->request.set_robot(name); },
      "Only of this robot");
  list.add_option("--model", flags->model, "Only of this model or version");
  list.add_option_function<std::string>(
      "--answer",
      [flags](const std::string& text) { flags->request.set_answer(text); },
      "Only with this class, or with this value of a question as "
      "QUESTION=VALUE");
  list.add_flag("--unknown", flags->unknown, "Only what no model knows");
  list.add_flag("--undecided", flags->undecided,
                "Only with a question that was not decided");
  list.add_flag("--revised", flags->revised,
                "Only with a decision that was changed");
  list.add_flag("--disagreeing", flags->disagreeing,
                "Only those to which the shadow gave another answer");
  list.add_option("--below", flags->below,
                  "Only with a confidence below this one")
      ->check(CLI::Range(0.0, 1.0));
  CLI::Option* labelled = list.add_flag("--labelled", flags->labelled,
                                        "Only those that have a label");
  list.add_flag("--unlabelled", flags->unlabelled, "Only those that have none")
      ->excludes(labelled);
  list.add_option("--most", flags->most, "How many to show")
      ->check(CLI::Range(1, 50'000))
      ->capture_default_str();
  AddRemoteCommand(list, select,
                   [=](TrainingClient& client, const RemoteFlags& remote) {
                     return ListLogged(client, remote, *flags);
                   });
}

void AddShow(CLI::App& group, const SelectCommand& select) {
  CLI::App& show = AddVerb(
      group, "show",
      "Answer a contact's frames once more, with the same model or another one",
      "show 17 --model=arm@3");
  auto name = std::make_shared<std::string>();
  auto model = std::make_shared<std::string>();
  show.add_option("contact", *name, "Its name, as list prints it")->required();
  show.add_option("--model", *model,
                  "Model, version or alias; default: the one that answered");
  AddRemoteCommand(show, select,
                   [=](TrainingClient& client, const RemoteFlags& remote) {
                     return ShowLogged(client, remote, *name, *model);
                   });
}

void AddLabel(CLI::App& group, const SelectCommand& select) {
  CLI::App& label = AddVerb(
      group, "label",
      "Make contacts trials of a dataset, which gets a new version. A contact "
      "without =LABEL gets the class that was answered",
      "label arm 17=SM 18=HU 19");
  auto flags = std::make_shared<LabelFlags>();
  label.add_option("dataset", flags->dataset, "Dataset")->required();
  label.add_option("labels", flags->labels, "CONTACT=LABEL, or CONTACT")
      ->required();
  label.add_option("--object", flags->object, "The object of all of them");
  label.add_option("--condition", flags->condition, "Their condition");
  label.add_option("--material", flags->material, "Their material");
  label.add_option("--reason", flags->reason,
                   "Why; kept with the version and in the audit log");
  label.add_option("--request-id", flags->request_id,
                   "Names this change: a second one of the same name changes "
                   "nothing and shows the same version. Default: a new name");
  AddRemoteCommand(label, select,
                   [=](TrainingClient& client, const RemoteFlags& remote) {
                     return LabelLogged(client, remote, *flags);
                   });
}

}  // namespace

void AddContacts(CLI::App& app, const SelectCommand& select) {
  CLI::App& group =
      CommandGroup(app, "contacts",
                   "See the contacts that a server has kept, and correct them",
                   "label arm 17=SM");
  AddList(group, select);
  AddShow(group, select);
  AddLabel(group, select);
}

}  // namespace tactus::internal::client
