// A robot of Fast DDS for the tests of tactus-ros2: publishes the frames of a
// file at a rate and writes what it hears as lines of text. Its types are made
// by fastddsgen from ros2_types.idl. It shares no code with Tactus.
//
//   fastdds_peer domain=7 topic=/touch name=/tactus type=u16 reliable=1
//     frames=frames.bin rows=16 columns=24 rate=100 count=1000 linger=2
//     heard=heard.txt [joints=/joint_states]
//
// `frames` are numbers of the type, a frame after the other. With `joints` a
// joint "elbow" has the value i / 1000 at image i. The lines:
//   contacts FRAME STAMP_NS ARRIVED_NS FINAL MISSING [id state force
//     classes... object] per contact, probabilities as hexadecimal floats
//   event FRAME STAMP_NS KIND CONTACT QUESTION VALUE
//   markers COUNT FRAME_ID TEXT
//   diagnostics LEVEL NAME; MESSAGE
//   sent NUMBER NOW_NS
// It sends nothing before tactus-ros2 has said in its diagnostics that it knows
// of this subscriber, because neither side sends again what was sent before.
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <time.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "ros2_typesPubSubTypes.h"

namespace {

using namespace eprosima::fastdds::dds;
using eprosima::fastrtps::rtps::Locator_t;
using eprosima::fastrtps::rtps::Time_t;
using eprosima::fastrtps::rtps::WriteParams;

using Settings = std::map<std::string, std::string>;

int64_t NowNs() {
  timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  return int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

template <typename Stamp>
long long Ns(const Stamp& stamp) {
  return 1'000'000'000LL * stamp.sec() + stamp.nanosec();
}

// A file that several threads write whole lines to.
class Heard {
 public:
  explicit Heard(const std::string& path)
      : file_(std::fopen(path.c_str(), "w")) {}
  ~Heard() { std::fclose(file_); }
  void Line(const std::string& line) {
    const std::lock_guard lock(mutex_);
    std::fprintf(file_, "%s\n", line.c_str());
    std::fflush(file_);
  }

 private:
  std::mutex mutex_;
  std::FILE* const file_;
};

template <typename... Values>
std::string Text(const char* format, Values... values) {
  char text[400];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

template <typename Message>
class Listener : public DataReaderListener {
 public:
  explicit Listener(std::function<void(Message&)> hear)
      : hear_(std::move(hear)) {}
  void on_data_available(DataReader* reader) override {
    Message message;
    SampleInfo info;
    while (reader->take_next_sample(&message, &info) ==
           ReturnCode_t::RETCODE_OK) {
      if (info.valid_data) hear_(message);
    }
  }
  void on_subscription_matched(
      DataReader*, const SubscriptionMatchedStatus& status) override {
    matched = status.current_count;
  }

  std::atomic<int> matched = 0;

 private:
  const std::function<void(Message&)> hear_;
};

class Robot {
 public:
  explicit Robot(const Settings& settings) {
    DomainParticipantQos qos;
    qos.transport().use_builtin_transports = false;
    const auto transport =
        std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    transport->interfaceWhiteList.push_back("127.0.0.1");
    transport->sendBufferSize = 1 << 20;
    transport->receiveBufferSize = 1 << 20;
    qos.transport().user_transports.push_back(transport);
    const int domain = std::stoi(settings.at("domain"));
    // The first participants of a domain on this host.
    for (int i = 0; i < 4; ++i) {
      Locator_t locator;
      locator.kind = LOCATOR_KIND_UDPv4;
      locator.port = 7400 + 250 * domain + 10 + 2 * i;
      eprosima::fastrtps::rtps::IPLocator::setIPv4(locator, "127.0.0.1");
      qos.wire_protocol().builtin.initialPeersList.push_back(locator);
    }
    participant_ = DomainParticipantFactory::get_instance()->create_participant(
        domain, qos);
    publisher_ = participant_->create_publisher(PUBLISHER_QOS_DEFAULT);
    subscriber_ = participant_->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
  }
  ~Robot() {
    participant_->delete_contained_entities();
    DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }

  template <typename Type>
  Topic* MakeTopic(const std::string& name) {
    const TypeSupport type(new Type());
    type.register_type(participant_);
    return participant_->create_topic("rt" + name, type.get_type_name(),
                                      TOPIC_QOS_DEFAULT);
  }

  template <typename Type>
  DataWriter* Advertise(const std::string& name, bool reliable) {
    DataWriterQos qos;
    qos.reliability().kind =
        reliable ? RELIABLE_RELIABILITY_QOS : BEST_EFFORT_RELIABILITY_QOS;
    qos.history().kind = KEEP_LAST_HISTORY_QOS;
    qos.history().depth = 1000;
    qos.endpoint().history_memory_policy =
        eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    return publisher_->create_datawriter(MakeTopic<Type>(name), qos);
  }

  template <typename Type>
  void Subscribe(const std::string& name,
                 Listener<typename Type::type>* listener) {
    DataReaderQos qos;
    qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
    qos.history().kind = KEEP_LAST_HISTORY_QOS;
    qos.history().depth = 5000;
    qos.endpoint().history_memory_policy =
        eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    subscriber_->create_datareader(MakeTopic<Type>(name), qos, listener);
  }

 private:
  DomainParticipant* participant_;
  Publisher* publisher_;
  Subscriber* subscriber_;
};

void WaitForSubscriber(DataWriter* writer) {
  if (writer == nullptr) return;
  PublicationMatchedStatus status;
  for (int i = 0; i < 2'000; ++i) {
    writer->get_publication_matched_status(status);
    if (status.current_count > 0) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  std::fprintf(stderr, "nobody subscribes\n");
}

// Publishes `count` frames, each made by `write` of its number and its time.
void PublishAll(DataWriter* writer, const Settings& settings, Heard& heard,
                const std::function<void(int, WriteParams&)>& write) {
  WaitForSubscriber(writer);
  const int count = std::stoi(settings.at("count"));
  const auto period =
      std::chrono::nanoseconds(1'000'000'000 / std::stoi(settings.at("rate")));
  auto next = std::chrono::steady_clock::now();
  for (int i = 0; i < count; ++i, next += period) {
    std::this_thread::sleep_until(next);
    const int64_t now_ns = NowNs();
    WriteParams params;
    // Its constructor takes a binary fraction.
    Time_t stamp;
    stamp.seconds(static_cast<int32_t>(now_ns / 1'000'000'000));
    stamp.nanosec(static_cast<uint32_t>(now_ns % 1'000'000'000));
    params.source_timestamp() = stamp;
    write(i, params);
    heard.Line(Text("sent %d %lld", i, static_cast<long long>(now_ns)));
  }
}

template <typename Number>
std::vector<Number> ReadNumbers(const Settings& settings) {
  std::ifstream in(settings.at("frames"), std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(in), {});
  std::vector<Number> numbers(bytes.size() / sizeof(Number));
  std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(Number));
  return numbers;
}

template <typename Type, typename Number>
void PublishArrays(Robot& robot, const Settings& settings, Heard& heard) {
  DataWriter* const writer = robot.Advertise<Type>(
      settings.at("topic"), settings.at("reliable") == "1");
  const std::vector<Number> numbers = ReadNumbers<Number>(settings);
  const unsigned rows = std::stoul(settings.at("rows"));
  const unsigned columns = std::stoul(settings.at("columns"));
  const unsigned size = rows * columns;
  PublishAll(writer, settings, heard, [&](int i, WriteParams& params) {
    typename Type::type message;
    message.layout().dim().resize(2);
    message.layout().dim()[0].label("rows");
    message.layout().dim()[0].size(rows);
    message.layout().dim()[0].stride(size);
    message.layout().dim()[1].label("columns");
    message.layout().dim()[1].size(columns);
    message.layout().dim()[1].stride(columns);
    const auto at = numbers.begin() + i % (numbers.size() / size) * size;
    message.data().assign(at, at + size);
    writer->write(&message, params);
  });
}

template <typename Number>
void PublishImages(Robot& robot, const Settings& settings, Heard& heard,
                   const char* encoding) {
  using Type = sensor_msgs::msg::dds_::Image_PubSubType;
  DataWriter* const writer = robot.Advertise<Type>(
      settings.at("topic"), settings.at("reliable") == "1");
  const std::vector<Number> numbers = ReadNumbers<Number>(settings);
  const unsigned rows = std::stoul(settings.at("rows"));
  const unsigned columns = std::stoul(settings.at("columns"));
  const unsigned size = rows * columns;
  // The first frame's; those of others follow from the rate of the skin.
  const int64_t first_ns = 1'700'000'000'000'000'000;
  DataWriter* const joints =
      settings.count("joints") == 0
          ? nullptr
          : robot.Advertise<sensor_msgs::msg::dds_::JointState_PubSubType>(
                settings.at("joints"), true);
  WaitForSubscriber(joints);
  PublishAll(writer, settings, heard, [&](int i, WriteParams& params) {
    sensor_msgs::msg::dds_::Image_ message;
    const int64_t time_ns = first_ns + int64_t{i} * 10'000'000;
    if (joints != nullptr) {
      sensor_msgs::msg::dds_::JointState_ state;
      state.header().stamp().sec(time_ns / 1'000'000'000);
      state.header().stamp().nanosec(time_ns % 1'000'000'000);
      state.name({"finger", "elbow"});
      state.position({0.5, i / 1000.0});
      joints->write(&state);
    }
    message.header().stamp().sec(time_ns / 1'000'000'000);
    message.header().stamp().nanosec(time_ns % 1'000'000'000);
    message.header().frame_id("skin");
    message.height(rows);
    message.width(columns);
    message.encoding(encoding);
    message.step(columns * sizeof(Number));
    message.data().resize(size * sizeof(Number));
    std::memcpy(message.data().data(),
                numbers.data() + i % (numbers.size() / size) * size,
                size * sizeof(Number));
    writer->write(&message, params);
  });
}

std::string ContactText(const tactus_msgs::msg::dds_::Contact_& contact) {
  std::string text =
      Text(" [%llu %d %a %a %a", static_cast<unsigned long long>(contact.id()),
           contact.state(), contact.force(), contact.centroid().x(),
           contact.unknown());
  for (const auto& named : contact.classes()) {
    text += " " + named.name() + Text("=%a", named.probability());
  }
  for (const auto& question : contact.answers()) {
    text += " " + question.question() + ":" + question.decided();
    for (const auto& named : question.values()) {
      text += Text(" %a", named.probability());
    }
  }
  if (contact.has_object()) {
    text += Text(" object %a %a", contact.log10_stiffness(),
                 contact.moved_deviation_m());
  }
  if (contact.has_world()) text += Text(" at %a", contact.world().x());
  return text + "]";
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  for (int i = 1; i < argc; ++i) {
    const std::string setting = argv[i];
    const size_t equals = setting.find('=');
    settings[setting.substr(0, equals)] = setting.substr(equals + 1);
  }
  Heard heard(settings.at("heard"));
  Robot robot(settings);
  using tactus_msgs::msg::dds_::ContactEvent_;
  using tactus_msgs::msg::dds_::Contacts_;
  Listener<Contacts_> contacts([&](Contacts_& message) {
    const long long now_ns = NowNs();
    std::string line =
        Text("contacts %llu %lld %lld %d %llu",
             static_cast<unsigned long long>(message.frame()),
             Ns(message.header().stamp()), now_ns, message.is_final() ? 1 : 0,
             static_cast<unsigned long long>(message.frames_missing()));
    for (const auto& contact : message.contacts()) {
      line += ContactText(contact);
    }
    heard.Line(line);
  });
  Listener<ContactEvent_> events([&](ContactEvent_& message) {
    heard.Line(Text("event %llu %lld %d %llu %s %s",
                    static_cast<unsigned long long>(message.frame()),
                    Ns(message.header().stamp()), message.kind(),
                    static_cast<unsigned long long>(message.contact()),
                    message.question().c_str(), message.value().c_str()));
  });
  using visualization_msgs::msg::dds_::MarkerArray_;
  Listener<MarkerArray_> markers([&](MarkerArray_& message) {
    if (message.markers().empty()) return;
    const auto& last = message.markers().back();
    heard.Line(Text("markers %zu %s %s", message.markers().size(),
                    last.header().frame_id().c_str(), last.text().c_str()));
  });
  using diagnostic_msgs::msg::dds_::DiagnosticArray_;
  std::atomic<bool> is_known = false;
  Listener<DiagnosticArray_> diagnostics([&](DiagnosticArray_& message) {
    for (const auto& status : message.status()) {
      for (const auto& value : status.values()) {
        if (value.key() == "subscribers of contacts" && value.value() != "0") {
          is_known = true;
        }
      }
      heard.Line(Text("diagnostics %d %s; %s", status.level(),
                      status.name().c_str(), status.message().c_str()));
    }
  });
  const std::string name = settings.at("name");
  robot.Subscribe<tactus_msgs::msg::dds_::Contacts_PubSubType>(
      name + "/contacts", &contacts);
  robot.Subscribe<tactus_msgs::msg::dds_::ContactEvent_PubSubType>(
      name + "/events", &events);
  robot.Subscribe<visualization_msgs::msg::dds_::MarkerArray_PubSubType>(
      name + "/markers", &markers);
  robot.Subscribe<diagnostic_msgs::msg::dds_::DiagnosticArray_PubSubType>(
      "/diagnostics", &diagnostics);
  for (int i = 0; i < 2'000 && (!is_known || contacts.matched == 0 ||
                                events.matched == 0 || markers.matched == 0);
       ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  const std::string type = settings.at("type");
  using namespace std_msgs::msg::dds_;
  if (type == "u16") {
    PublishArrays<UInt16MultiArray_PubSubType, uint16_t>(robot, settings,
                                                         heard);
  } else if (type == "i16") {
    PublishArrays<Int16MultiArray_PubSubType, int16_t>(robot, settings, heard);
  } else if (type == "f32") {
    PublishArrays<Float32MultiArray_PubSubType, float>(robot, settings, heard);
  } else if (type == "mono8") {
    PublishImages<uint8_t>(robot, settings, heard, "mono8");
  } else if (type == "mono16") {
    PublishImages<uint16_t>(robot, settings, heard, "mono16");
  } else if (type == "32FC1") {
    PublishImages<float>(robot, settings, heard, "32FC1");
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(
      static_cast<int>(1e3 * std::stod(settings.at("linger")))));
  return 0;
}
