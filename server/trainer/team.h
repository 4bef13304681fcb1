// File: team.h
//
// Team: the ranks of a job, and how what happens at each of them reaches the
// first, which tells the server.
//
//   LoneTeam alone;
//   Team& team = alone;
//   if (team.rank() > 0) team.Tell(event.SerializeAsString());
//   team.Hear([&](int rank, const std::string& bytes) { Take(rank, bytes); });
//
// Tell and Hear may be called from several threads at once, Exchange from one.
#pragma once

#include <functional>
#include <string>

#include "core/base/ranks.h"

namespace tactus::internal::server {

class Team : public Ranks {
 public:
  using Take = std::function<void(int rank, const std::string& bytes)>;

  // Sends bytes to the first rank. What was told before an exchange is heard
  // when the first rank's call of Exchange returns.
  virtual void Tell(const std::string& bytes) = 0;
  // At the first rank: takes what has come.
  virtual void Hear(const Take& take) = 0;
  // Is called at the beginning of each Exchange, and again and again while it
  // waits, to tell and to hear.
  virtual void WhileWaiting(std::function<void()> call) = 0;
};

// A job that one process does.
class LoneTeam final : public Team {
 public:
  int rank() const override { return 0; }
  int size() const override { return 1; }
  absl::StatusOr<std::vector<std::string>> Exchange(
      const absl::StatusOr<std::string>& mine) override {
    return alone_.Exchange(mine);
  }
  void Tell(const std::string& /*bytes*/) override {}
  void Hear(const Take& /*take*/) override {}
  void WhileWaiting(std::function<void()> /*call*/) override {}

 private:
  OneRank alone_;
};

}  // namespace tactus::internal::server
