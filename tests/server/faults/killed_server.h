// File: killed_server.h
//
// KilledServer: the program tactusd on a data directory. It and its
// tactus-trainer are killed (SIGKILL) at random moments, and it starts again. A
// target that uses it defines TACTUSD and depends on tactusd and
// tactus-trainer.
//
//   KilledServer server(folder / "data", seed);
//   server.Arm("upload", milliseconds(10));  // a kill within the next 10 ms
//   if (!client.Upload().ok() && server.Died()) server.Restart();
//   server.Report();
//
// Owns the processes. Not thread-safe.
#pragma once

#include <dirent.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <thread>

#include "client/training/training_client.h"
#include "core/base/random.h"
#include "gtest/gtest.h"
#include "tests/support/child_tactusd.h"

namespace tactus::internal::testing {

class KilledServer {
 public:
  using milliseconds = std::chrono::milliseconds;

  // Without a seed nothing is killed.
  explicit KilledServer(std::string folder, uint64_t seed = 0)
      : folder_(std::move(folder)), random_(seed), calm_(seed == 0) {
    Start();
  }
  ~KilledServer() { Disarm(); }

  client::TrainingClient& client() { return *client_; }
  // Kills of server and trainer so far.
  int kills() const { return kills_; }

  // A phase begins, or goes on after a restart. Arms a kill of the server or
  // its trainer within `longest` from now, with a probability of two thirds,
  // unless one is armed already.
  void Arm(const char* phase, milliseconds longest) {
    phase_ = phase;
    if (calm_ || (killer_.joinable() && !fired_)) return;
    Disarm();
    if (random_.Uniform() < 1.0 / 3) return;
    const bool trainer = random_.Uniform() < 0.35;
    const auto delay = std::chrono::duration<double, std::milli>(
        random_.Uniform() * static_cast<double>(longest.count()));
    killer_ = std::thread([this, trainer, delay] {
      std::this_thread::sleep_for(delay);
      trainer ? KillTrainer() : KillServer();
      fired_ = true;
    });
  }
  // True if the server was killed. Waits for the end of an armed kill only if
  // it is under way.
  bool Died() {
    if (!server_killed_) return false;
    Disarm();
    return true;
  }
  // Starts it again; kills some starts.
  void Restart() {
    server_->Wait();
    while (random_.Uniform() < 0.2) {
      ChildTactusd start(Options(/*wait=*/false));
      std::this_thread::sleep_for(
          std::chrono::duration<double, std::milli>(60 * random_.Uniform()));
      start.Signal(SIGKILL);
      start.Wait();
      Count("start of tactusd");
    }
    Start();
  }
  // Arms nothing from now on.
  void Calm() {
    Disarm();
    calm_ = true;
  }
  void Report() const {
    for (const auto& [what, count] : counts_) {
      std::printf("%5d  %s\n", count, what.c_str());
    }
  }

 private:
  ChildTactusd::Options Options(bool wait) const {
    return {.flags = {"--data-dir=" + folder_, "--log-level=off"},
            .wait = wait};
  }
  void Start() {
    server_killed_ = false;
    trainer_kills_ = 0;
    server_ = std::make_unique<ChildTactusd>(Options(/*wait=*/true));
    ASSERT_NE(server_->port(), 0) << server_->Log();
    client_ = std::make_unique<client::TrainingClient>(
        client::MakeTrainingChannel(server_->address(), {}));
  }
  void Disarm() {
    if (killer_.joinable()) killer_.join();
    fired_ = false;
  }
  void Count(const std::string& what) {
    ++kills_;
    ++counts_[what];
  }
  void KillServer() {
    Count(std::string("tactusd during ") + phase_.load());
    server_killed_ = true;
    server_->Signal(SIGKILL);
  }
  // A job fails after its third crash since the server started; so the third is
  // not made.
  void KillTrainer() {
    const pid_t pid = Trainer();
    if (pid <= 0 || trainer_kills_ == 2) return;
    if (kill(pid, SIGKILL) != 0) return;
    ++trainer_kills_;
    Count(std::string("tactus-trainer during ") + phase_.load());
  }
  // The newest child of the server; 0 without one.
  pid_t Trainer() const {
    const std::string tasks =
        "/proc/" + std::to_string(server_->pid()) + "/task";
    pid_t found = 0;
    DIR* const folder = opendir(tasks.c_str());
    if (folder == nullptr) return 0;
    while (const dirent* entry = readdir(folder)) {
      std::ifstream children(tasks + "/" + entry->d_name + "/children");
      for (pid_t pid = 0; children >> pid;) found = std::max(found, pid);
    }
    closedir(folder);
    return found;
  }

  const std::string folder_;
  Random random_;
  bool calm_;
  std::unique_ptr<ChildTactusd> server_;
  std::unique_ptr<client::TrainingClient> client_;
  std::thread killer_;
  // What the client does now; a literal.
  std::atomic<const char*> phase_ = "";
  std::atomic<bool> fired_ = false;
  std::atomic<bool> server_killed_ = false;
  int trainer_kills_ = 0;
  std::atomic<int> kills_ = 0;
  std::map<std::string, int> counts_;
};

}  // namespace tactus::internal::testing
