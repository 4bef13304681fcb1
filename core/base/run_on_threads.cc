#include "core/base/run_on_threads.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace tactus {

void RunOnThreads(int count, const std::function<void(int)>& body) {
  std::atomic<int> next = 0;
  auto work = [&] {
    for (int i = next++; i < count; i = next++) body(i);
  };
  const int processors =
      std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::vector<std::jthread> threads;
  for (int t = 1; t < std::min(processors, count); ++t) {
    threads.emplace_back(work);
  }
  work();
}

}  // namespace tactus
