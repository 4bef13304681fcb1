// Client and its streams against servers.
#include "client/front/remote_stream.h"

#include "absl/strings/str_cat.h"
#include "client/front/answer_convert.h"
#include "client/front/skin_convert.h"
#include "client/stream/frame_encoder.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tactus/client.h"
#include "tests/client/front/front_frames.h"
#include "tests/client/stream/restarted_server.h"
#include "tests/server/support/test_server.h"

namespace tactus::internal::client {
namespace {

using std::chrono::milliseconds;
using testing::AllOf;
using testing::CodyFrame;
using testing::CodySkin;
using testing::Counts;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::PollAll;
using testing::Record;
using testing::TestServer;
using testing::Touch;
using testing::Untouched;

constexpr char kModel[] = "models/no-poses";

// A server on a socket.
class ListeningServer {
 public:
  ListeningServer() : server_(TestServer::OnLoopback(1'000)) {}
  std::string address() {
    return absl::StrCat("127.0.0.1:", server_.server().ports()[0]);
  }
  TestServer& server() { return server_; }

 private:
  TestServer server_;
};

void PushAll(Stream& stream, const std::vector<Counts>& frames,
             uint64_t first = 1) {
  for (size_t i = 0; i < frames.size(); ++i) {
    const absl::Status status = stream.Push(CodyFrame(first + i, frames[i]));
    ASSERT_TRUE(status.ok()) << status;
  }
}

TEST(ClientTest, AFrameGoesInAndNamesComeOut) {
  ListeningServer server;
  const Client client(server.address());
  Record record;
  auto stream = client.Open(CodySkin(), record.Options());
  ASSERT_TRUE(stream.ok()) << stream.status();
  EXPECT_THAT((*stream)->info().classes, ElementsAre("HU", "HM", "SU", "SM"));
  EXPECT_EQ((*stream)->info().rows * (*stream)->info().columns, 384);
  PushAll(**stream, {Untouched(), Touch(1), Touch(2)});
  const auto answer = (*stream)->EndTrial();
  ASSERT_TRUE(answer.ok()) << answer.status();
  EXPECT_TRUE(answer->is_final);
  ASSERT_EQ(answer->contacts.size(), 1u);
  const Contact& contact = answer->contacts[0];
  EXPECT_NEAR(contact.Probability("hardness", "hard") +
                  contact.Probability("hardness", "soft"),
              1, 1e-12);
  EXPECT_EQ((*stream)->statistics().frames, 3u);
  EXPECT_TRUE((*stream)->Close().ok());
  EXPECT_TRUE((*stream)->ended());
  EXPECT_EQ(ReasonOf((*stream)->Push(CodyFrame(9, Touch(1)))),
            "STREAM_FINISHED");
  ASSERT_FALSE(record.answers().empty());
  EXPECT_EQ(AllOf(record.answers().back()), AllOf(*answer));
}

// The stream without names, on the same frames.
TEST(ClientTest, NumbersAreThoseOfTheMessages) {
  ListeningServer server;
  Record record;
  const Client client(server.address());
  auto stream = *client.Open(CodySkin(), record.Options());
  std::vector<v1::Answer> messages;
  const SkinInfo info = *ToSkinInfo(CodySkin());
  auto inner = *ContactStream::Open(MakeChannel(server.address()),
                                    MakeConfig(info), [&](const auto& r) {
                                      if (r.has_answer())
                                        messages.push_back(r.answer());
                                    });
  const std::vector<Counts> frames = testing::Contact(60, 3);
  for (size_t i = 0; i < frames.size(); ++i) {
    ASSERT_TRUE(stream->Push(CodyFrame(i + 1, frames[i])).ok());
    ASSERT_TRUE(inner->Send(testing::DenseU16(i + 1, {frames[i]})).ok());
  }
  const Answer final_answer = *stream->EndTrial();
  const v1::Answer message = *inner->EndTrial();
  Answer named;
  const AnswerConverter converter(inner->started());
  converter.Convert(message, named);
  EXPECT_EQ(AllOf(final_answer), AllOf(named));
  EXPECT_TRUE(stream->Close().ok());
  EXPECT_TRUE(inner->Close().ok());
}

TEST(ClientTest, EventsComeByCallbackOrWaitToBePolled) {
  ListeningServer server;
  const Client client(server.address());
  Record called;
  Record polled;
  auto with_callback = *client.Open(CodySkin(), called.OptionsWithEvents());
  auto with_queue = *client.Open(CodySkin(), polled.Options());
  for (Stream* stream : {with_callback.get(), with_queue.get()}) {
    PushAll(*stream, {Untouched(), Touch(1), Touch(2), Touch(2)});
    ASSERT_TRUE(stream->EndTrial().ok());
  }
  const std::vector<std::string> events = called.events();
  ASSERT_GE(events.size(), 2u);
  EXPECT_EQ(events.front(), "0 ms: contact 1 touched");
  EXPECT_EQ(events.back(), "20 ms: contact 1 released");
  EXPECT_EQ(PollAll(*with_queue), events);
  EXPECT_TRUE(PollAll(*with_queue).empty());
  EXPECT_TRUE(PollAll(*with_callback).empty());
}

TEST(ClientTest, SeveralSkinsShareOneConnection) {
  server::TactusServer::Options options = TestServer::OnLoopback(1'000);
  // A second connection would be refused.
  options.max_connections = 1;
  TestServer server(options);
  const Client client(absl::StrCat("127.0.0.1:", server.server().ports()[0]));
  std::vector<std::unique_ptr<Stream>> streams;
  for (int i = 0; i < 3; ++i) {
    auto stream = client.Open(CodySkin());
    ASSERT_TRUE(stream.ok()) << stream.status();
    streams.push_back(*std::move(stream));
  }
  for (int i = 0; i < 3; ++i) {
    PushAll(*streams[i], {Untouched(), Touch(1.0 + i)});
  }
  for (int i = 0; i < 3; ++i) {
    const auto answer = streams[i]->EndTrial();
    ASSERT_TRUE(answer.ok()) << answer.status();
    EXPECT_EQ(answer->main()->patch->max_force, 1.0 + i);
  }
}

TEST(ClientTest, AWrongFrameLeavesTheStreamAsItWas) {
  ListeningServer server;
  auto stream = *Client(server.address()).Open(CodySkin());
  PushAll(*stream, {Untouched(), Touch(1)});
  Frame frame = CodyFrame(3, Touch(1));
  frame.values.pop_back();
  EXPECT_EQ(ReasonOf(stream->Push(frame)), "INVALID_CONFIG");
  PushAll(*stream, {Touch(1)}, 3);
  const auto answer = stream->EndTrial();
  ASSERT_TRUE(answer.ok()) << answer.status();
  EXPECT_EQ(answer->sequence, 3u);
}

TEST(ClientTest, ErrorsAreTheServersOwn) {
  ListeningServer server;
  const Client client(server.address());
  EXPECT_EQ(ReasonOf(client.Open(CodySkin(), {.model = "none"}).status()),
            "MODEL_NOT_FOUND");
  EXPECT_EQ(ReasonOf(client.Open({.name = "none"}).status()), "UNKNOWN_LAYOUT");
  EXPECT_EQ(
      ReasonOf(client.Open(CodySkin(), {.frames_per_message = 65}).status()),
      "INVALID_CONFIG");
  EXPECT_EQ(ReasonOf(client.Open(CodySkin(), {.interval_frames = 0}).status()),
            "INVALID_CONFIG");
  const Client without_roots(server.address(), {.tls_ca = "/none.crt"});
  EXPECT_EQ(ReasonOf(without_roots.Open(CodySkin()).status()), "IO");
  for (const milliseconds resume_for : {milliseconds(0), milliseconds(100)}) {
    const Client nobody("127.0.0.1:1", {.resume_for = resume_for});
    EXPECT_EQ(nobody.Open(CodySkin()).status().code(),
              absl::StatusCode::kUnavailable);
  }
}

TEST(ClientTest, FramesMayTravelTogether) {
  ListeningServer server;
  const Client client(server.address());
  const std::vector<Counts> frames = testing::Contact(200, 5);
  std::vector<std::string> finals;
  for (const TaxelEncoding encoding :
       {TaxelEncoding::kUint16, TaxelEncoding::kFloat32}) {
    for (const int together : {1, 7, 64}) {
      Skin skin = CodySkin();
      skin.encoding = encoding;
      auto stream = *client.Open(skin, {.frames_per_message = together});
      PushAll(*stream, frames);
      // A gap ends a message.
      Frame late = CodyFrame(203, Touch(1));
      late.missing_before = 2;
      ASSERT_TRUE(stream->Push(late).ok());
      const auto answer = stream->EndTrial();
      ASSERT_TRUE(answer.ok()) << answer.status();
      EXPECT_EQ(answer->sequence, 203u);
      EXPECT_EQ(answer->frames_missing, 2u);
      finals.push_back(AllOf(*answer));
    }
  }
  for (const std::string& answer : finals) EXPECT_EQ(answer, finals[0]);
}

TEST(ClientTest, AStreamIsResumedUnlessThatIsNotWanted) {
  testing::RestartedServer server;
  const std::vector<Counts> frames = testing::Contact(60, 7);
  const auto play = [&](milliseconds resume_for, bool restart) {
    const Client client(server.address(), {.resume_for = resume_for});
    auto stream = *client.Open(CodySkin(), {.model = kModel});
    for (size_t i = 0; i < frames.size(); ++i) {
      if (restart && i == 30) server.Restart();
      const absl::Status status = stream->Push(CodyFrame(i + 1, frames[i]));
      if (!status.ok()) return status.ToString();
    }
    const auto answer = stream->EndTrial();
    if (!answer.ok()) return answer.status().ToString();
    EXPECT_EQ(stream->statistics().resumed, restart ? 1u : 0u);
    std::string all = AllOf(*answer);
    for (const std::string& event : PollAll(*stream)) all += event + "\n";
    return all;
  };
  const std::string unbroken = play(milliseconds(0), false);
  EXPECT_THAT(unbroken, HasSubstr("touched"));
  EXPECT_EQ(play(milliseconds(30'000), false), unbroken);
  EXPECT_EQ(play(milliseconds(30'000), true), unbroken);
  EXPECT_THAT(play(milliseconds(0), true), HasSubstr("UNAVAILABLE"));
}

TEST(ClientTest, NoticesHaveAText) {
  ListeningServer server;
  std::mutex mutex;
  std::vector<std::string> texts;
  auto stream = *Client(server.address())
                     .Open(CodySkin(), {.on_notice = [&](const Notice& notice) {
                             const std::lock_guard lock(mutex);
                             texts.push_back(notice.text);
                           }});
  Frame frame = CodyFrame(1, Untouched());
  for (int i = 0; i < 400; ++i) {
    frame.capture_time_ns += 20'000'000;
    ASSERT_TRUE(stream->Push(frame).ok());
  }
  ASSERT_TRUE(stream->EndTrial().ok());
  const std::lock_guard lock(mutex);
  ASSERT_EQ(texts.size(), 1u);
  EXPECT_THAT(texts[0], HasSubstr("50 Hz"));
}

}  // namespace
}  // namespace tactus::internal::client
