#include "tools/console/doorkeeper.h"

#include "absl/strings/str_cat.h"
#include "client/training/monitor_client.h"
#include "client/training/training_client.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal::console {
namespace {

constexpr std::chrono::seconds kAnswerPatience(5);

}  // namespace

absl::Status MayCall(const SignIn& person, bool is_loopback) {
  if (is_loopback || !person.token.empty()) return absl::OkStatus();
  return MakeError(
      absl::StatusCode::kPermissionDenied, v1::ERROR_REASON_PERMISSION_DENIED,
      "on other machines than the console's this needs a token, and the server "
      "has none; start tactusd with --tokens=FILE",
      {{"role", "none"}});
}

absl::Status Doorkeeper::Ask(const std::string& token) const {
  absl::Status first;
  for (const ServerAddress& server : servers_) {
    TACTUS_RETURN_IF_ERROR(MayTakeToken(server, token));
    client::TrainingClient client(
        client::MakeTrainingChannel(server.address, server.channel),
        {.token = token, .timeout = kAnswerPatience});
    const auto streams = client::MonitorClient(&client).ListStreams();
    if (streams.ok()) return absl::OkStatus();
    if (first.ok()) first = streams.status();
  }
  return first;
}

std::string Doorkeeper::SignInWith(const std::string& token) {
  return sign_ins_.Add(token, SignIns::Time::clock::now());
}

void Doorkeeper::SignOut(const std::string& cookie) {
  sign_ins_.Remove(cookie);
  everybody_ = nullptr;
}

void Doorkeeper::Open() {
  if (everybody_ != nullptr) return;
  auto everybody = std::make_shared<SignIn>();
  everybody->csrf = NewSecret();
  everybody->watch_key = NewSecret();
  everybody->end = SignIns::Time::max();
  everybody_ = std::move(everybody);
}

Doorkeeper::Person Doorkeeper::Find(const std::string& cookie) const {
  if (everybody_ != nullptr) return everybody_;
  return sign_ins_.Find(cookie, SignIns::Time::clock::now());
}

Doorkeeper::Person Doorkeeper::FindByWatchKey(absl::string_view key) const {
  if (everybody_ != nullptr && SameSecret(key, everybody_->watch_key)) {
    return everybody_;
  }
  return sign_ins_.FindByWatchKey(key, SignIns::Time::clock::now());
}

bool Doorkeeper::IsSignedIn(const Person& person) const {
  return person == everybody_ ||
         sign_ins_.Has(person, SignIns::Time::clock::now());
}

void Doorkeeper::EndSignIn(const Person& person) {
  sign_ins_.Remove(person);
  everybody_ = nullptr;
}

std::shared_ptr<LiveFeed> Doorkeeper::FeedOf(const Person& person) {
  std::erase_if(feeds_by_token_,
                [](const auto& item) { return item.second.expired(); });
  std::weak_ptr<LiveFeed>& slot = feeds_by_token_[person->token];
  auto feed = slot.lock();
  if (feed == nullptr) {
    feed = std::make_shared<LiveFeed>(servers_, person->token);
    slot = feed;
  }
  return feed;
}

}  // namespace tactus::internal::console
