// File: shared_catalog.h
//
// A catalogue of the test's own in PostgreSQL, and processes that share it.
//
//   class MyTest : public SharedCatalogTest {};
//   TEST_F(MyTest, X) { auto replica = Join(); }
#pragma once

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <thread>

#include "core/postgres/postgres_catalog.h"
#include "gtest/gtest.h"
#include "server/replicas/replica.h"
#include "tests/support/postgres_server.h"

namespace tactus::internal::server {

// Short, so that tests see processes die, and longer than a busy machine stands
// still.
inline constexpr Replica::Pace kQuickPace = {
    .beat = std::chrono::milliseconds(100),
    .dead = std::chrono::milliseconds(4000)};

class SharedCatalogTest : public ::testing::Test {
 protected:
  static void TearDownTestSuite() {
    delete server_;
    server_ = nullptr;
  }
  void SetUp() override {
    if (!testing::PostgresServer::IsInstalled()) {
      GTEST_SKIP() << "PostgreSQL is not installed";
    }
    if (server_ == nullptr) server_ = new testing::PostgresServer();
    address_ = server_->NewDatabase();
    auto catalog = OpenPostgresCatalog(address_);
    ASSERT_TRUE(catalog.ok()) << catalog.status();
    catalog_ = *std::move(catalog);
  }

  // A process, which gives signs of life.
  std::unique_ptr<Replica> Join(const std::string& address = "here:1") {
    v1::StoredReplica about;
    about.set_address(address);
    auto replica = Replica::Register(catalog_.get(), about, kQuickPace);
    EXPECT_TRUE(replica.ok()) << replica.status();
    (*replica)->Start([](bool) {});
    return *std::move(replica);
  }

  // True if `replica` knows of it and has not seen it silent.
  static bool IsAlive(Replica& replica, const std::string& name) {
    const auto all = replica.All();
    return all.ok() &&
           std::ranges::any_of(*all, [&](const Replica::Seen& seen) {
             return seen.about.name() == name && seen.alive;
           });
  }

  // At most half a minute; true if it came about.
  template <typename Condition>
  static bool Eventually(const Condition& condition) {
    for (int i = 0; i < 1500; ++i) {
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
  }

  static inline testing::PostgresServer* server_ = nullptr;
  std::string address_;
  std::unique_ptr<Catalog> catalog_;
};

}  // namespace tactus::internal::server
