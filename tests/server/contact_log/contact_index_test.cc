#include "server/contact_log/contact_index.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits_contact_log.h"
#include "core/base/random.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal::server {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Request = v1::ListContactsRequest;

template <typename Value>
Value OneOf(Random& random, const std::vector<Value>& values) {
  return values[random.Index(values.size())];
}

// All have few values, so that most filters find some and leave out others.
v1::LoggedContact RandomContact(Random& random) {
  v1::LoggedContact contact;
  contact.set_robot(OneOf<std::string>(random, {"arm", "arm 2", "", "leg"}));
  contact.set_model_version(OneOf<std::string>(
      random, {"models/m/versions/1", "models/m/versions/2",
               "models/m/versions/12", "models/mm/versions/1"}));
  contact.set_label(OneOf<std::string>(random, {"HU", "SM", "kind=soft", ""}));
  contact.set_confidence(OneOf<double>(random, {0, 0.25, 0.5, 0.5, 0.75, 1}));
  contact.set_unknown(OneOf<double>(random, {0, 0.4, 0.5, 0.6, 1}));
  for (uint64_t i = random.Index(3); i > 0; --i) {
    v1::LoggedAnswer& answer = *contact.add_answers();
    answer.set_question(i == 1 ? "kind" : "size");
    answer.set_value(OneOf<std::string>(random, {"soft", "hard"}));
    answer.set_decided(random.Uniform() < 0.7);
    answer.set_revised(random.Uniform() < 0.2);
  }
  if (random.Uniform() < 0.3) contact.mutable_given()->set_label("SU");
  contact.mutable_picture()->set_rows(3);
  return contact;
}

// The filters, each as its comment in the proto says.
bool FitsFilters(const Request& request, const v1::LoggedContact& contact) {
  const auto any_answer = [&](auto has) {
    return std::any_of(contact.answers().begin(), contact.answers().end(), has);
  };
  std::vector<bool> holds;
  if (request.robot() != "")
    holds.push_back(contact.robot() == request.robot());
  if (request.model() != "") {
    const std::string& version = contact.model_version();
    const std::string model = version.substr(0, version.find("/versions"));
    holds.push_back(request.model() == version || request.model() == model);
  }
  if (request.answer() != "") {
    holds.push_back(request.answer() == contact.label() ||
                    any_answer([&](const v1::LoggedAnswer& answer) {
                      return request.answer() ==
                             answer.question() + "=" + answer.value();
                    }));
  }
  if (request.only_unknown()) holds.push_back(contact.unknown() > 0.5);
  if (request.only_undecided()) {
    holds.push_back(
        any_answer([](const auto& answer) { return !answer.decided(); }));
  }
  if (request.only_revised()) {
    holds.push_back(
        any_answer([](const auto& answer) { return answer.revised(); }));
  }
  if (request.confidence_below() != 0) {
    holds.push_back(contact.confidence() < request.confidence_below());
  }
  if (request.has_labelled()) {
    holds.push_back(request.labelled() == contact.has_given());
  }
  if (request.names_size() > 0) {
    holds.push_back(std::count(request.names().begin(), request.names().end(),
                               contact.name()) > 0);
  }
  return std::ranges::all_of(holds, std::identity());
}

class ContactIndexTest : public ::testing::Test {
 protected:
  // Some 300 contacts, some together in a record; some records are absent.
  explicit ContactIndexTest() {
    uint64_t record = 5;
    while (all_.size() < 300) {
      record += 1 + random_.Index(3);
      v1::StoredContacts stored;
      const uint64_t together = 1 + random_.Index(3);
      for (uint32_t place = 0; place < together; ++place) {
        *stored.add_contacts() = RandomContact(random_);
        v1::LoggedContact& contact = all_[{record, place}];
        contact = stored.contacts(static_cast<int>(place));
        contact.clear_picture();
        contact.set_name(ContactName{record, place}.ToString());
      }
      index_.Add(record, stored);
    }
  }

  // The names of all that fit, in the order of the list.
  std::vector<std::string> Expected(const Request& request) const {
    std::vector<std::pair<ContactName, const v1::LoggedContact*>> fitting;
    for (const auto& [name, contact] : all_) {
      if (FitsFilters(request, contact)) fitting.emplace_back(name, &contact);
    }
    std::ranges::stable_sort(fitting, [&](const auto& a, const auto& b) {
      if (request.order() == Request::ORDER_UNCERTAIN &&
          a.second->confidence() != b.second->confidence()) {
        return a.second->confidence() < b.second->confidence();
      }
      return a.first.record > b.first.record;
    });
    std::vector<std::string> names;
    for (const auto& [name, contact] : fitting)
      names.push_back(contact->name());
    return names;
  }

  // Reads all pages.
  void ExpectPages(Request request) const {
    const std::vector<std::string> expected = Expected(request);
    const size_t size =
        request.page_size() == 0
            ? limits::kDefaultListedContacts
            : std::min(request.page_size(), limits::kMaxListedContacts);
    std::vector<std::string> names;
    do {
      const auto page = index_.Search(request);
      ASSERT_TRUE(page.ok()) << page.status();
      EXPECT_EQ(page->matching, expected.size());
      EXPECT_EQ(page->contacts.size(),
                std::min(size, expected.size() - names.size()));
      for (const v1::LoggedContact& contact : page->contacts) {
        names.push_back(contact.name());
        EXPECT_FALSE(contact.has_picture());
      }
      request.set_page_token(page->next_page_token);
      ASSERT_LE(names.size(), expected.size());
    } while (!request.page_token().empty());
    EXPECT_EQ(names, expected) << request.ShortDebugString();
  }

  std::string ReasonFor(const Request& request) const {
    return ReasonOf(index_.Search(request).status());
  }

  Random random_{17};
  ContactIndex index_;
  std::map<ContactName, v1::LoggedContact> all_;
};

TEST_F(ContactIndexTest, PagesOfEverySize) {
  for (const auto order :
       {Request::ORDER_UNSPECIFIED, Request::ORDER_UNCERTAIN}) {
    for (int size = 0; size <= 210; size += size < 12 ? 1 : 29) {
      Request request;
      request.set_order(order);
      request.set_page_size(size);
      ExpectPages(request);
    }
    Request request;
    request.set_order(order);
    request.set_page_size(std::numeric_limits<int32_t>::max());
    ExpectPages(request);
  }
}

TEST_F(ContactIndexTest, EachFilterAloneAndAllTogether) {
  const std::vector<std::function<void(Request&)>> filters = {
      [](Request& r) { r.set_robot("arm"); },
      [](Request& r) { r.set_robot("ar"); },
      [](Request& r) { r.set_model("models/m"); },
      [](Request& r) { r.set_model("models/m/versions/1"); },
      [](Request& r) { r.set_model("models/m/versions"); },
      [](Request& r) { r.set_model("models"); },
      [](Request& r) { r.set_answer("HU"); },
      [](Request& r) { r.set_answer("kind=soft"); },
      [](Request& r) { r.set_answer("kind="); },
      [](Request& r) { r.set_only_unknown(true); },
      [](Request& r) { r.set_only_undecided(true); },
      [](Request& r) { r.set_only_revised(true); },
      [](Request& r) { r.set_confidence_below(0.5); },
      [](Request& r) { r.set_confidence_below(1); },
      [](Request& r) { r.set_labelled(true); },
      [](Request& r) { r.set_labelled(false); },
  };
  for (const auto& first : filters) {
    for (const auto& second : filters) {
      Request request;
      first(request);
      second(request);
      request.set_order(random_.Uniform() < 0.5 ? Request::ORDER_UNSPECIFIED
                                                : Request::ORDER_UNCERTAIN);
      request.set_page_size(1 + static_cast<int>(random_.Index(50)));
      ExpectPages(request);
    }
  }
  Request some;
  filters[0](some);
  const size_t found = Expected(some).size();
  EXPECT_GT(found, 20u);
  EXPECT_LT(found, 280u);
}

TEST_F(ContactIndexTest, OnlyTheNamed) {
  Request request;
  for (const auto& [name, contact] : all_) {
    if (random_.Uniform() < 0.3) request.add_names(contact.name());
  }
  // One twice is one.
  request.add_names(request.names(0));
  request.set_page_size(7);
  ExpectPages(request);
  request.set_robot("leg");
  ExpectPages(request);
}

TEST_F(ContactIndexTest, BadRequestsAreRefused) {
  using Limits = std::numeric_limits<double>;
  for (const double value : {-0.1, 1.1, Limits::quiet_NaN(), Limits::infinity(),
                             -Limits::infinity()}) {
    Request request;
    request.set_confidence_below(value);
    EXPECT_EQ(ReasonFor(request), "INVALID_CONFIG") << value;
  }
  Request request;
  request.set_page_size(-1);
  EXPECT_EQ(ReasonFor(request), "INVALID_CONFIG");
  request.Clear();
  request.set_order(static_cast<Request::Order>(2));
  EXPECT_EQ(ReasonFor(request), "INVALID_CONFIG");
  request.Clear();
  for (int i = 0; i <= limits::kMaxListedContacts; ++i) {
    request.add_names(all_.begin()->second.name());
  }
  EXPECT_EQ(ReasonFor(request), "INVALID_CONFIG");
  request.clear_names();
  request.add_names("contacts/01");
  EXPECT_EQ(ReasonFor(request), "INVALID_NAME");
  // Names that no contact has (any more).
  for (const char* name : {"contacts/1", "contacts/999999", "contacts/6-50"}) {
    request.clear_names();
    request.add_names(name);
    EXPECT_EQ(ReasonFor(request), "CONTACT_NOT_FOUND") << name;
  }
}

TEST_F(ContactIndexTest, BadTokensAreRefused) {
  constexpr uint64_t kNanBits = 0x7FF8000000000000;
  for (const std::string& token :
       {std::string("x"), std::string("."), std::string("1.2"),
        std::string("1.2.3.4"), std::string("1..3"), std::string("-1.2.3"),
        std::string("1.2.4294967296"), std::string("1.2.x"),
        std::string("18446744073709551616.1.1"), absl::StrCat(kNanBits, ".1.1"),
        std::string(100'000, '.')}) {
    Request request;
    request.set_page_token(token);
    EXPECT_EQ(ReasonFor(request), "INVALID_CONFIG") << token.substr(0, 50);
    request.set_order(Request::ORDER_UNCERTAIN);
    EXPECT_EQ(ReasonFor(request), "INVALID_CONFIG") << token.substr(0, 50);
  }
}

// Contacts of a page that was read may be dropped before the next is.
TEST_F(ContactIndexTest, APageGoesOnWhereAContactIsGone) {
  Request request;
  request.set_page_size(20);
  const auto first = index_.Search(request);
  ASSERT_TRUE(first.ok());
  const auto last = ParseContactName(first->contacts.back().name());
  index_.ForgetBefore(last->record + 1);
  request.set_page_token(first->next_page_token);
  const auto second = index_.Search(request);
  ASSERT_TRUE(second.ok()) << second.status();
  EXPECT_THAT(second->contacts, IsEmpty());
  EXPECT_EQ(second->next_page_token, "");
}

TEST_F(ContactIndexTest, ForgetsTheOldest) {
  for (const uint64_t before : {0, 5, 100, 101, 200}) {
    index_.ForgetBefore(before);
    std::erase_if(all_,
                  [&](const auto& it) { return it.first.record < before; });
    EXPECT_EQ(index_.size(), all_.size());
    ExpectPages({});
    for (uint64_t record = 0; record < 300; ++record) {
      size_t count = 0;
      for (uint32_t place = 0; place < 5; ++place) {
        const bool is_here = all_.contains({record, place});
        EXPECT_EQ(index_.Find({record, place}) != nullptr, is_here);
        count += is_here ? 1 : 0;
      }
      EXPECT_EQ(index_.OfRecord(record).size(), count);
    }
  }
  index_.ForgetBefore(std::numeric_limits<uint64_t>::max());
  EXPECT_EQ(index_.size(), 0u);
}

TEST_F(ContactIndexTest, RemembersTheLastLabel) {
  const auto& [name, contact] = *std::next(all_.begin(), 40);
  v1::StoredLabels labels;
  for (const std::string& text : {contact.name(), std::string("contacts/1"),
                                  std::string("no name"), contact.name()}) {
    v1::StoredLabel& label = *labels.add_labels();
    label.set_contact(text);
    label.mutable_given()->set_label(
        absl::StrCat("label ", labels.labels_size()));
  }
  index_.AddLabels(labels);
  EXPECT_EQ(index_.Find(name)->given().label(), "label 4");
  EXPECT_EQ(index_.size(), all_.size());
  *all_[name].mutable_given() = labels.labels(3).given();
  Request request;
  request.set_labelled(true);
  ExpectPages(request);
  // All else is as before.
  EXPECT_EQ(index_.Find(name)->SerializeAsString(),
            all_[name].SerializeAsString());
}

TEST(EmptyContactIndexTest, ListsNothing) {
  const ContactIndex index;
  const auto page = index.Search({});
  ASSERT_TRUE(page.ok());
  EXPECT_THAT(page->contacts, IsEmpty());
  EXPECT_EQ(page->matching, 0u);
  EXPECT_EQ(page->next_page_token, "");
}

}  // namespace
}  // namespace tactus::internal::server
