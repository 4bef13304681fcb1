// File: memory_budget.h
//
// MemoryBudget: bytes that all callers together may use for something.
//
//   MemoryBudget parsing(limits::kMaxParsingBytes);
//   {
//     const MemoryBudget::Lease lease = parsing.Take(bytes.size());
//     Parse(bytes);
//   }
//   if (!known.TryTake(512)) return GiveUp();
//   known.Return(512);
//
// Who waits in Take gets the bytes in the order of the calls. Hold a lease only
// for work that ends by itself, and never take a second one meanwhile.
//
// Thread-safe. It must outlive its leases.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>

namespace tactus::internal::server {

class MemoryBudget {
 public:
  // Returns its bytes when it is destroyed.
  class Lease {
   public:
    Lease(MemoryBudget* budget, int64_t bytes)
        : budget_(budget), bytes_(bytes) {}
    ~Lease() { budget_->Return(bytes_); }
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;

   private:
    MemoryBudget* const budget_;
    const int64_t bytes_;
  };

  explicit MemoryBudget(int64_t bytes) : all_(bytes), free_(bytes) {}

  // Waits until `bytes` are free; if there are not as many at all, until all
  // are.
  Lease Take(int64_t bytes);
  // Takes `bytes` if they are free; they must be returned.
  bool TryTake(int64_t bytes);
  void Return(int64_t bytes);

 private:
  const int64_t all_;
  std::mutex mutex_;
  std::condition_variable returned_;
  int64_t free_;
  // Numbers of the calls of Take: the next one's, and the one whose turn it is.
  uint64_t next_ = 0;
  uint64_t turn_ = 0;
};

}  // namespace tactus::internal::server
