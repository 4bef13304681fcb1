#include "server/ops/keep_warm.h"

#include <chrono>
#include <utility>

#include "server/ops/health_probe.h"

namespace tactus::server {
namespace {

constexpr std::chrono::milliseconds kPeriod(250);

}  // namespace

KeepWarm::KeepWarm(std::shared_ptr<grpc::Channel> channel)
    : channel_(std::move(channel)), thread_([this] { Run(); }) {}

KeepWarm::~KeepWarm() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void KeepWarm::Run() {
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, kPeriod, [this] { return stopping_; })) {
    lock.unlock();
    // The traffic is the purpose; the answer does not matter.
    ProbeHealth(*channel_, "", kPeriod).IgnoreError();
    lock.lock();
  }
}

}  // namespace tactus::server
