// A DDS participant of eProsima Fast DDS on the loopback interface: does what lines on stdin say, and prints what it hears.
//   sub TOPIC TYPE latched|volatile     → heard TOPIC HEX, for each message
//   pub TOPIC TYPE HEX                  → published TOPIC, once a reader has matched
// and, for each writer and reader that it discovers: writer|reader TOPIC TYPE USER_DATA GUID_HEX
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

#include <condition_variable>
#include <cstring>
#include <iostream>
#include <map>
#include <mutex>
#include <sstream>
#include <vector>

using namespace eprosima::fastdds::dds;
using namespace eprosima::fastrtps::rtps;
using Bytes = std::vector<unsigned char>;

static std::mutex printing;

static std::string hex(const unsigned char* data, size_t size) {
  static const char* digits = "0123456789abcdef";
  std::string text;
  for (size_t i = 0; i < size; ++i) {
    text += digits[data[i] >> 4];
    text += digits[data[i] & 15];
  }
  return text;
}

static void say(const std::string& line) {
  std::lock_guard<std::mutex> lock(printing);
  std::cout << line << std::endl;
}

// A type whose messages are their bytes, as they are on the wire.
class Raw : public TopicDataType {
 public:
  explicit Raw(const std::string& name) {
    setName(name.c_str());
    m_typeSize = 1024;
    m_isGetKeyDefined = false;
  }
  bool serialize(void* data, SerializedPayload_t* payload) override {
    const Bytes& bytes = *static_cast<Bytes*>(data);
    payload->reserve(bytes.size());
    std::memcpy(payload->data, bytes.data(), bytes.size());
    payload->length = bytes.size();
    return true;
  }
  bool deserialize(SerializedPayload_t* payload, void* data) override {
    static_cast<Bytes*>(data)->assign(payload->data, payload->data + payload->length);
    return true;
  }
  std::function<uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data]() { return static_cast<uint32_t>(static_cast<Bytes*>(data)->size()); };
  }
  void* createData() override { return new Bytes(); }
  void deleteData(void* data) override { delete static_cast<Bytes*>(data); }
  bool getKey(void*, InstanceHandle_t*, bool) override { return false; }
};

class Heard : public DataReaderListener {
 public:
  explicit Heard(std::string topic) : topic_(std::move(topic)) {}
  void on_data_available(DataReader* reader) override {
    Bytes bytes;
    SampleInfo info;
    while (reader->take_next_sample(&bytes, &info) == ReturnCode_t::RETCODE_OK)
      if (info.valid_data) say("heard " + topic_ + " " + hex(bytes.data(), bytes.size()));
  }

 private:
  std::string topic_;
};

class Matched : public DataWriterListener {
 public:
  void on_publication_matched(DataWriter*, const PublicationMatchedStatus& status) override {
    std::lock_guard<std::mutex> lock(mutex_);
    count_ = status.current_count;
    changed_.notify_all();
  }
  void wait() {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this]() { return count_ > 0; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int count_ = 0;
};

class Found : public DomainParticipantListener {
 public:
  void on_publisher_discovery(DomainParticipant*, WriterDiscoveryInfo&& found) override {
    if (found.status == WriterDiscoveryInfo::DISCOVERED_WRITER)
      tell("writer", found.info.topicName().to_string(), found.info.typeName().to_string(),
           found.info.m_qos.m_userData.getValue(), found.info.guid());
  }
  void on_subscriber_discovery(DomainParticipant*, ReaderDiscoveryInfo&& found) override {
    if (found.status == ReaderDiscoveryInfo::DISCOVERED_READER)
      tell("reader", found.info.topicName().to_string(), found.info.typeName().to_string(),
           found.info.m_qos.m_userData.getValue(), found.info.guid());
  }

 private:
  static void tell(const char* kind, const std::string& topic, const std::string& type,
                   const std::vector<octet>& data, const GUID_t& guid) {
    unsigned char bytes[16];
    std::memcpy(bytes, guid.guidPrefix.value, 12);
    std::memcpy(bytes + 12, guid.entityId.value, 4);
    const std::string text(data.begin(), data.end());
    say(std::string(kind) + " " + topic + " " + type + " " + (text.empty() ? "-" : text) + " " + hex(bytes, 16));
  }
};

int main(int, char** arguments) {
  DomainParticipantQos qos;
  auto transport = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  transport->interfaceWhiteList.push_back("127.0.0.1");
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(transport);
  Locator_t peer;
  IPLocator::setIPv4(peer, "127.0.0.1");
  peer.port = 0;
  qos.wire_protocol().builtin.initialPeersList.push_back(peer);

  Found found;
  auto* participant = DomainParticipantFactory::get_instance()->create_participant(
      std::stoi(arguments[1]), qos, &found, StatusMask::none());
  auto* publisher = participant->create_publisher(PUBLISHER_QOS_DEFAULT);
  auto* subscriber = participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
  std::map<std::string, Topic*> topics;
  std::map<std::string, DataWriter*> writers;
  std::vector<std::unique_ptr<Heard>> listeners;
  say("ready");

  auto topic_of = [&](const std::string& name, const std::string& type) {
    if (topics.count(name) == 0) {
      TypeSupport(new Raw(type)).register_type(participant);
      topics[name] = participant->create_topic(name, type, TOPIC_QOS_DEFAULT);
    }
    return topics[name];
  };
  std::string line;
  while (std::getline(std::cin, line)) {
    std::istringstream words(line);
    std::string what, name, type, more;
    words >> what >> name >> type >> more;
    if (what == "sub") {
      DataReaderQos reader;
      reader.reliability().kind = RELIABLE_RELIABILITY_QOS;
      reader.durability().kind = more == "latched" ? TRANSIENT_LOCAL_DURABILITY_QOS : VOLATILE_DURABILITY_QOS;
      reader.history().depth = 1000;
      reader.endpoint().history_memory_policy = PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
      listeners.push_back(std::make_unique<Heard>(name));
      subscriber->create_datareader(topic_of(name, type), reader, listeners.back().get());
    } else if (what == "pub") {
      if (writers.count(name) == 0) {
        DataWriterQos writer;
        writer.reliability().kind = RELIABLE_RELIABILITY_QOS;
        writer.durability().kind = TRANSIENT_LOCAL_DURABILITY_QOS;
        writer.endpoint().history_memory_policy = PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
        auto* matched = new Matched();
        writers[name] = publisher->create_datawriter(topic_of(name, type), writer, matched);
        matched->wait();
      }
      Bytes bytes;
      for (size_t i = 0; i + 1 < more.size(); i += 2) bytes.push_back(std::stoi(more.substr(i, 2), nullptr, 16));
      writers[name]->write(&bytes);
      say("published " + name);
    }
  }
  return 0;
}
