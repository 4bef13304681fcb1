// Errors named neither the thing nor its value, or gave advice that led to the
// next error: flags and commands that do not exist. Every text of errors.cc is
// made here, and every command and flag that a text of the sources names is
// looked up in the programs.
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tools/trainctl/app.h"
#include "tools/trainctl/unknown_word.h"

namespace tactus::internal {
namespace {

using ::testing::HasSubstr;

struct Row {
  const char* function;
  absl::Status status;
  // The thing, its value, and what would be right or is to be done.
  std::vector<const char*> has;
};

std::vector<Row> AllRows() {
  using v1::ERROR_REASON_ALIAS_NOT_FOUND;
  return {
      {"MakeError",
       MakeError(absl::StatusCode::kInternal, ERROR_REASON_ALIAS_NOT_FOUND,
                 "the text"),
       {"the text"}},
      {"Annotate", Annotate(BundleVersion(2, 1), "a.tactus"), {"a.tactus: "}},
      {"Advise", Advise(BundleVersion(2, 1), "do that"), {"; do that"}},
      {"InvalidValue",
       InvalidValue(ERROR_REASON_ALIAS_NOT_FOUND, "rate", "-5", "above 0"),
       {"rate", "is -5", "must be above 0"}},
      {"InvalidConfig",
       InvalidConfig("rate", -5, "above 0"),
       {"rate", "is -5", "must be above 0"}},
      {"InvalidModel",
       InvalidModel("states", 0, "1 to 64"),
       {"states", "is 0", "must be 1 to 64"}},
      {"InvalidScene",
       InvalidScene("speed", -1, "above 0"),
       {"speed", "is -1", "must be above 0"}},
      {"InvalidTrainingData",
       InvalidTrainingData("class c has 1"),
       {"class c has 1"}},
      {"NumericalFailure",
       NumericalFailure("a weight is infinite"),
       {"a weight is infinite"}},
      {"WorkCancelled", WorkCancelled("the fit"), {"the fit", "cancelled"}},
      {"CheckpointInvalid",
       CheckpointInvalid("hmm/c", "has 3 bytes"),
       {"hmm/c", "has 3 bytes", "train again"}},
      {"IoError", IoError("/a", "no space"), {"/a", "no space"}},
      {"TrialFileInvalid",
       TrialFileInvalid("/a.h5", "no trials"),
       {"/a.h5", "no trials"}},
      {"BundleCorrupt",
       BundleCorrupt("the checksum is 1"),
       {"model bundle", "the checksum is 1", "fit it again"}},
      {"BundleVersion",
       BundleVersion(3, 2),
       {"model bundle", "version 3", "reads versions 1 to 2",
        "fit the model again"}},
      {"ConfigRequired", ConfigRequired(), {"first message", "send config"}},
      {"ConfigRepeated",
       ConfigRepeated(),
       {"config", "second time", "open a new stream"}},
      {"EmptyRequest",
       EmptyRequest(),
       {"request", "empty", "must hold config, frames or end_of_trial"}},
      {"MalformedRequest",
       MalformedRequest(7),
       {"request", "7 bytes", "proto/tactus/v1"}},
      {"NotTheRequest",
       NotTheRequest("tactus.v1.TrainSpec", "it has a field 99"),
       {"tactus.v1.TrainSpec", "a field 99", "a newer server"}},
      {"StreamFinished",
       StreamFinished(),
       {"the stream", "has ended", "open a new one"}},
      {"UnknownLayout",
       UnknownLayout("x", "a, b"),
       {"layout \"x\"", "a, b", "describe it in full"}},
      {"MessageTooLarge",
       MessageTooLarge(9, 8),
       {"message has 9", "at most 8", "send fewer frames"}},
      {"FrameCountOutOfRange",
       FrameCountOutOfRange(9, 8),
       {"frame_count is 9", "must be 1 to 8"}},
      {"FrameSizeMismatch",
       FrameSizeMismatch(5, "taxels", 9, 8),
       {"taxels", "sequence 5", "has size 9", "must be 8"}},
      {"NonFiniteTaxel",
       NonFiniteTaxel(5, 3),
       {"taxel 3 of frame 5", "not finite", "mask dead taxels"}},
      {"NegativeTaxel",
       NegativeTaxel(5, 3, -2),
       {"taxel 3 of frame 5", "is -2", "must be at least 0"}},
      {"TaxelTooLarge",
       TaxelTooLarge(5, 3, 1e13),
       {"taxel 3 of frame 5", "is 1e+13", "must be at most 1e12"}},
      {"InvalidPose",
       InvalidPose(5, "x is nan; it must be finite"),
       {"pose of frame 5", "x is nan", "must be finite"}},
      {"SequenceRegression",
       SequenceRegression(3, 4),
       {"first_sequence is 3", "must be above 4"}},
      {"TimeRegression",
       TimeRegression(5, 3, 4),
       {"capture time of frame 5", "is 3 ns", "must be above 4 ns"}},
      {"InvalidSparseIndex",
       InvalidSparseIndex(5, 400, "below 384"),
       {"sparse index 400", "frame 5", "must be below 384"}},
      {"GeometryMismatch",
       GeometryMismatch("a 1x2", "b 3x4"),
       {"skin is a 1x2", "must be", "b 3x4"}},
      {"ModelNotFound",
       ModelNotFound("pda", {"models/pad", "models/arm"}),
       {"model \"pda\"", "there is models/pad, models/arm"}},
      {"ModelNotFound",
       ModelNotFound("pda"),
       {"model \"pda\"", "trainctl train"}},
      {"StreamLimit",
       StreamLimit("streams", 4),
       {"4 streams", "its limit", "end one"}},
      {"PeerStreamLimit",
       PeerStreamLimit("streams", "10.0.0.1", 4),
       {"4 streams", "10.0.0.1", "end one"}},
      {"Draining", Draining(), {"the server", "shutting down", "another"}},
      {"StreamIdle", StreamIdle(500), {"nothing arrived", "500 ms", "send"}},
      {"NoFirstMessage",
       NoFirstMessage(500),
       {"no config", "500 ms", "send config"}},
      {"NoDataDirectory",
       NoDataDirectory(),
       {"keeps no data", "--data-dir=FOLDER"}},
      {"NoContactLog",
       NoContactLog(),
       {"keeps no contacts", "--keep-contacts=SIZE"}},
      {"CatalogUnavailable",
       CatalogUnavailable("postgresql://db/tactus", "connection refused"),
       {"postgresql://db/tactus does not answer: connection refused",
        "try again when the database is there"}},
      {"TakenOver",
       TakenOver("uploads/3", "replicas/2"),
       {"uploads/3: this server was silent for too long",
        "replicas/2 goes on with it; try again"}},
      {"InvalidName",
       InvalidName("A", "a-z"),
       {"name is \"A\"", "must be a-z"}},
      {"NoSuch",
       NoSuch(ERROR_REASON_ALIAS_NOT_FOUND, "alias", "x",
              "trainctl models alias shows those that do"),
       {"alias \"x\"", "does not exist", "trainctl models alias"}},
      {"DatasetExists",
       DatasetExists("datasets/a"),
       {"datasets/a", "exists already", "choose another name"}},
      {"DatasetInUse",
       DatasetInUse("datasets/a", "operations/3"),
       {"datasets/a", "operations/3", "wait"}},
      {"ModelInUse",
       ModelInUse("models/a/versions/1", "aliases/b"),
       {"models/a/versions/1", "aliases/b", "trainctl models promote"}},
      {"UploadBusy",
       UploadBusy("uploads/3"),
       {"uploads/3", "another call", "try again later"}},
      {"OperationActive",
       OperationActive("operations/3"),
       {"operations/3", "has not ended", "trainctl jobs cancel"}},
      {"OffsetMismatch",
       OffsetMismatch(3, 4),
       {"write_offset is 3", "must be 4"}},
      {"ChecksumMismatch",
       ChecksumMismatch("chunk", "a1", "b2"),
       {"chunk", "a1", "must have b2", "send it again"}},
      {"InvalidTrial",
       InvalidTrial("trial a has no frames"),
       {"trial a has no frames"}},
      {"DownloadLimit",
       DownloadLimit(268435456),
       {"268435456 bytes of memory", "wait until one has ended"}},
      {"JobLimit", JobLimit(200), {"200 queued jobs", "trainctl jobs cancel"}},
      {"QuotaExceeded",
       QuotaExceeded("arm-7", "datasets", 5, 5, "delete one"),
       {"datasets", "arm-7", "5", "delete one"}},
      {"JobCrashed", JobCrashed("signal 11"), {"signal 11"}},
      {"EtagMismatch",
       EtagMismatch("aliases/a", "1", "2"),
       {"aliases/a", "\"1\"", "\"2\"", "trainctl models alias"}},
      {"NothingToRollBack",
       NothingToRollBack("aliases/a"),
       {"aliases/a", "no other version", "trainctl models promote"}},
      {"GateNotPassed", GateNotPassed("log-loss is 2"), {"log-loss is 2"}},
      {"DataLost",
       DataLost("/blobs/a", "the file does not exist"),
       {"/blobs/a", "does not exist"}},
      {"StorageFull", StorageFull("/data", "no space"), {"/data", "no space"}},
      {"Unauthenticated", Unauthenticated("no token"), {"no token"}},
      {"PermissionDenied",
       PermissionDenied("TrainModel", "robot", "trainer"),
       {"TrainModel", "has robot", "trainctl tokens create --role=trainer"}},
      {"NotOwner",
       NotOwner("uploads/3", "arm-7"),
       {"uploads/3", "belongs to \"arm-7\"", "call as an admin"}},
      {"InvalidResponse",
       InvalidResponse("class", 7, "below 4"),
       {"class", "is 7", "must be below 4", "same version"}},
      {"NoResponse",
       NoResponse("config", 500),
       {"config", "500 ms", "check that it runs"}},
      {"NotResumed",
       NotResumed(500, Draining()),
       {"500 ms", "shutting down", "open a new stream"}},
      {"BundleChanged",
       BundleChanged("models/a/versions/1", "ab", "cd"),
       {"models/a/versions/1", "ab", "cd", "open a new stream"}},
  };
}

std::string ReadFile(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::filesystem::path Root() { return TACTUS_SOURCE_DIR; }

// The matches of `pattern` in `text`, of its first group if it has one.
std::vector<std::string> Matches(const std::string& text,
                                 const std::string& pattern) {
  const std::regex regex(pattern);
  std::vector<std::string> found;
  for (std::sregex_iterator i(text.begin(), text.end(), regex), end; i != end;
       ++i) {
    found.push_back((*i)[regex.mark_count() > 0 ? 1 : 0]);
  }
  return found;
}

// The real commands of trainctl with their flags, e.g. "trainctl jobs list"
// with {"--json", ...}.
class Commands {
 public:
  Commands() {
    client::AddCommands(app_, [](const client::Command&) {});
    Add(app_, "trainctl");
    for (const std::string& flag :
         Matches(ReadFile(Root() / "server/main.cc"), "\"(--[a-z-]+)\"")) {
      all_flags_.insert(flag);
    }
  }

  // What of `text` no program has; empty if all is known.
  std::string FirstUnknown(const std::string& text) const {
    for (const std::string& mention :
         Matches(text,
                 "trainctl [a-z-]+(?: [a-z-]+)?(?: [a-z]+)?(?: "
                 "--[a-z-]+)*")) {
      std::stringstream words(mention);
      std::string path;
      std::string word;
      words >> path;
      for (bool in_path = true; words >> word;) {
        if (in_path && flags_.contains(path + " " + word)) {
          path += " " + word;
          continue;
        }
        in_path = false;
        if (path == "trainctl") return mention;
        // A group has one of its verbs behind it.
        if (groups_.contains(path)) return mention;
        if (word.substr(0, 2) == "--" && !flags_.at(path).contains(word)) {
          return mention;
        }
      }
    }
    for (const std::string& flag : Matches(text, "(?:^| )(--[a-z-]+)")) {
      if (!all_flags_.contains(flag)) return flag;
    }
    return "";
  }

 private:
  void Add(const CLI::App& command, const std::string& path) {
    std::set<std::string>& flags = flags_[path];
    for (const CLI::Option* option : command.get_options({})) {
      for (const std::string& name : option->get_lnames()) {
        flags.insert("--" + name);
        all_flags_.insert("--" + name);
      }
    }
    const auto children = command.get_subcommands({});
    if (!children.empty()) groups_.insert(path);
    for (const CLI::App* child : children) {
      Add(*child, path + " " + child->get_name());
    }
  }

  CLI::App app_;
  std::map<std::string, std::set<std::string>> flags_;
  std::set<std::string> groups_;
  std::set<std::string> all_flags_;
};

TEST(ErrorTextsTest, NameTheThingItsValueAndWhatWouldBeRight) {
  for (const Row& row : AllRows()) {
    for (const char* part : row.has) {
      EXPECT_THAT(std::string(row.status.message()), HasSubstr(part))
          << row.function;
    }
  }
}

TEST(ErrorTextsTest, TheTableHasEveryFunction) {
  std::set<std::string> listed;
  for (const Row& row : AllRows()) listed.insert(row.function);
  std::set<std::string> declared;
  for (const std::string& name :
       Matches(ReadFile(Root() / "core/base/errors.h"),
               "absl::Status ([A-Z][A-Za-z]+)\\(")) {
    declared.insert(name);
  }
  EXPECT_GT(declared.size(), 50u);
  EXPECT_EQ(listed, declared);
}

TEST(ErrorTextsTest, AdviceNamesCommandsAndFlagsThatExist) {
  const Commands commands;
  for (const Row& row : AllRows()) {
    EXPECT_EQ(commands.FirstUnknown(std::string(row.status.message())), "")
        << row.status.message();
  }
  // The check itself can fail.
  EXPECT_NE(commands.FirstUnknown("look with trainctl jobs lisst"), "");
  EXPECT_NE(commands.FirstUnknown("use trainctl evalute"), "");
  EXPECT_NE(commands.FirstUnknown("use --no-such-flag"), "");
  EXPECT_NE(commands.FirstUnknown("trainctl jobs cancel --force"), "");
}

// Advice is also given where errors are made from parts.
TEST(ErrorTextsTest, TextsOfTheSourcesNameCommandsThatExist) {
  const Commands commands;
  int files = 0;
  for (const char* room : {"core", "server", "client"}) {
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(Root() / room)) {
      if (entry.path().extension() != ".cc") continue;
      ++files;
      // Literals that follow each other are one text.
      const std::string text = std::regex_replace(
          ReadFile(entry.path()), std::regex("\"\\s*\n\\s*\""), "");
      for (const std::string& literal : Matches(text, "\"([^\"\n]*)\"")) {
        for (const std::string& mention :
             Matches(literal, "(?:with|use|of|than) (trainctl [^.;,:)]*)")) {
          EXPECT_EQ(commands.FirstUnknown(mention), "")
              << entry.path() << ": " << literal;
        }
      }
    }
  }
  EXPECT_GT(files, 200);
}

}  // namespace
}  // namespace tactus::internal
