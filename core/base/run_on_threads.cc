#include "core/base/run_on_threads.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace tactus::internal {
namespace {

void Run(int threads, int count, const std::function<void(int)>& body) {
  std::atomic<int> next = 0;
  auto work = [&] {
    for (int i = next++; i < count; i = next++) body(i);
  };
  std::vector<std::jthread> others;
  for (int t = 1; t < std::min(threads, count); ++t) {
    others.emplace_back(work);
  }
  work();
}

}  // namespace

void RunOnThreads(int count, const std::function<void(int)>& body) {
  Run(static_cast<int>(std::thread::hardware_concurrency()), count, body);
}

std::function<void(int, const std::function<void(int)>&)> OnThreads(
    int threads) {
  return [threads](int count, const std::function<void(int)>& body) {
    Run(threads, count, body);
  };
}

}  // namespace tactus::internal
