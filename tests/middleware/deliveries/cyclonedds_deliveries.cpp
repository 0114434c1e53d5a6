// Races of messages over Cyclone DDS. lost=50: so many of 1,000 packets are lost (the library's own
// XmitLossiness). between=200: so many idle readers are in the wait set between the map's and the
// notice's. look=turn: the two readers are asked one after the other; otherwise the list counts
// that the wait set hands out.
#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "dds_entity.hpp"
#include "delivery_race.hpp"

extern "C" {
#include "delivery.h"
}

namespace maide::deliveries {
namespace {

using cyclonedds::checked;
using cyclonedds::Entity;
using cyclonedds::Qos;

std::string configuration(const Settings& settings) {
  const std::uint32_t id = settings.number("id", 0);
  return fmt::format(
      "<General><AllowMulticast>false</AllowMulticast>"
      "<Interfaces><NetworkInterface address='127.0.0.1'/></Interfaces></General>"
      "<Discovery><ExternalDomainId>{}</ExternalDomainId><Tag>maide-{}</Tag>"
      "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>31"
      "</MaxAutoParticipantIndex><Peers><Peer Address='127.0.0.1'/></Peers></Discovery>"
      "<Internal><Test><XmitLossiness>{}</XmitLossiness></Test></Internal>",
      1 + id % 200, id, settings.number("lost", 0));
}

Qos make_qos(const Settings& settings) {
  Qos qos(dds_create_qos());
  dds_qset_reliability(
      qos.get(), settings.is_reliable() ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
      DDS_SECS(10));
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, 10);
  return qos;
}

Entity make_topic(dds_entity_t participant, const std::string& name) {
  return {
      dds_create_topic(participant, &maide_deliveries_Message_desc, name.c_str(), nullptr, nullptr),
      "dds_create_topic"};
}
Entity make_topic(dds_entity_t participant, Topic topic) {
  return make_topic(participant, topic == Topic::map ? "map" : "notice");
}

class CycloneWriter : public Writer {
 public:
  CycloneWriter(dds_entity_t participant, const Settings& settings) {
    for (const Topic topic : both_topics) {
      topics_.push_back(make_topic(participant, topic));
      writers_.emplace_back(
          dds_create_writer(participant, topics_.back().get(), make_qos(settings).get(), nullptr),
          "dds_create_writer");
    }
  }
  void write(Topic topic, std::uint32_t number, std::size_t size) override {
    bytes_.resize(std::max(bytes_.size(), size));
    maide_deliveries_Message message{};
    message.number = number;
    message.data._buffer = bytes_.data();
    message.data._length = message.data._maximum = static_cast<std::uint32_t>(size);
    checked(dds_write(writers_[static_cast<std::size_t>(topic)].get(), &message), "dds_write");
  }

 private:
  std::vector<Entity> topics_, writers_;
  std::vector<std::uint8_t> bytes_;
};

class CycloneReader : public Reader {
 public:
  CycloneReader(Entity own_participant, dds_entity_t participant, const Settings& settings)
      : participant_(std::move(own_participant)),
        waitset_(dds_create_waitset(participant), "dds_create_waitset"),
        looks_in_turn_(settings.is("look", "turn", "waitset")) {
    add(make_topic(participant, Topic::map), participant, settings);
    for (std::uint32_t i = 0; i < settings.number("between", 0); ++i) {
      add(make_topic(participant, "idle" + std::to_string(i)), participant, settings);
    }
    add(make_topic(participant, Topic::notice), participant, settings);
  }

  std::optional<std::uint32_t> take(Topic topic) override {
    std::optional<std::uint32_t> newest;
    const dds_entity_t reader = end_of(topic).reader.get();
    while (true) {
      void* samples[] = {nullptr};
      dds_sample_info_t info[1];
      const dds_return_t taken = checked(dds_take(reader, samples, info, 1, 1), "dds_take");
      if (taken == 0) return newest;
      if (info[0].valid_data) {
        newest = static_cast<const maide_deliveries_Message*>(samples[0])->number;
      }
      checked(dds_return_loan(reader, samples, taken), "dds_return_loan");
    }
  }

  Found look(std::chrono::milliseconds limit) override {
    std::vector<dds_attach_t> list(ends_.size());
    const dds_return_t found = checked(
        dds_waitset_wait(waitset_.get(), list.data(), list.size(), DDS_MSECS(limit.count())),
        "dds_waitset_wait");
    list.resize(std::min(list.size(), static_cast<std::size_t>(found)));
    const auto is_in = [&list](std::size_t end) {
      return std::find(list.begin(), list.end(), static_cast<dds_attach_t>(end)) != list.end();
    };
    if (!looks_in_turn_) return {is_in(0), is_in(ends_.size() - 1)};
    return look_in_turn([this](Topic topic) {
      return checked(dds_triggered(end_of(topic).data.get()), "dds_triggered") > 0;
    });
  }

 private:
  struct End {
    Entity topic, reader, data;
  };
  const End& end_of(Topic topic) const {
    return topic == Topic::map ? ends_.front() : ends_.back();
  }
  void add(Entity topic, dds_entity_t participant, const Settings& settings) {
    End end;
    end.topic = std::move(topic);
    end.reader = {
        dds_create_reader(participant, end.topic.get(), make_qos(settings).get(), nullptr),
        "dds_create_reader"};
    end.data = {dds_create_readcondition(end.reader.get(), DDS_ANY_STATE),
                "dds_create_readcondition"};
    checked(
        dds_waitset_attach(waitset_.get(), end.data.get(), static_cast<dds_attach_t>(ends_.size())),
        "dds_waitset_attach");
    ends_.push_back(std::move(end));
  }

  // Deleted in the opposite order.
  Entity participant_, waitset_;
  std::vector<End> ends_;
  const bool looks_in_turn_;
};

class CycloneDds : public Middleware {
 public:
  explicit CycloneDds(const Settings& settings)
      : settings_(settings),
        domain_(dds_create_domain(0, configuration(settings).c_str()), "dds_create_domain"),
        participant_(make_participant()) {}

  std::unique_ptr<Writer> make_writer() override {
    return std::make_unique<CycloneWriter>(participant_.get(), settings_);
  }
  std::unique_ptr<Reader> make_reader() override {
    Entity own;
    if (settings_.is("ends", "participants", "threads")) own = make_participant();
    const dds_entity_t participant = own.get() > 0 ? own.get() : participant_.get();
    return std::make_unique<CycloneReader>(std::move(own), participant, settings_);
  }

 private:
  static Entity make_participant() {
    return {dds_create_participant(0, nullptr, nullptr), "dds_create_participant"};
  }

  const Settings settings_;
  // Deleted in the opposite order.
  Entity domain_, participant_;
};

}  // namespace
}  // namespace maide::deliveries

int main(int count, char** words) {
  using namespace maide::deliveries;
  return run(count, words,
             {{}, [](const Settings& settings) { return std::make_unique<CycloneDds>(settings); }});
}
