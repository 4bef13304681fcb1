// File: sign_ins.h
//
// SignIns: the people who are signed in to a console, by the secret that their
// browser's cookie holds.
//
//   SignIns sign_ins;
//   const std::string cookie = sign_ins.Add(token, now);
//   const auto person = sign_ins.Find(cookie, now);
//   if (person == nullptr) return Unauthorized();
//
// Secrets are of 256 random bits, and each sign-in has new ones. They end after
// limits::kSignInHours, with the console, or when too many others are signed
// in, the oldest first. Nothing is kept on disk. Not thread-safe.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <string>

#include "absl/strings/string_view.h"

namespace tactus::internal::console {

// 256 random bits as text.
std::string NewSecret();

// True if both are the same, in a time that does not tell where they differ.
bool SameSecret(absl::string_view a, absl::string_view b);

struct SignIn {
  // What the servers know the person by.
  std::string token;
  // Requests that change something repeat it, which other sites cannot.
  std::string csrf;
  // For programs that watch in the person's name, and do nothing else.
  std::string watch_key;
  std::chrono::steady_clock::time_point end;
};

class SignIns {
 public:
  using Time = std::chrono::steady_clock::time_point;

  // Returns the cookie.
  std::string Add(std::string token, Time now);
  // Null if nobody is signed in with this cookie, or no longer.
  std::shared_ptr<const SignIn> Find(absl::string_view cookie, Time now) const;
  std::shared_ptr<const SignIn> FindByWatchKey(absl::string_view key,
                                               Time now) const;
  bool Has(const std::shared_ptr<const SignIn>& sign_in, Time now) const;
  void Remove(absl::string_view cookie);
  void Remove(const std::shared_ptr<const SignIn>& sign_in);

 private:
  std::map<std::string, std::shared_ptr<const SignIn>, std::less<>> by_cookie_;
};

}  // namespace tactus::internal::console
