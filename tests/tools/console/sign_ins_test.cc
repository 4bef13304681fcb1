#include "tools/console/sign_ins.h"

#include <set>
#include <string>
#include <thread>

#include "core/base/errors.h"
#include "core/base/limits_console.h"
#include "gtest/gtest.h"
#include "tools/console/doorkeeper.h"

namespace tactus::internal::console {
namespace {

using std::chrono::hours;
using std::chrono::seconds;

const SignIns::Time kFirst = SignIns::Time() + hours(1'000);

TEST(SignInsTest, FindsWhoIsSignedInUntilTheEnd) {
  SignIns sign_ins;
  const std::string cookie = sign_ins.Add("secret", kFirst);
  ASSERT_NE(sign_ins.Find(cookie, kFirst), nullptr);
  EXPECT_EQ(sign_ins.Find(cookie, kFirst)->token, "secret");
  EXPECT_EQ(sign_ins.Find("", kFirst), nullptr);
  EXPECT_EQ(sign_ins.Find(cookie.substr(1), kFirst), nullptr);
  const auto end = kFirst + hours(limits::kSignInHours);
  EXPECT_NE(sign_ins.Find(cookie, end - seconds(1)), nullptr);
  EXPECT_EQ(sign_ins.Find(cookie, end), nullptr);
  sign_ins.Remove(cookie);
  EXPECT_EQ(sign_ins.Find(cookie, kFirst), nullptr);
}

TEST(SignInsTest, SecretsAreNewEachTime) {
  SignIns sign_ins;
  std::set<std::string> secrets;
  for (int i = 0; i < 100; ++i) {
    const std::string cookie = sign_ins.Add("same", kFirst);
    secrets.insert(cookie);
    secrets.insert(sign_ins.Find(cookie, kFirst)->csrf);
    secrets.insert(sign_ins.Find(cookie, kFirst)->watch_key);
    EXPECT_EQ(cookie.size(), 64u);
  }
  EXPECT_EQ(secrets.size(), 300u);
}

TEST(SignInsTest, AWatchKeyIsGoodUntilTheEndOfItsSignIn) {
  SignIns sign_ins;
  const std::string cookie = sign_ins.Add("ann", kFirst);
  sign_ins.Add("bob", kFirst);
  const auto ann = sign_ins.Find(cookie, kFirst);
  const std::string key = ann->watch_key;
  EXPECT_EQ(sign_ins.FindByWatchKey(key, kFirst), ann);
  for (const std::string& other :
       {std::string(), cookie, ann->csrf, key.substr(1), key + "0"}) {
    EXPECT_EQ(sign_ins.FindByWatchKey(other, kFirst), nullptr) << other;
  }
  EXPECT_EQ(sign_ins.Find(key, kFirst), nullptr);
  const auto end = kFirst + hours(limits::kSignInHours);
  EXPECT_TRUE(sign_ins.Has(ann, end - seconds(1)));
  EXPECT_FALSE(sign_ins.Has(ann, end));
  EXPECT_EQ(sign_ins.FindByWatchKey(key, end), nullptr);
  sign_ins.Remove(ann);
  EXPECT_FALSE(sign_ins.Has(ann, kFirst));
  EXPECT_EQ(sign_ins.FindByWatchKey(key, kFirst), nullptr);
}

TEST(SignInsTest, TheOldestGoWhenThereAreTooMany) {
  SignIns sign_ins;
  const std::string first = sign_ins.Add("first", kFirst);
  const std::string second = sign_ins.Add("second", kFirst + seconds(1));
  for (size_t i = 2; i < limits::kMaxSignIns; ++i) {
    sign_ins.Add("other", kFirst + seconds(i));
  }
  const auto later = kFirst + hours(1);
  EXPECT_NE(sign_ins.Find(first, later), nullptr);
  sign_ins.Add("one more", later);
  EXPECT_EQ(sign_ins.Find(first, later), nullptr);
  EXPECT_NE(sign_ins.Find(second, later), nullptr);
}

TEST(DoorkeeperTest, ASignInIsOneUntilItEnds) {
  Doorkeeper doorkeeper({});
  const std::string ann = doorkeeper.SignInWith("ann-token");
  const auto first = doorkeeper.Find(ann);
  const auto second = doorkeeper.Find(doorkeeper.SignInWith("ann-token"));
  EXPECT_TRUE(doorkeeper.IsSignedIn(first));
  doorkeeper.EndSignIn(first);
  EXPECT_FALSE(doorkeeper.IsSignedIn(first));
  EXPECT_EQ(doorkeeper.Find(ann), nullptr);
  EXPECT_TRUE(doorkeeper.IsSignedIn(second));
  doorkeeper.Open();
  const auto everybody = doorkeeper.Find("");
  EXPECT_TRUE(doorkeeper.IsSignedIn(everybody));
  doorkeeper.EndSignIn(everybody);
  EXPECT_FALSE(doorkeeper.IsSignedIn(everybody));
  // Whoever comes next is somebody else.
  doorkeeper.Open();
  EXPECT_FALSE(doorkeeper.IsSignedIn(everybody));
}

TEST(DoorkeeperTest, ServersThatWantTokensNowAreOpenToNobody) {
  Doorkeeper doorkeeper({});
  doorkeeper.Open();
  EXPECT_NE(doorkeeper.Find(""), nullptr);
  doorkeeper.SignOut("");
  EXPECT_EQ(doorkeeper.Find(""), nullptr);
  EXPECT_FALSE(doorkeeper.is_open());
}

TEST(DoorkeeperTest, StrangersDoNotBorrowTheTrustInTheConsolesHost) {
  SignIn everybody;
  EXPECT_TRUE(MayCall(everybody, /*is_loopback=*/true).ok());
  EXPECT_EQ(ReasonOf(MayCall(everybody, /*is_loopback=*/false)),
            "PERMISSION_DENIED");
  everybody.token = "ann-token";
  EXPECT_TRUE(MayCall(everybody, /*is_loopback=*/false).ok());
}

TEST(DoorkeeperTest, ATokenLeavesTheHostOnlyEncrypted) {
  const ServerAddress here{"127.0.0.1:1", {}};
  const ServerAddress there{"arm.lab:50051", {}};
  const ServerAddress safe{"arm.lab:50051", {.tls_roots = "roots"}};
  EXPECT_TRUE(MayTakeToken(here, "token").ok());
  EXPECT_TRUE(MayTakeToken(safe, "token").ok());
  EXPECT_TRUE(MayTakeToken(there, "").ok());
  EXPECT_EQ(ReasonOf(MayTakeToken(there, "token")), "INVALID_CONFIG");
}

// Signing in asks the servers in their order, and ends with the first that
// takes the token.
TEST(LiveFeedTest, APlainServerElsewhereGetsNoToken) {
  const LiveFeed feed({{"arm.lab:50051", {}}}, "token");
  constexpr int kTries = 1'000;
  for (int i = 0; i < kTries && !feed.IsRefused(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_TRUE(feed.IsRefused());
  LiveFeed::Cursor cursor;
  EXPECT_NE(feed.Read(cursor)[0].error.find("--tls-ca"), std::string::npos);
}

TEST(SignInsTest, ComparesSecrets) {
  EXPECT_TRUE(SameSecret("abc", "abc"));
  EXPECT_FALSE(SameSecret("abc", "abd"));
  EXPECT_FALSE(SameSecret("abc", "ab"));
  EXPECT_FALSE(SameSecret("abc", ""));
}

}  // namespace
}  // namespace tactus::internal::console
