#include "subscriber_end.hpp"

#include <ros/connection_manager.h>
#include <ros/network.h>
#include <ros/subscriber.h>
#include <ros/subscription.h>
#include <ros/xmlrpc_manager.h>
#include <xmlrpcpp/XmlRpc.h>

#include <stdexcept>

namespace maide::ros1 {
namespace {

class IntraprocessEnd : public SubscriberEnd {
 public:
  IntraprocessEnd(ros::NodeHandle& node, ros::SubscribeOptions& options)
      : subscriber_(node.subscribe(options)) {
    if (!subscriber_) throw std::runtime_error("cannot subscribe to " + options.topic);
  }
  ~IntraprocessEnd() override { subscriber_.shutdown(); }
  std::uint32_t count_publishers() override { return subscriber_.getNumPublishers(); }

 private:
  ros::Subscriber subscriber_;
};

// What a publisher's node says when it is asked for a topic over TCPROS.
XmlRpc::XmlRpcValue answer_of_this_node() {
  XmlRpc::XmlRpcValue answer;
  answer[0] = 1;
  answer[1] = std::string();
  answer[2][0] = std::string("TCPROS");
  answer[2][1] = ros::network::getHost();
  answer[2][2] = static_cast<int>(ros::ConnectionManager::instance()->getTCPPort());
  return answer;
}

class TcprosEnd : public SubscriberEnd {
 public:
  explicit TcprosEnd(const ros::SubscribeOptions& options)
      : helper_(options.helper),
        subscription_(boost::make_shared<ros::Subscription>(
            options.topic, options.md5sum, options.datatype, options.transport_hints)) {
    subscription_->addCallback(helper_, options.md5sum, options.callback_queue,
                               static_cast<std::int32_t>(options.queue_size),
                               options.tracked_object, options.allow_concurrent_callbacks);
    connect();
  }
  ~TcprosEnd() override {
    subscription_->removeCallback(helper_);
    subscription_->shutdown();
  }
  std::uint32_t count_publishers() override { return subscription_->getNumPublishers(); }

 private:
  void connect() {
    const auto& manager = ros::XMLRPCManager::instance();
    auto* client = new XmlRpc::XmlRpcClient(ros::network::getHost().c_str(),
                                            static_cast<int>(manager->getServerPort()), "/");
    const auto pending = boost::make_shared<ros::Subscription::PendingConnection>(
        client, nullptr, subscription_, manager->getServerURI());  // owns the client
    XmlRpc::XmlRpcValue answer = answer_of_this_node();
    subscription_->pendingConnectionDone(pending, answer);
  }

  const ros::SubscriptionCallbackHelperPtr helper_;
  const ros::SubscriptionPtr subscription_;
};

}  // namespace

std::unique_ptr<SubscriberEnd> subscribe(ros::NodeHandle& node, ros::SubscribeOptions options,
                                         Transport transport) {
  if (transport == Transport::tcpros) return std::make_unique<TcprosEnd>(options);
  return std::make_unique<IntraprocessEnd>(node, options);
}

}  // namespace maide::ros1
