#include "server/contact_log/contact_index.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <set>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/base/errors.h"
#include "core/base/limits_contact_log.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"

namespace tactus::internal::server {
namespace {

using Request = v1::ListContactsRequest;

// Where a contact stands in the order of a list: those that rise come first.
struct Rank {
  double confidence = 0;
  // The newest has the least.
  uint64_t age = 0;
  uint32_t place = 0;
  auto operator<=>(const Rank&) const = default;
};

Rank RankOf(const ContactName& name, const v1::LoggedContact& contact,
            Request::Order order) {
  return {.confidence =
              order == Request::ORDER_UNCERTAIN ? contact.confidence() : 0,
          .age = ~name.record,
          .place = name.place};
}

std::string TokenOf(const Rank& rank) {
  return absl::StrCat(std::bit_cast<uint64_t>(rank.confidence), ".", rank.age,
                      ".", rank.place);
}

absl::StatusOr<Rank> ParseToken(const std::string& token) {
  const std::vector<absl::string_view> parts = absl::StrSplit(token, '.');
  Rank rank;
  uint64_t bits = 0;
  if (parts.size() == 3 && absl::SimpleAtoi(parts[0], &bits) &&
      absl::SimpleAtoi(parts[1], &rank.age) &&
      absl::SimpleAtoi(parts[2], &rank.place)) {
    rank.confidence = std::bit_cast<double>(bits);
    if (!std::isnan(rank.confidence)) return rank;
  }
  return InvalidConfig("page_token", Quoted(token),
                       "next_page_token of the page before");
}

bool HasAnswer(const v1::LoggedContact& contact, const std::string& wanted) {
  if (contact.label() == wanted) return true;
  return std::ranges::any_of(contact.answers(), [&](const auto& answer) {
    return absl::StrCat(answer.question(), "=", answer.value()) == wanted;
  });
}

bool IsOfModel(const v1::LoggedContact& contact, const std::string& model) {
  return contact.model_version() == model ||
         absl::StartsWith(contact.model_version(),
                          absl::StrCat(model, "/versions/"));
}

bool Matches(const Request& request, const v1::LoggedContact& contact) {
  const auto& answers = contact.answers();
  if (!request.robot().empty() && contact.robot() != request.robot()) {
    return false;
  }
  if (!request.model().empty() && !IsOfModel(contact, request.model())) {
    return false;
  }
  if (!request.answer().empty() && !HasAnswer(contact, request.answer())) {
    return false;
  }
  if (request.only_unknown() && contact.unknown() <= 0.5) return false;
  if (request.only_undecided() &&
      std::ranges::all_of(answers, &v1::LoggedAnswer::decided)) {
    return false;
  }
  if (request.only_revised() &&
      std::ranges::none_of(answers, &v1::LoggedAnswer::revised)) {
    return false;
  }
  if (request.only_disagreeing() &&
      (!contact.has_shadow() || contact.shadow().label() == contact.label())) {
    return false;
  }
  if (request.confidence_below() > 0 &&
      contact.confidence() >= request.confidence_below()) {
    return false;
  }
  return !request.has_labelled() || contact.has_given() == request.labelled();
}

absl::Status CheckRequest(const Request& request) {
  if (!(request.confidence_below() >= 0 && request.confidence_below() <= 1)) {
    return InvalidConfig("confidence_below", request.confidence_below(),
                         "0 to 1");
  }
  if (request.page_size() < 0) {
    return InvalidConfig("page_size", request.page_size(), "at least 0");
  }
  if (!Request::Order_IsValid(request.order())) {
    return InvalidConfig("order", static_cast<int>(request.order()),
                         "an order of ListContactsRequest");
  }
  if (request.names_size() > limits::kMaxListedContacts) {
    return InvalidConfig("number of names", request.names_size(),
                         absl::StrCat("at most ", limits::kMaxListedContacts));
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status NoSuchContact(const std::string& name) {
  return NoSuch(v1::ERROR_REASON_CONTACT_NOT_FOUND, "contact", name,
                "trainctl contacts list shows those that the log has; the "
                "oldest are dropped when it is full");
}

void ContactIndex::Add(uint64_t record, const v1::StoredContacts& stored) {
  for (int i = 0; i < stored.contacts_size(); ++i) {
    const ContactName name{record, static_cast<uint32_t>(i)};
    v1::LoggedContact& contact = contacts_[name];
    contact = stored.contacts(i);
    contact.clear_picture();
    contact.set_name(name.ToString());
  }
}

void ContactIndex::AddLabels(const v1::StoredLabels& labels) {
  for (const v1::StoredLabel& label : labels.labels()) {
    const auto name = ParseContactName(label.contact());
    if (!name.ok()) continue;
    const auto found = contacts_.find(*name);
    if (found == contacts_.end()) continue;
    *found->second.mutable_given() = label.given();
  }
}

void ContactIndex::ForgetBefore(uint64_t record) {
  contacts_.erase(contacts_.begin(),
                  contacts_.lower_bound(ContactName{record, 0}));
}

const v1::LoggedContact* ContactIndex::Find(const ContactName& name) const {
  const auto found = contacts_.find(name);
  return found == contacts_.end() ? nullptr : &found->second;
}

std::vector<v1::LoggedContact> ContactIndex::OfRecord(uint64_t record) const {
  std::vector<v1::LoggedContact> contacts;
  for (auto at = contacts_.lower_bound(ContactName{record, 0});
       at != contacts_.end() && at->first.record == record; ++at) {
    contacts.push_back(at->second);
  }
  return contacts;
}

absl::StatusOr<ContactIndex::Found> ContactIndex::Search(
    const Request& request) const {
  TACTUS_RETURN_IF_ERROR(CheckRequest(request));
  std::set<ContactName> names;
  for (const std::string& text : request.names()) {
    TACTUS_ASSIGN_OR_RETURN(const ContactName name, ParseContactName(text));
    if (Find(name) == nullptr) return NoSuchContact(text);
    names.insert(name);
  }
  Rank after;
  if (!request.page_token().empty()) {
    TACTUS_ASSIGN_OR_RETURN(after, ParseToken(request.page_token()));
  }
  const int size =
      request.page_size() == 0
          ? limits::kDefaultListedContacts
          : std::min(request.page_size(), limits::kMaxListedContacts);
  Found found;
  std::vector<std::pair<Rank, const v1::LoggedContact*>> ranked;
  for (const auto& [name, contact] : contacts_) {
    if (!names.empty() && !names.contains(name)) continue;
    if (!Matches(request, contact)) continue;
    ++found.matching;
    const Rank rank = RankOf(name, contact, request.order());
    if (!request.page_token().empty() && rank <= after) continue;
    ranked.emplace_back(rank, &contact);
  }
  const auto page = std::min(ranked.size(), static_cast<size_t>(size));
  std::ranges::partial_sort(ranked, ranked.begin() + page, std::less(),
                            [](const auto& item) { return item.first; });
  for (size_t i = 0; i < page; ++i) {
    found.contacts.push_back(*ranked[i].second);
  }
  if (page < ranked.size()) {
    found.next_page_token = TokenOf(ranked[page - 1].first);
  }
  return found;
}

}  // namespace tactus::internal::server
