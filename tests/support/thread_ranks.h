// File: thread_ranks.h
//
// RunAsRanks: ranks as threads of one process.
//
//   RunAsRanks(3, [&](Ranks& ranks) {
//     models[ranks.rank()] = FitModel(contacts, options, RunSerially, {},
//                                     nullptr, {}, &ranks);
//   });
//
// Every body must exchange equally often, or give an error last.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "core/base/ranks.h"

namespace tactus::internal::testing {

class ThreadTeam {
 public:
  explicit ThreadTeam(int size) : size_(size), given_(size) {}

  int size() const { return size_; }

  absl::StatusOr<std::vector<std::string>> Exchange(
      int rank, const absl::StatusOr<std::string>& mine) {
    std::unique_lock lock(mutex_);
    if (!error_.ok()) return error_;
    given_[rank] = mine;
    const int turn = turn_;
    if (++arrived_ == size_) {
      arrived_ = 0;
      ++turn_;
      all_.clear();
      for (const auto& given : given_) {
        if (!given.ok() && error_.ok()) error_ = given.status();
        all_.push_back(given.value_or(""));
      }
      all_arrived_.notify_all();
    }
    all_arrived_.wait(lock, [&] { return turn_ != turn; });
    if (!error_.ok()) return error_;
    // Nobody arrives at the next turn's end before all have copied this.
    return all_;
  }

 private:
  const int size_;
  std::mutex mutex_;
  std::condition_variable all_arrived_;
  std::vector<absl::StatusOr<std::string>> given_;
  std::vector<std::string> all_;
  absl::Status error_;
  int arrived_ = 0;
  int turn_ = 0;
};

class ThreadRanks final : public Ranks {
 public:
  ThreadRanks(ThreadTeam& team, int rank) : team_(team), rank_(rank) {}

  int rank() const override { return rank_; }
  int size() const override { return team_.size(); }
  absl::StatusOr<std::vector<std::string>> Exchange(
      const absl::StatusOr<std::string>& mine) override {
    return team_.Exchange(rank_, mine);
  }

 private:
  ThreadTeam& team_;
  const int rank_;
};

inline void RunAsRanks(int size, const std::function<void(Ranks&)>& body) {
  ThreadTeam team(size);
  std::vector<std::thread> threads;
  for (int rank = 0; rank < size; ++rank) {
    threads.emplace_back([&, rank] {
      ThreadRanks ranks(team, rank);
      body(ranks);
    });
  }
  for (std::thread& thread : threads) thread.join();
}

}  // namespace tactus::internal::testing
