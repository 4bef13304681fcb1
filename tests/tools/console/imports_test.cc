// What people send to be imported, and what strangers send instead. trainctl is
// a script here, which says what it was asked; import_test.mjs runs the real
// one.
#include "tools/console/imports.h"

#include <filesystem>

#include "core/base/sha256.h"
#include "gmock/gmock.h"
#include "grpcpp/server.h"
#include "grpcpp/server_builder.h"
#include "tactus/v1/monitor.grpc.pb.h"
#include "tactus/v1/training.grpc.pb.h"
#include "tests/support/process_ended.h"
#include "tests/tools/console/console_fixture.h"
#include "tools/common/json.h"

namespace tactus::internal::console {
namespace {

namespace fs = std::filesystem;
using client::Json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

// Lets everybody watch, and everybody but "viewer" have datasets.
class DatasetServer : private v1::MonitorService::Service,
                      private v1::TrainingService::Service {
 public:
  DatasetServer() {
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(),
                             &port_);
    builder.RegisterService(static_cast<v1::MonitorService::Service*>(this));
    builder.RegisterService(static_cast<v1::TrainingService::Service*>(this));
    server_ = builder.BuildAndStart();
  }
  ~DatasetServer() override {
    server_->Shutdown(std::chrono::system_clock::now());
  }
  std::string address() const { return absl::StrCat("127.0.0.1:", port_); }

 private:
  static std::string TokenOf(const grpc::ServerContext& context) {
    const auto& metadata = context.client_metadata();
    const auto found = metadata.find("authorization");
    return found == metadata.end()
               ? ""
               : std::string(found->second.data(), found->second.size());
  }
  grpc::Status ListStreams(grpc::ServerContext* context,
                           const v1::ListStreamsRequest*,
                           v1::ListStreamsResponse*) override {
    return TokenOf(*context).empty()
               ? grpc::Status(grpc::StatusCode::UNAUTHENTICATED, "no token")
               : grpc::Status::OK;
  }
  grpc::Status ListDatasets(grpc::ServerContext* context,
                            const v1::ListDatasetsRequest*,
                            v1::ListDatasetsResponse*) override {
    return TokenOf(*context) == "Bearer viewer"
               ? grpc::Status(grpc::StatusCode::PERMISSION_DENIED,
                              "this needs the role trainer")
               : grpc::Status::OK;
  }

  int port_ = 0;
  std::unique_ptr<grpc::Server> server_;
};

class ImportsTest : public ConsoleTest {
 protected:
  // `script` is what trainctl does; its second word is "import" or "datasets".
  void Begin(const std::string& script) {
    Script(script);
    fs::create_directory(folder_ / "imports");
    options_.imports.program = folder_ / "trainctl";
    options_.imports.folder = folder_ / "imports";
    StartConsole(datasets_.address());
  }
  void Script(const std::string& script) {
    WriteBytes(folder_ / "trainctl", absl::StrCat("#!/bin/sh\n", script, "\n"));
    fs::permissions(folder_ / "trainctl", fs::perms::owner_all);
  }

  static std::string Step(const std::string& step, const std::string& query) {
    return absl::StrCat("POST /api/import/0/", step, "?", query);
  }
  // The id of a new import of the person whose page it is; empty if there is
  // none.
  std::string IdOf(const std::string& page, const std::string& query = "") {
    return After(Ask(Step("begin", query), page, "{}"), "\"id\":\"", '"');
  }
  std::string Send(const std::string& page, const std::string& id,
                   const std::string& name, const std::string& bytes) {
    return Ask(Step("file", absl::StrCat("id=", id, "&name=", name)), page,
               bytes);
  }
  std::string Check(const std::string& page, const std::string& id,
                    const std::string& options = "{}") {
    return Ask(Step("check", "id=" + id), page, options);
  }
  static Json JsonOf(const std::string& response) {
    EXPECT_THAT(response, StartsWith("HTTP/1.1 200 OK"));
    const size_t body = response.find("\r\n\r\n");
    return Json::parse(response.substr(body), nullptr, false);
  }
  // Folders of imports.
  size_t Folders() const {
    size_t count = 0;
    for (const auto& console : fs::directory_iterator(folder_ / "imports")) {
      count += std::distance(fs::directory_iterator(console), {});
    }
    return count;
  }
  bool NoneIsLeft() const {
    return testing::Eventually([&] { return Folders() == 0; });
  }
  // Waits for the number that a script has written.
  pid_t Process() const {
    EXPECT_TRUE(testing::Eventually(
        [&] { return !ReadBytes(folder_ / "process").empty(); }));
    return std::stoi(ReadBytes(folder_ / "process"));
  }
  // A script that goes on and on.
  std::string Endless() const {
    return absl::StrCat("sleep 1000 & echo $! > ", folder_ / "other", "; mv ",
                        folder_ / "other", " ", folder_ / "process",
                        "; sleep 1000");
  }
  static bool HasEnded(pid_t process) {
    return testing::Eventually([&] { return ProcessEnded(process); });
  }

  const DatasetServer datasets_;
};

TEST_F(ImportsTest, TrainctlReadsTheFilesAndSendsTheTrials) {
  Begin(
      "case $2 in\n"
      "import) echo 'trainctl: the rate is odd' >&2; cp a\\ b.csv "
      "../made/trials.h5\n"
      "  echo \"{\\\"asked\\\": \\\"$*\\\"}\";;\n"
      "*) echo \"{\\\"asked\\\": \\\"$*\\\", \\\"token\\\": \\\"$(cat)\\\",\"\n"
      "  echo \"\\\"trials\\\": \\\"$(cat trials.h5)\\\"}\";;\n"
      "esac");
  const std::string page = PageOf("ann");
  const std::string id = IdOf(page);
  ASSERT_EQ(id.size(), 64u);
  EXPECT_THAT(Send(page, id, "a%20b.csv", "1,2,3"), HasSubstr("\"bytes\":5"));
  EXPECT_THAT(Send(page, id, "skin.json", "{}"), StartsWith("HTTP/1.1 200"));
  // Nothing is sent that was not checked.
  EXPECT_THAT(Ask(Step("finish", "id=" + id), page, R"({"dataset": "arm"})"),
              StartsWith("HTTP/1.1 409"));
  const Json read = JsonOf(Check(
      page, id,
      R"({"source": "a b.csv", "skin": "skin.json", "label": "--out=x"})"));
  EXPECT_EQ(read["accepted"], true);
  EXPECT_THAT(read["remarks"], ElementsAre("the rate is odd"));
  EXPECT_EQ(read["result"]["asked"],
            "--quiet import a b.csv --out=../made/trials.h5 --json "
            "--skin=skin.json --label=--out=x");
  const Json sent =
      JsonOf(Ask(Step("finish", "id=" + id), page,
                 R"({"dataset": "arm", "replace_labels": true})"));
  EXPECT_EQ(sent["result"]["asked"],
            absl::StrCat("--quiet datasets upload arm --data=trials.h5 "
                         "--server=",
                         datasets_.address(),
                         " --json --replace-labels "
                         "--token-file=/proc/self/fd/0"));
  EXPECT_EQ(sent["result"]["token"], "ann");
  EXPECT_EQ(sent["result"]["trials"], "1,2,3");
  EXPECT_TRUE(NoneIsLeft());
  EXPECT_THAT(Check(page, id), StartsWith("HTTP/1.1 409"));
}

TEST_F(ImportsTest, ARefusalKeepsItsWordsAndTheFiles) {
  Begin(
      "if test -e t.csv; then echo '{}'; exit; fi\n"
      "echo 'trainctl: b.npy: a remark\n  of two lines' >&2\n"
      "echo 'trainctl: trials.csv: is not there [IO]' >&2; exit 1");
  const std::string page = PageOf("ann");
  const std::string id = IdOf(page);
  Send(page, id, "b.npy", "x");
  const Json refused = JsonOf(Check(page, id));
  EXPECT_EQ(refused["accepted"], false);
  EXPECT_EQ(refused["error"], "trials.csv: is not there [IO]");
  EXPECT_THAT(refused["remarks"],
              ElementsAre("b.npy: a remark\n  of two lines"));
  // The missing one is added.
  Send(page, id, "t.csv", "x");
  EXPECT_EQ(JsonOf(Check(page, id))["accepted"], true);
  EXPECT_THAT(Ask(Step("end", "id=" + id), page, "{}"),
              StartsWith("HTTP/1.1 204"));
  EXPECT_EQ(Folders(), 0u);
}

TEST_F(ImportsTest, OnlyThePersonsOwnPageMayImport) {
  Begin("echo '{}'");
  const std::string page = PageOf("ann");
  const std::string id = IdOf(page);
  const auto without = [&](const std::string& name) {
    const size_t at = page.find(name);
    const size_t end = page.find("\r\n", at) + 2;
    return page.substr(0, at) + page.substr(end);
  };
  for (const auto& [header, status] :
       {std::pair(without("Origin"), "403"),
        {without("X-CSRF"), "403"},
        {without("Cookie"), "401"},
        {without("Origin") + "Origin: http://evil\r\n", "403"},
        {without("X-CSRF") + "X-CSRF-Token: x\r\n", "403"}}) {
    const std::string want = absl::StrCat("HTTP/1.1 ", status);
    EXPECT_THAT(Ask(Step("begin", ""), header, "{}"), StartsWith(want));
    EXPECT_THAT(Send(header, id, "a", "x"), StartsWith(want));
    EXPECT_THAT(Check(header, id), StartsWith(want));
  }
  // Another person does not know the import, whatever its id.
  const std::string other = PageOf("bob");
  EXPECT_THAT(Send(other, id, "a", "x"), StartsWith("HTTP/1.1 409"));
  EXPECT_THAT(Check(other, id), StartsWith("HTTP/1.1 409"));
  EXPECT_THAT(Ask(Step("end", "id=" + id), other, "{}"),
              StartsWith("HTTP/1.1 409"));
  EXPECT_THAT(Ask("GET /api/import/0/begin", page), StartsWith("HTTP/1.1 405"));
  EXPECT_THAT(Ask("POST /api/import/0/go", page, "{}"),
              StartsWith("HTTP/1.1 404"));
  EXPECT_THAT(Ask("POST /api/import/7/begin?replace=1", page, "{}"),
              StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(Check(page, id), StartsWith("HTTP/1.1 200"));
}

TEST_F(ImportsTest, TheServerDecidesWhoMayImport) {
  Begin("echo '{}'");
  const std::string refused = Ask(Step("begin", ""), PageOf("viewer"), "{}");
  EXPECT_THAT(refused, StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(refused, HasSubstr("this needs the role trainer"));
  EXPECT_TRUE(NoneIsLeft());
}

TEST_F(ImportsTest, BadFilesAndOptionsAreRefused) {
  Begin("echo '{}'");
  const std::string page = PageOf("ann");
  const std::string id = IdOf(page);
  for (const char* name : {"", "..%2Fa", "%2Fetc%2Fa", ".a", "-a", "a%00"}) {
    const std::string response = Send(page, id, name, "x");
    EXPECT_THAT(response, StartsWith("HTTP/1.1 400")) << name;
    EXPECT_THAT(response, HasSubstr("\"reason\":\"INVALID_CONFIG\""));
  }
  const std::string to = Step("file", absl::StrCat("id=", id, "&name=a"));
  EXPECT_THAT(Ask(to, page), StartsWith("HTTP/1.1 411"));
  EXPECT_THAT(Ask(to, page + "Transfer-Encoding: chunked\r\n"),
              StartsWith("HTTP/1.1 411"));
  // Refused before any of it comes.
  const std::string large =
      Ask(to, absl::StrCat(page, "Content-Length: ",
                           limits::kMaxImportFileBytes + 1, "\r\n"));
  EXPECT_THAT(large, StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(large, HasSubstr("at most 268435456"));
  EXPECT_THAT(Ask(to, page + "Content-Length: 18446744073709551615\r\n"),
              StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(Ask(to, page + "Content-Length: -1\r\n"),
              Not(HasSubstr("200 OK")));
  EXPECT_THAT(Send(page, id, "a", "x"), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(Send(page, id, "a", "x"), StartsWith("HTTP/1.1 400"));
  for (const char* options :
       {"[]", "no JSON", R"({"source": "b"})", R"({"skin": "/etc/a"})",
        R"({"colour": "red"})", R"({"label": 3})", R"({"label": "a\nb"})"}) {
    EXPECT_THAT(Check(page, id, options), StartsWith("HTTP/1.1 400"))
        << options;
  }
  EXPECT_THAT(Check(page, id, std::string(20'000, ' ')),
              StartsWith("HTTP/1.1 413"));
  for (const char* dataset : {"", "--help", "a b", "arm@1", "../a", "Arm"}) {
    EXPECT_THAT(Ask(Step("finish", "id=" + id), page,
                    absl::StrCat("{\"dataset\": \"", dataset, "\"}")),
                StartsWith("HTTP/1.1 400"))
        << dataset;
  }
  EXPECT_THAT(Check(page, id), StartsWith("HTTP/1.1 200"));
}

TEST_F(ImportsTest, FilesOfManyPartsComeWhole) {
  Begin(
      "printf '{\"sum\": \"'; sha256sum a/b | cut -c1-64 | tr -d '\\n'; "
      "echo '\"}'");
  const std::string page = PageOf("ann");
  const std::string id = IdOf(page);
  std::string bytes;
  for (int i = 0; bytes.size() < 5 * limits::kImportPartBytes / 2; ++i) {
    absl::StrAppend(&bytes, i, ",");
  }
  EXPECT_THAT(Send(page, id, "a%2Fb", bytes), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(Send(page, id, "empty", ""), StartsWith("HTTP/1.1 411"));
  EXPECT_THAT(Ask(Step("file", absl::StrCat("id=", id, "&name=empty")),
                  page + "Content-Length: 0\r\n"),
              StartsWith("HTTP/1.1 200"));
  EXPECT_EQ(JsonOf(Check(page, id))["result"]["sum"], Sha256Hex(bytes));
}

TEST_F(ImportsTest, ABodyThatStopsHalfWayEndsTheImport) {
  Begin("echo '{}'");
  const std::string page = PageOf("ann");
  const std::string id = IdOf(page);
  {
    const RawConnection browser(console_->port());
    browser.Send(RequestOf(Step("file", absl::StrCat("id=", id, "&name=a")),
                           page + "Content-Length: 5000000\r\n", ""));
    browser.Send(std::string(2'000'000, 'x'));
    EXPECT_TRUE(testing::Eventually([&] { return Folders() == 1; }));
  }
  EXPECT_TRUE(NoneIsLeft());
  EXPECT_THAT(Check(page, id), StartsWith("HTTP/1.1 409"));
}

TEST_F(ImportsTest, ASenderThatStandsStillIsCutOff) {
  options_.imports.part_patience = std::chrono::milliseconds(200);
  Begin("echo '{}'");
  const std::string page = PageOf("ann");
  const std::string id = IdOf(page);
  const RawConnection browser(console_->port());
  browser.Send(RequestOf(Step("file", absl::StrCat("id=", id, "&name=a")),
                         page + "Content-Length: 5000000\r\n", ""));
  browser.Send("some");
  EXPECT_EQ(browser.ReadAll(), "");
  EXPECT_TRUE(NoneIsLeft());
}

TEST_F(ImportsTest, TheProgramEndsWithTheBrowser) {
  Begin(Endless());
  const std::string page = PageOf("ann");
  const std::string id = IdOf(page);
  Send(page, id, "a", "x");
  pid_t process = 0;
  {
    const RawConnection browser(console_->port());
    browser.Send(RequestOf(Step("check", "id=" + id), page, "{}"));
    process = Process();
  }
  EXPECT_TRUE(HasEnded(process));
  EXPECT_TRUE(NoneIsLeft());
}

TEST_F(ImportsTest, AnImportEndsWithTheSignIn) {
  Begin(Endless());
  std::string page = PageOf("ann");
  std::string id = IdOf(page);
  Send(page, id, "a", "x");
  const RawConnection browser(console_->port());
  browser.Send(RequestOf(Step("check", "id=" + id), page, "{}"));
  const pid_t process = Process();
  EXPECT_THAT(Ask("POST /api/sign-out", page, "x"), StartsWith("HTTP/1.1 204"));
  EXPECT_THAT(browser.ReadAll(), StartsWith("HTTP/1.1 401"));
  EXPECT_TRUE(HasEnded(process));
  EXPECT_TRUE(NoneIsLeft());

  // So does one whose file comes, and one that waits for a person.
  page = PageOf("ann");
  id = IdOf(page);
  const RawConnection sender(console_->port());
  sender.Send(RequestOf(Step("file", absl::StrCat("id=", id, "&name=a")),
                        page + "Content-Length: 5000000\r\n", ""));
  EXPECT_TRUE(testing::Eventually([&] { return Folders() == 1; }));
  Ask("POST /api/sign-out", page, "x");
  EXPECT_THAT(sender.ReadAll(), StartsWith("HTTP/1.1 401"));
  EXPECT_TRUE(NoneIsLeft());
  page = PageOf("ann");
  EXPECT_NE(IdOf(page), "");
  Ask("POST /api/sign-out", page, "x");
  EXPECT_TRUE(NoneIsLeft());
}

TEST_F(ImportsTest, AnImportThatIsForgottenEnds) {
  options_.imports.idle_patience = std::chrono::milliseconds(300);
  Begin("echo '{}'");
  const std::string page = PageOf("ann");
  const std::string id = IdOf(page);
  EXPECT_TRUE(NoneIsLeft());
  EXPECT_THAT(Check(page, id), StartsWith("HTTP/1.1 409"));
}

TEST_F(ImportsTest, NobodyImportsTooMuchAtOnce) {
  Begin(Endless());
  const std::string page = PageOf("ann");
  const std::string id = IdOf(page);
  Send(page, id, "a", "x");
  const RawConnection browser(console_->port());
  browser.Send(RequestOf(Step("check", "id=" + id), page, "{}"));
  const pid_t process = Process();
  // No two requests of one import, and no two imports of one person.
  EXPECT_THAT(Check(page, id), StartsWith("HTTP/1.1 409"));
  EXPECT_THAT(Send(page, id, "b", "x"), StartsWith("HTTP/1.1 409"));
  const std::string second = Ask(Step("begin", ""), PageOf("ann"), "{}");
  EXPECT_THAT(second, StartsWith("HTTP/1.1 429"));
  EXPECT_THAT(second, HasSubstr("\"import\":\"own\""));
  EXPECT_NE(IdOf(PageOf("bob")), "");
  const std::string third = Ask(Step("begin", ""), PageOf("eve"), "{}");
  EXPECT_THAT(third, StartsWith("HTTP/1.1 429"));
  EXPECT_THAT(third, Not(HasSubstr("own")));
  // Unless the person gives up the first one.
  const std::string again = IdOf(page, "replace=1");
  EXPECT_NE(again, "");
  EXPECT_TRUE(HasEnded(process));
  EXPECT_THAT(browser.ReadAll(), StartsWith("HTTP/1.1 409"));
  EXPECT_THAT(Check(page, id), StartsWith("HTTP/1.1 409"));
  EXPECT_THAT(Send(page, again, "a", "x"), StartsWith("HTTP/1.1 200"));
  EXPECT_EQ(Folders(), 2u);
}

TEST_F(ImportsTest, WhatEndsTheProgramIsTold) {
  options_.imports.program_patience = std::chrono::milliseconds(1'000);
  Begin("");
  const std::string page = PageOf("ann");
  const std::string id = IdOf(page);
  Send(page, id, "a", "x");
  for (const auto& [script, text] :
       {std::pair("touch ../made/draft; kill -SEGV $$", "ended by SIGSEGV"),
        // What it leaves does not add up.
        {"test -e ../made/draft || echo 'trainctl: clean' >&2; exit 1",
         "clean"},
        {"echo \"what():  std::bad_alloc\" >&2; kill -ABRT $$", "more memory"},
        {"kill -XFSZ $$", "take more than 512 MiB"},
        {"exec sleep 1000", "takes longer than the 1 s"},
        {"exit 5", "trainctl ended with 5"}}) {
    Script(script);
    const Json answer = JsonOf(Check(page, id));
    EXPECT_EQ(answer["accepted"], false);
    EXPECT_THAT(answer["error"].get<std::string>(), HasSubstr(text));
  }
  Script("echo no JSON");
  EXPECT_THAT(Check(page, id), StartsWith("HTTP/1.1 500"));
  fs::remove(folder_ / "trainctl");
  EXPECT_THAT(Check(page, id), StartsWith("HTTP/1.1 503"));
  EXPECT_THAT(Ask(Step("begin", "replace=1"), page, "{}"),
              HasSubstr("is not installed beside the console"));
}

TEST_F(ImportsTest, TheConsoleEndsWithAnImportUnderWay) {
  Begin(Endless());
  const std::string page = PageOf("ann");
  const std::string id = IdOf(page);
  Send(page, id, "a", "x");
  const RawConnection browser(console_->port());
  browser.Send(RequestOf(Step("check", "id=" + id), page, "{}"));
  const std::string other = PageOf("bob");
  const RawConnection sender(console_->port());
  sender.Send(
      RequestOf(Step("file", absl::StrCat("id=", IdOf(other), "&name=a")),
                other + "Content-Length: 5000000\r\n", ""));
  const pid_t process = Process();
  console_.reset();
  EXPECT_TRUE(HasEnded(process));
  EXPECT_TRUE(fs::is_empty(folder_ / "imports"));
}

TEST(ImportProgramTest, TheServersAuthoritiesAreThoseOfTheConsole) {
  const ScratchDir folder;
  const auto files = *ImportFiles::Make(folder / "one");
  WriteBytes(folder / "trainctl",
             "#!/bin/sh\n"
             "case $2 in import) echo '{}'; exit;; esac\n"
             "echo \"[\\\"$*\\\", \\\"$(cat authorities.pem)\\\"]\"\n");
  fs::permissions(folder / "trainctl", fs::perms::owner_all);
  const ImportProgram program = {.path = folder / "trainctl",
                                 .patience = std::chrono::seconds(60)};
  const std::atomic<bool> cancelled = false;
  ASSERT_TRUE(ReadTrials(program, *files, {}, cancelled).ok());
  const ServerAddress server = {.address = "arm.lab:50051",
                                .channel = {.tls_roots = "a certificate"}};
  const auto answer = SendTrials(program, *files, {.dataset = "arm"}, server,
                                 /*token=*/"", cancelled);
  ASSERT_TRUE(answer.ok()) << answer.status();
  EXPECT_THAT((*answer)["result"],
              ElementsAre("--quiet datasets upload arm --data=trials.h5 "
                          "--server=arm.lab:50051 --json "
                          "--tls-ca=authorities.pem",
                          "a certificate"));
}

}  // namespace
}  // namespace tactus::internal::console
