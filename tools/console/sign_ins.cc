#include "tools/console/sign_ins.h"

#include <openssl/crypto.h>
#include <openssl/rand.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

#include "absl/strings/escaping.h"
#include "core/base/limits_console.h"

namespace tactus::internal::console {

std::string NewSecret() {
  std::array<unsigned char, 32> bytes{};
  // Without random numbers nobody may sign in.
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1) {
    std::abort();
  }
  return absl::BytesToHexString(absl::string_view(
      reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

bool SameSecret(absl::string_view a, absl::string_view b) {
  return a.size() == b.size() &&
         CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

std::string SignIns::Add(std::string token, Time now) {
  std::erase_if(by_cookie_,
                [&](const auto& item) { return item.second->end <= now; });
  if (by_cookie_.size() >= limits::kMaxSignIns) {
    by_cookie_.erase(std::ranges::min_element(
        by_cookie_, {}, [](const auto& item) { return item.second->end; }));
  }
  auto sign_in = std::make_shared<SignIn>();
  sign_in->token = std::move(token);
  sign_in->csrf = NewSecret();
  sign_in->watch_key = NewSecret();
  sign_in->end = now + std::chrono::hours(limits::kSignInHours);
  std::string cookie = NewSecret();
  by_cookie_.emplace(cookie, std::move(sign_in));
  return cookie;
}

std::shared_ptr<const SignIn> SignIns::Find(absl::string_view cookie,
                                            Time now) const {
  const auto found = by_cookie_.find(cookie);
  if (found == by_cookie_.end() || found->second->end <= now) return nullptr;
  return found->second;
}

std::shared_ptr<const SignIn> SignIns::FindByWatchKey(absl::string_view key,
                                                      Time now) const {
  std::shared_ptr<const SignIn> found;
  for (const auto& [cookie, sign_in] : by_cookie_) {
    if (SameSecret(key, sign_in->watch_key) && sign_in->end > now) {
      found = sign_in;
    }
  }
  return found;
}

bool SignIns::Has(const std::shared_ptr<const SignIn>& sign_in,
                  Time now) const {
  return sign_in->end > now &&
         std::ranges::any_of(by_cookie_, [&](const auto& item) {
           return item.second == sign_in;
         });
}

void SignIns::Remove(absl::string_view cookie) {
  const auto found = by_cookie_.find(cookie);
  if (found != by_cookie_.end()) by_cookie_.erase(found);
}

void SignIns::Remove(const std::shared_ptr<const SignIn>& sign_in) {
  std::erase_if(by_cookie_,
                [&](const auto& item) { return item.second == sign_in; });
}

}  // namespace tactus::internal::console
