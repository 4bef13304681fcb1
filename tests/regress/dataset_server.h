// File: dataset_server.h
//
// A training server and trainctl in one process, and trials for datasets.
//
//   DatasetServer server;
//   EXPECT_EQ(server.Run({"datasets", "list"}).exit, 0);
//
// Captures stdout and stderr, so only one run at a time.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/data/trial_file.h"
#include "spdlog/spdlog.h"
#include "tests/server/support/training_server.h"
#include "tests/support/scratch_dir.h"
#include "tests/support/small_trials.h"
#include "tests/tools/trainctl/remote/trainctl_program.h"

namespace tactus::internal::testing {

class DatasetServer {
 public:
  DatasetServer() {
    // The log of the server goes to stdout, as the results do.
    spdlog::set_level(spdlog::level::off);
    server::TactusServer::Options serving;
    serving.listen = {address_};
    server_.emplace(server::TrainingBackend::Options{}, serving);
  }

  client::testing::Outcome Run(std::vector<std::string> arguments) const {
    arguments.push_back("--server=" + address_);
    return client::testing::Trainctl(std::move(arguments));
  }
  // Writes the trials number `first` to `end` - 1 as an import would: with ids
  // from 000000 on and the name of the recording.
  std::string Write(const std::string& name, int first, int end,
                    const std::function<void(Trial&)>& change = {}) const {
    auto writer = TrialFileWriter::Create(folder_ / name, {.overwrite = true});
    for (int i = first; i < end; ++i) {
      Trial trial = SmallTrial(i);
      trial.id.clear();
      trial.source = "pad_" + std::to_string(i) + ".csv";
      if (change) change(trial);
      EXPECT_TRUE(writer->Append(trial).ok());
    }
    EXPECT_TRUE(writer->Close().ok());
    return folder_ / name;
  }
  std::vector<Trial> Read(const std::string& name) const {
    return *TrialFileReader::Open(folder_ / name)->ReadAll();
  }
  std::string Path(const std::string& name) const { return folder_ / name; }
  TrainingServer& server() { return *server_; }

 private:
  ScratchDir folder_;
  const std::string address_ = "unix:" + (folder_ / "s");
  std::optional<TrainingServer> server_;
};

}  // namespace tactus::internal::testing
