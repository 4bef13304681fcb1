// File: waker.h
//
// Waker: lets other threads give work to the thread that serves browsers, as
// long as it serves.
//
//   waker.Post([] { SendWhatIsNew(); });   // any thread
//   waker.Stop();                          // what comes later is dropped
//
// Thread-safe.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <mutex>
#include <utility>

namespace tactus::internal::console {

class Waker {
 public:
  explicit Waker(boost::asio::io_context* context) : context_(context) {}

  template <typename Work>
  void Post(Work work) {
    const std::lock_guard lock(mutex_);
    if (context_ != nullptr) boost::asio::post(*context_, std::move(work));
  }
  void Stop() {
    const std::lock_guard lock(mutex_);
    context_ = nullptr;
  }

 private:
  std::mutex mutex_;
  boost::asio::io_context* context_;
};

}  // namespace tactus::internal::console
