// File: doorkeeper.h
//
// Doorkeeper: who may see what. Asks the servers whether a token may watch, and
// keeps those who are signed in.
//
//   Doorkeeper doorkeeper(servers);
//   const absl::Status status = doorkeeper.Ask(token);   // blocks; any thread
//   if (status.ok()) cookie = doorkeeper.SignInWith(token);
//   const auto person = doorkeeper.Find(cookie);
//   if (person != nullptr) feed = doorkeeper.FeedOf(person);
//
// If the servers want no token, everybody is signed in: then find a person by
// the empty cookie. Ask is thread-safe, all else is for one thread.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "tools/console/live_feed.h"
#include "tools/console/server_address.h"
#include "tools/console/sign_ins.h"

namespace tactus::internal::console {

// OK if a person's page may call servers. A server without tokens trusts its
// own host, and so the console, with everything; people on other machines must
// not borrow that trust, so they need a token. `is_loopback`: the console
// listens on its own machine alone.
absl::Status MayCall(const SignIn& person, bool is_loopback);

class Doorkeeper {
 public:
  using Person = std::shared_ptr<const SignIn>;

  explicit Doorkeeper(std::vector<ServerAddress> servers)
      : servers_(std::move(servers)) {}

  const std::vector<ServerAddress>& servers() const { return servers_; }

  // OK if one of the servers lets `token` watch; else the error of the first
  // one. An empty token is none.
  absl::Status Ask(const std::string& token) const;

  // Returns the cookie.
  std::string SignInWith(const std::string& token);
  // Also ends what Open began: servers may want tokens by now.
  void SignOut(const std::string& cookie);
  // Everybody may watch, as the servers say.
  void Open();
  bool is_open() const { return everybody_ != nullptr; }
  // Who everybody is; null if the servers want a token.
  Person Everybody() const { return everybody_; }
  // Null if nobody is signed in with this cookie.
  Person Find(const std::string& cookie) const;
  // Null if it is nobody's key for watching.
  Person FindByWatchKey(absl::string_view key) const;
  // True until the person's sign-in ends.
  bool IsSignedIn(const Person& person) const;
  // Ends the sign-in: the servers no longer take the person's token.
  void EndSignIn(const Person& person);
  // What the person sees: one feed for all of a person's pages. It lasts as
  // long as somebody holds it.
  std::shared_ptr<LiveFeed> FeedOf(const Person& person);

 private:
  const std::vector<ServerAddress> servers_;
  SignIns sign_ins_;
  Person everybody_;
  std::map<std::string, std::weak_ptr<LiveFeed>> feeds_by_token_;
};

}  // namespace tactus::internal::console
