#include "server/rpc/contact_log_rpcs.h"

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/limits_contact_log.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "server/contact_log/contact_replay.h"
#include "server/contact_log/logged_trial.h"
#include "server/rpc/control_handlers.h"
#include "spdlog/spdlog.h"
#include "tactus/v1/contact_log.pb.h"

namespace tactus::internal::server {
namespace {

constexpr char kContactLogService[] = "/tactus.v1.ContactLogService/";

absl::StatusOr<v1::ReplayContactResponse> Replay(
    const ContactLog& log, const ModelSource& models,
    const v1::ReplayContactRequest& request) {
  TACTUS_ASSIGN_OR_RETURN(const ContactName name,
                          ParseContactName(request.name()));
  if (request.max_frames() > limits::kMaxReplayFrames) {
    return InvalidConfig(
        "max_frames", request.max_frames(),
        absl::StrCat("1 to ", limits::kMaxReplayFrames, ", or 0 for ",
                     limits::kDefaultReplayFrames));
  }
  TACTUS_ASSIGN_OR_RETURN(const v1::StoredContacts stored, log.Read(name));
  const v1::RecordedStream& stream = stored.stream();
  TACTUS_ASSIGN_OR_RETURN(
      const PinnedModel model,
      models.Find(request.model().empty() ? stream.started().model_version()
                                          : request.model(),
                  stream.config().client_id()));
  return ReplayContact(
      stored, name.place, model,
      {.max_frames = request.max_frames() == 0 ? limits::kDefaultReplayFrames
                                               : request.max_frames(),
       .with_taxels = !request.without_taxels()});
}

// The labels of a request, by record and place.
using LabelsByRecord = std::map<uint64_t, std::map<uint32_t, v1::ContactLabel>>;

absl::StatusOr<LabelsByRecord> ParseLabels(
    const v1::LabelContactsRequest& request) {
  if (request.labels().empty() ||
      request.labels_size() > limits::kMaxContactLabels) {
    return InvalidConfig("number of labels", request.labels_size(),
                         absl::StrCat("1 to ", limits::kMaxContactLabels));
  }
  LabelsByRecord labels;
  for (const v1::ContactLabel& label : request.labels()) {
    TACTUS_ASSIGN_OR_RETURN(const ContactName name,
                            ParseContactName(label.contact()));
    const std::string fault =
        label.label().empty()
            ? "it must not be empty"
            : TextFault(label.label(), limits::kMaxTrialTextBytes);
    if (!fault.empty()) {
      return InvalidConfig("label", Quoted(label.label()), fault);
    }
    if (!labels[name.record].emplace(name.place, label).second) {
      return InvalidConfig("labels", absl::StrCat("two of ", label.contact()),
                           "one for each contact");
    }
  }
  return labels;
}

v1::Labelling LabellingOf(const v1::LoggedContact& contact,
                          const v1::ContactLabel& label, const Caller& caller,
                          int64_t now_ms) {
  v1::Labelling labelling;
  labelling.set_by(caller.name);
  labelling.set_time_ms(now_ms);
  labelling.set_before(contact.label());
  labelling.set_confidence(contact.confidence());
  labelling.set_model_version(contact.model_version());
  labelling.set_prefilled(label.prefilled());
  return labelling;
}

// The label that a contact was given before, for the same dataset.
void KeepEarlierLabels(const v1::StoredContacts& stored,
                       const std::string& dataset,
                       std::map<uint32_t, v1::ContactLabel>& labels) {
  for (int i = 0; i < stored.contacts_size(); ++i) {
    const v1::GivenLabel& given = stored.contacts(i).given();
    if (!absl::StartsWith(given.dataset_version(),
                          absl::StrCat(dataset, "/versions/"))) {
      continue;
    }
    v1::ContactLabel earlier;
    earlier.set_label(given.label());
    labels.emplace(static_cast<uint32_t>(i), earlier);
  }
}

absl::StatusOr<v1::LabelContactsResponse> Label(
    ContactLog& log, TrainingBackend& backend,
    const v1::LabelContactsRequest& request, const Caller& caller) {
  TACTUS_ASSIGN_OR_RETURN(const LabelsByRecord labels, ParseLabels(request));
  const int64_t now_ms = backend.now_ms();
  v1::StoredLabels given;
  std::vector<uint64_t> records;
  for (const auto& [record, places] : labels) records.push_back(record);
  const auto make = [&](size_t index) -> absl::StatusOr<v1::TrialRecord> {
    const uint64_t record = records[index];
    auto places = labels.at(record);
    TACTUS_ASSIGN_OR_RETURN(
        const v1::StoredContacts stored,
        log.Read({.record = record, .place = places.begin()->first}));
    v1::Labelling first;
    for (const auto& [place, label] : places) {
      if (place >= static_cast<uint32_t>(stored.contacts_size())) {
        return NoSuchContact(label.contact());
      }
      v1::StoredLabel& out = *given.add_labels();
      out.set_contact(label.contact());
      out.mutable_given()->set_label(label.label());
      *out.mutable_given()->mutable_labelling() = LabellingOf(
          stored.contacts(static_cast<int>(place)), label, caller, now_ms);
      if (first.by().empty()) first = out.given().labelling();
    }
    KeepEarlierLabels(stored, request.dataset(), places);
    TACTUS_ASSIGN_OR_RETURN(v1::TrialRecord trial, TrialOf(stored, places));
    *trial.mutable_labelling() = first;
    return trial;
  };
  v1::LabelContactsResponse response;
  TACTUS_ASSIGN_OR_RETURN(
      *response.mutable_version(),
      backend.datasets().Take(
          {.dataset = request.dataset(),
           .count = records.size(),
           .make = make,
           .reason = request.reason().empty() ? "labels from the contact log"
                                              : request.reason(),
           .request_id = request.request_id()},
          caller));
  for (v1::StoredLabel& label : *given.mutable_labels()) {
    label.mutable_given()->set_dataset_version(response.version().name());
  }
  // The version is there, whether or not the log remembers it.
  if (given.labels().empty()) return response;
  if (const absl::Status status = log.AddLabels(given); !status.ok()) {
    spdlog::warn("the contact log does not know of labels in {}: {}",
                 response.version().name(), std::string(status.message()));
  }
  return response;
}

}  // namespace

void AddContactLogRpcs(ContactLog* log, const ModelSource* models,
                       TrainingBackend* backend, ControlService& control) {
  const auto add = [&](const char* method, Role role,
                       ControlService::Handler handler) {
    if (log == nullptr) {
      handler = [](ControlStream&) { return NoContactLog(); };
    }
    control.Add(absl::StrCat(kContactLogService, method), role,
                std::move(handler));
  };
  add("ListContacts", Role::kViewer,
      Unary<v1::ListContactsRequest, v1::ListContactsResponse>(
          [log](const auto& request, const Caller&) {
            return log->List(request);
          }));
  add("ReplayContact", Role::kViewer,
      Unary<v1::ReplayContactRequest, v1::ReplayContactResponse>(
          [log, models](const auto& request, const Caller&) {
            return Replay(*log, *models, request);
          }));
  add("LabelContacts", Role::kTrainer,
      Unary<v1::LabelContactsRequest, v1::LabelContactsResponse>(
          [log, backend](const auto& request, const Caller& caller)
              -> absl::StatusOr<v1::LabelContactsResponse> {
            if (backend == nullptr) return NoDataDirectory();
            return Label(*log, *backend, request, caller);
          }));
}

}  // namespace tactus::internal::server
