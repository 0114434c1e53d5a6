// `maide extract` on snippets of C++: what must be in the file, and what must be said to be
// missing.
#include "maide/extract/extract.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <ostream>
#include <string>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/subprocess.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/verdict/check_system.hpp"

namespace maide::extract {
namespace {

namespace fs = std::filesystem;

class Extract : public ::testing::Test {
 protected:
  void SetUp() override {
    try {
      if (run_program({"cppcheck", "--version"}).out.find("2.10") != std::string::npos) return;
    } catch (const UsageError&) {
    }
    GTEST_SKIP() << "cppcheck 2.10 is not there";
  }

  // A node with these members; `make` is the body of its constructor.
  static Extracted node(const std::string& make, const std::string& members,
                        const std::string& before = {}) {
    return source(before + "class A : public rclcpp::Node {\n public:\n  A() : Node(\"a\") {\n" +
                  make + "\n  }\n" + members + "\n};\n");
  }

  static Extracted source(const std::string& text) {
    const TempDir folder;
    const fs::path file = fs::path(folder.path()) / "robot.cpp";
    write_file_atomically(file.string(),
                          "#include <rclcpp/rclcpp.hpp>\nusing Int = std_msgs::msg::Int32;\n"
                          "using Trigger = std_srvs::srv::Trigger;\n" +
                              text);
    ExtractOptions options;
    options.assumes_ok = options.assumes_exceptions = options.assumes_read = true;
    options.is_closed = true;
    options.executor = "single";
    Extracted found = extract_system({file.string()}, options, {});
    expect_readable(found);
    return found;
  }

  // Whatever was found: `maide check` reads the file.
  static void expect_readable(const Extracted& found) {
    try {
      parse_system(found.system, "robot.yaml");
    } catch (const Error& error) {
      ADD_FAILURE() << error.what() << "\n" << found.system;
    }
  }

  static Verdict verdict_of(const Extracted& found, const std::string& property) {
    const auto engine = make_engine("native");
    CheckRequest request;
    request.properties = {property};
    const CheckReport report =
        check_system(parse_system(found.system, "robot.yaml"), *engine, request);
    for (const PropertyResult& result : report.properties) {
      if (result.name == property) return result.verdict;
    }
    ADD_FAILURE() << "no verdict on " << property;
    return Verdict::inconclusive;
  }
};

bool has(const Extracted& found, const std::string& text) {
  return found.system.find(text) != std::string::npos;
}

const std::string ends =
    "  rclcpp::Client<Trigger>::SharedPtr client_; rclcpp::TimerBase::SharedPtr timer_;\n"
    "  rclcpp::Publisher<Int>::SharedPtr pub_; std::mutex lock_; int count_ = 0;\n";

const std::string makes =
    "    client_ = create_client<Trigger>(\"lookup\"); pub_ = create_publisher<Int>(\"x\", 1);\n"
    "    timer_ = create_wall_timer(1s, [this] { tick(); });\n";

TEST_F(Extract, WaitsForAnAnswerInACallback) {
  const Extracted found = node(
      makes,
      ends +
          "  void tick() {\n"
          "    client_->async_send_request(std::make_shared<Trigger::Request>()).get();\n  }\n");
  EXPECT_TRUE(found.is_whole()) << found.holes_file;
  const std::size_t send = found.system.find("lookup.send at"),
                    wait = found.system.find("wait lookup -> answer at");
  ASSERT_NE(send, std::string::npos) << found.system;
  ASSERT_NE(wait, std::string::npos) << found.system;
  EXPECT_LT(send, wait);
  EXPECT_EQ(verdict_of(found, "deadlock"), Verdict::violated) << found.system;
}

TEST_F(Extract, GivesLocksBackOnEveryWay) {
  const Extracted found =
      node(makes, ends +
                      "  void tick() {\n"
                      "    std::lock_guard<std::mutex> guard(lock_);\n    if (count_ > 3) return;\n"
                      "    pub_->publish(Int());\n  }\n");
  EXPECT_TRUE(found.is_whole()) << found.holes_file;
  const std::size_t unlock = found.system.find(".unlock at");
  ASSERT_NE(unlock, std::string::npos) << found.system;
  // It is behind what the return leaves out, and not part of it.
  EXPECT_LT(found.system.find("x.write at"), unlock);
  EXPECT_EQ(found.system.find(".unlock at", unlock + 1), std::string::npos) << found.system;
}

// What is left a second time: the lock is kept then.
TEST_F(Extract, SeesTheSecondReturn) {
  const Extracted found =
      node(makes, ends +
                      "  void tick() {\n    if (count_ > 3) return;\n    lock_.lock();\n"
                      "    if (count_ > 4) return;\n    lock_.unlock();\n  }\n");
  EXPECT_EQ(verdict_of(found, "deadlock"), Verdict::violated) << found.system;
}

TEST_F(Extract, SeesTheSecondThrow) {
  const Extracted found = node(
      makes, ends +
                 "  void tick() {\n    try {\n      pub_->publish(Int());\n      lock_.lock();\n"
                 "      pub_->publish(Int());\n      lock_.unlock();\n    } catch (...) {\n    }\n"
                 "  }\n");
  EXPECT_EQ(verdict_of(found, "deadlock"), Verdict::violated) << found.system;
}

TEST_F(Extract, LooksIntoACast) {
  const Extracted found = node(
      makes, ends +
                 "  void tick() {\n    count_ = static_cast<int>(client_->async_send_request(\n"
                 "        std::make_shared<Trigger::Request>()).get()->success);\n  }\n");
  EXPECT_TRUE(has(found, "lookup.send at")) << found.system;
  EXPECT_TRUE(has(found, "wait lookup -> answer at")) << found.system;
}

TEST_F(Extract, AWaitThatIsBrokenOffEnds) {
  const Extracted found =
      node(makes, ends +
                      "  void tick() {\n    while (!client_->wait_for_service(1s)) {\n"
                      "      if (++count_ > 5) break;\n    }\n    pub_->publish(Int());\n  }\n");
  EXPECT_FALSE(has(found, "wait lookup -> there")) << found.system;
}

TEST_F(Extract, CodeOfALambdaIsNotCodeOfWhoMakesIt) {
  const Extracted found = node(
      "    pub_ = create_publisher<Int>(\"x\", 1);\n"
      "    timer_ = create_wall_timer(1s, [this] { if (count_) pub_->publish(Int()); });\n",
      ends);
  EXPECT_TRUE(found.is_whole()) << found.holes_file;
  EXPECT_EQ(found.system.find("start:"), std::string::npos) << found.system;
  EXPECT_TRUE(has(found, "x.write at")) << found.system;
}

TEST_F(Extract, ATimerThatIsCancelledHasACondition) {
  const Extracted found = node(makes, ends + "  void tick() { timer_->cancel(); }\n");
  EXPECT_TRUE(found.is_whole()) << found.holes_file;
  EXPECT_NE(found.system.find("when: \"timer"), std::string::npos) << found.system;
}

// Each of these is a hole: the end of the line says what would be lost.
struct Lost {
  std::string code, why;
};

void PrintTo(const Lost& lost, std::ostream* out) { *out << lost.why; }

class Holes : public Extract, public ::testing::WithParamInterface<Lost> {};

TEST_P(Holes, AreSaid) {
  const Extracted found = node(
      makes, ends + GetParam().code,
      "namespace mine { struct Log { void put(int) {} }; }\n"
      "struct Log3 { rclcpp::Publisher<Int>::SharedPtr p; Log3(rclcpp::Publisher<Int>::SharedPtr "
      "q) : p(q) {} ~Log3() { p->publish(Int()); } };\n");
  EXPECT_FALSE(found.is_whole()) << GetParam().why << "\n" << found.system;
}

INSTANTIATE_TEST_SUITE_P(
    OfAllKinds, Holes,
    ::testing::Values(
        Lost{"  void tick() { vendor::notify(this); }\n", "a call of a library that is not known"},
        Lost{"  void tick() { again: pub_->publish(Int()); if (count_) goto again; }\n", "goto"},
        Lost{"  void tick() { pub_ = nullptr; }\n  void other() { pub_->publish(Int()); }\n",
             "an end that goes"},
        Lost{"  void tick() { count_++; }\n  void other() { pub_->publish(Int()); }\n",
             "a function that others call"},
        Lost{"  void tick() {}\n  vendor::Port port_;\n", "an object of a class that is not known"},
        Lost{"  void tick() { try { count_++; } catch (...) { pub_->publish(Int()); } }\n",
             "a handler"},
        Lost{"  void tick() { [&] { if (count_) return; pub_->publish(Int()); }(); }\n",
             "a lambda called at once"},
        Lost{"  void tick() { for (;;) { SOME_MACRO(pub_); } }\n", "a macro that is not known"},
        Lost{"  void tick();\n", "a body that is elsewhere"},
        Lost{"#ifdef FAST\n  void tick() { pub_->publish(Int()); }\n#else\n  void tick() "
             "{}\n#endif\n",
             "a condition of the preprocessor"},
        Lost{"  void tick() { timer_.reset(); }\n", "a timer that goes: `.`, not `->`"},
        Lost{"  void tick() { auto & p = pub_; p = nullptr; pub_->publish(Int()); }\n",
             "an end that is set through a reference"},
        Lost{"  void tick() { auto p = std::move(pub_); }\n", "an end that is moved away"},
        Lost{"  void act(int); void act(double) {}\n  void tick() { act(3); }\n",
             "an overload whose body is elsewhere"},
        Lost{"  int val() { pub_->publish(Int()); return 1; }\n  void go(int) {}\n"
             "  void tick() { std::bind(&A::go, this, std::bind(&A::val, this))(); }\n",
             "a bound argument that is called"},
        Lost{"  void tick() { count_ = both(ask(), ask()); }\n  int both(int a, int b) { return a; "
             "}\n"
             "  int ask() { pub_->publish(Int()); return 1; }\n",
             "arguments whose order is open"},
        Lost{"  Log log_;\n  void tick() { log_.put(3); }\n",
             "a class of an unread header that ends with the same word"},
        Lost{"  void tick() { static Log3 log(pub_); }\n", "a class that keeps an end"},
        Lost{"  void tick() { std::swap(pub_, other_); }\n  rclcpp::Publisher<Int>::SharedPtr "
             "other_;\n",
             "ends that are swapped"},
        Lost{"  void tick() { std::vector<std::function<void()>> v; v.push_back([this] { "
             "pub_->publish(Int()); }); }\n",
             "a function that is kept in a container"},
        Lost{"  ~A() { pub_->publish(Int()); }\n  void tick() {}\n", "a destructor"}));

TEST_F(Extract, AnEndlessLoopStays) {
  const Extracted found =
      node(makes, ends + "  void tick() { for (int i = 0;; ++i) { count_ += i; } }\n");
  EXPECT_NE(found.system.find("loop {"), std::string::npos) << found.system;
}

TEST_F(Extract, AnEndlessLoopDoesNotKeepTheFileFromBeingRead) {
  const Extracted found = node(makes, ends + "  void tick() { for (;;) { } }\n");
  EXPECT_TRUE(found.is_whole()) << found.holes_file;
}

TEST_F(Extract, ACountingLoopEnds) {
  const Extracted found =
      node(makes, ends + "  void tick() { for (int i = 0; i < 9; ++i) { count_ += i; } }\n");
  EXPECT_FALSE(has(found, "loop {")) << found.system;
}

// A thread that waits until a loop notifies it, in `body`.
std::string notified_in(const std::string& body) {
  return "class A : public rclcpp::Node {\n public:\n  A() : Node(\"a\") {\n"
         "    timer_ = create_wall_timer(1s, [this] { tick(); });\n"
         "    worker_ = std::thread([this] {\n"
         "      std::unique_lock<std::mutex> lock(mutex_);\n      cv_.wait(lock);\n    });\n  }\n"
         "  void tick() {\n" +
         body +
         "  }\n  std::vector<int> goals_;\n  std::mutex mutex_;\n  std::condition_variable cv_;\n"
         "  std::thread worker_;\n  rclcpp::TimerBase::SharedPtr timer_;\n};\n";
}

// A list may be empty each time, and a loop left early each time: then nobody is notified. But no
// loop over a list goes on for ever.
TEST_F(Extract, ALoopOverAListForcesNothing) {
  const Extracted empty =
      source(notified_in("    for (int goal : goals_) { int x = goal; cv_.notify_one(); }\n"));
  EXPECT_TRUE(empty.is_whole()) << empty.holes_file;
  EXPECT_EQ(verdict_of(empty, "stuck"), Verdict::violated) << empty.system;
  const Extracted left = source(notified_in(
      "    for (int goal : goals_) { if (goal > 0) { return; } }\n    cv_.notify_one();\n"));
  EXPECT_EQ(verdict_of(left, "stuck"), Verdict::violated) << left.system;
  const Extracted ends_at_last =
      source(notified_in("    for (int goal : goals_) { int x = goal; }\n    cv_.notify_one();\n"));
  EXPECT_EQ(verdict_of(ends_at_last, "stuck"), Verdict::holds) << ends_at_last.system;
}

// The guard of a header is none where code stands behind its end.
TEST_F(Extract, AConditionAtTheBeginningIsNoGuard) {
  const std::string code = "struct A : rclcpp::Node { A() : Node(\"a\") {} };\n";
  const TempDir folder;
  const fs::path file = fs::path(folder.path()) / "guard.cpp";
  ExtractOptions options;
  options.assumes_ok = options.assumes_exceptions = options.assumes_read = true;
  write_file_atomically(file.string(), "#ifndef FAST\n#define FAST 1\n" + code + "#endif\n");
  EXPECT_TRUE(extract_system({file.string()}, options, {}).is_whole());
  write_file_atomically(file.string(), "#ifndef FAST\n#define FAST 1\nint one;\n#endif\n" + code);
  EXPECT_FALSE(extract_system({file.string()}, options, {}).is_whole());
  write_file_atomically(file.string(),
                        "#ifndef FAST\n#define FAST 1\nint one;\n#else\n" + code + "#endif\n");
  EXPECT_FALSE(extract_system({file.string()}, options, {}).is_whole());
}

// What a flag is at first says nothing about what it is later.
TEST_F(Extract, AFlagOfAMemberIsAnyLater) {
  const Extracted found = node(
      makes, ends +
                 "  bool done_ = false;\n  void tick() { if (done_) pub_->publish(Int()); else "
                 "done_ = true; }\n");
  EXPECT_TRUE(has(found, "x.write at")) << found.system;
}

TEST_F(Extract, AFlagOfALoopIsAnyInIt) {
  const Extracted found =
      node(makes, ends +
                      "  void tick() {\n    auto f = client_->async_send_request(nullptr);\n"
                      "    bool ok = false;\n"
                      "    while (!ok) { ok = f.wait_for(1s) == std::future_status::ready; }\n"
                      "    pub_->publish(Int());\n  }\n");
  EXPECT_TRUE(found.is_whole()) << found.holes_file;
  EXPECT_TRUE(has(found, "break;")) << found.system;
  EXPECT_TRUE(has(found, "x.write at")) << found.system;
}

TEST_F(Extract, AHandlerMayRunBehindAnyCallOfATry) {
  const Extracted found = node(
      makes, ends +
                 "  void tick() {\n    try { count_ = std::stoi(\"1\"); pub_->publish(Int()); }\n"
                 "    catch (...) { return; }\n    client_->async_send_request(nullptr);\n  }\n");
  EXPECT_TRUE(found.is_whole()) << found.holes_file;
  // One way in front of the write, one behind it: neither sends.
  const std::size_t write = found.system.find("x.write at");
  EXPECT_LT(found.system.find("if * {"), write) << found.system;
  EXPECT_NE(found.system.find("if * {", write), std::string::npos) << found.system;
}

TEST_F(Extract, EachSubscriptionOfANodeHasAQueue) {
  const Extracted found = source(
      "struct A : rclcpp::Node { A() : Node(\"a\") {\n"
      "  p_ = create_publisher<Int>(\"x\", 4);\n"
      "  s_ = create_subscription<Int>(\"x\", 1, [](Int::SharedPtr) {});\n"
      "  u_ = create_subscription<Int>(\"x\", 1, [](Int::SharedPtr) {});\n"
      "  t_ = create_wall_timer(1s, [this] { p_->publish(Int()); }); }\n"
      "  rclcpp::Subscription<Int>::SharedPtr s_, u_; rclcpp::Publisher<Int>::SharedPtr p_;\n"
      "  rclcpp::TimerBase::SharedPtr t_; };\n");
  EXPECT_TRUE(found.is_whole()) << found.holes_file;
  EXPECT_TRUE(has(found, "readers: [a.on_x, a.on_x_2]")) << found.system;
  EXPECT_TRUE(has(found, "pub-depth: 4")) << found.system;
}

TEST_F(Extract, BestEffortLoses) {
  const std::string make =
      "struct A : rclcpp::Node { A() : Node(\"a\") {\n"
      "  p_ = create_publisher<Int>(\"x\", rclcpp::SensorDataQoS());\n"
      "  s_ = create_subscription<Int>(\"x\", QOS, [](Int::SharedPtr) {});\n"
      "  t_ = create_wall_timer(1s, [this] { p_->publish(Int()); }); }\n"
      "  rclcpp::Subscription<Int>::SharedPtr s_; rclcpp::Publisher<Int>::SharedPtr p_;\n"
      "  rclcpp::TimerBase::SharedPtr t_; };\n";
  const auto with = [&](const std::string& qos) {
    std::string text = make;
    return source(text.replace(text.find("QOS"), 3, qos));
  };
  const Extracted same = with("rclcpp::QoS(5).best_effort()");
  EXPECT_TRUE(same.is_whole()) << same.holes_file;
  EXPECT_TRUE(has(same, "loses: true")) << same.system;
  EXPECT_FALSE(with("5").is_whole());  // they never meet
}

// Two nodes of one file, with locks, and nobody else: the two take their locks in either order.
const std::string two_nodes =
    "struct Shared { std::mutex one, two; };\nstatic Shared shared;\n"
    "struct A : rclcpp::Node { A() : Node(\"a\") {\n"
    "  p_ = create_publisher<Int>(\"x\", 1);\n"
    "  t_ = create_wall_timer(1s, [this] { std::lock_guard<std::mutex> g(shared.one);\n"
    "    std::lock_guard<std::mutex> h(shared.two); p_->publish(Int()); }); }\n"
    "  rclcpp::Publisher<Int>::SharedPtr p_; rclcpp::TimerBase::SharedPtr t_; };\n"
    "struct B : rclcpp::Node { B() : Node(\"b\") {\n"
    "  s_ = create_subscription<Int>(\"x\", 1, [this](Int::SharedPtr) {\n"
    "    std::lock_guard<std::mutex> g(shared.FIRST); std::lock_guard<std::mutex> h(shared.LAST);"
    "    n_++; }); }\n"
    "  int n_ = 0; rclcpp::Subscription<Int>::SharedPtr s_; };\n";

std::string locks_in(const std::string& first, const std::string& last) {
  std::string text = two_nodes;
  text.replace(text.find("FIRST"), 5, first);
  return text.replace(text.find("LAST"), 4, last);
}

TEST_F(Extract, LocksOfSeveralNodesAreTakenInTheirOrder) {
  const Extracted bad = source(locks_in("two", "one"));
  EXPECT_TRUE(bad.is_whole()) << bad.holes_file;
  EXPECT_EQ(verdict_of(bad, "deadlock"), Verdict::violated) << bad.system;
  const Extracted good = source(locks_in("one", "two"));
  EXPECT_EQ(verdict_of(good, "deadlock"), Verdict::holds) << good.system;
}

TEST_F(Extract, MainSpinsUntilAnAnswerIsThere) {
  const std::string main =
      "int main(int c, char ** v) {\n  rclcpp::init(c, v);\n"
      "  auto n = rclcpp::Node::make_shared(\"asker\");\n"
      "  auto client = n->create_client<Trigger>(\"lookup\");\n"
      "  while (!client->wait_for_service(1s)) { if (!rclcpp::ok()) { return 0; } }\n"
      "  auto f = client->async_send_request(std::make_shared<Trigger::Request>());\n";
  const Extracted good =
      source(main +
             "  if (rclcpp::spin_until_future_complete(n, f) == rclcpp::FutureReturnCode::SUCCESS) "
             "{ }\n  rclcpp::shutdown();\n}\n");
  EXPECT_TRUE(good.is_whole()) << good.holes_file;
  EXPECT_TRUE(has(good, "wait lookup -> there")) << good.system;
  EXPECT_EQ(verdict_of(good, "stuck"), Verdict::holds) << good.system;
  EXPECT_EQ(verdict_of(good, "deadlock"), Verdict::holds) << good.system;
  const Extracted bad = source(main + "  f.get();\n  rclcpp::spin(n);\n}\n");
  EXPECT_EQ(verdict_of(bad, "deadlock"), Verdict::violated) << bad.system;
}

// A condition elsewhere in the file makes several configurations of the same code.
TEST_F(Extract, ALambdaIsReadOnceHoweverManyConfigurationsThereAre) {
  const Extracted found = source(
      "#ifdef FAST\n#define SPEED 2\n#else\n#define SPEED 1\n#endif\n"
      "struct A : rclcpp::Node { A() : Node(\"a\") { pub_ = create_publisher<Int>(\"x\", 1);\n"
      "  timer_ = create_wall_timer(1s, [this] { pub_->publish(Int()); }); }\n"
      "  rclcpp::Publisher<Int>::SharedPtr pub_; rclcpp::TimerBase::SharedPtr timer_; };\n");
  EXPECT_TRUE(found.is_whole()) << found.holes_file;
  EXPECT_TRUE(has(found, "x.write at")) << found.system;
}

// A plugin: a class that is no node, has one, and asks by a client that it makes where it asks.
TEST_F(Extract, APluginThatNothingMakesIsLookedAt) {
  const Extracted found = source(
      "namespace base { struct Plugin { Plugin(int, const std::string & name) : "
      "node(rclcpp::Node::make_shared(name)) {} rclcpp::Node::SharedPtr node; }; }\n"
      "struct Version : base::Plugin { Version(int k) : Plugin(k, \"sys\") {\n"
      "  t_ = node->create_wall_timer(1s, [this] { ask(); }); }\n"
      "  void ask() { try { auto c = node->create_client<Trigger>(\"cmd\");\n"
      "    auto f = c->async_send_request(nullptr); f.get(); } catch (std::exception & e) { } }\n"
      "  rclcpp::TimerBase::SharedPtr t_; };\n");
  EXPECT_FALSE(found.is_whole());  // who makes it, and how often, is not there
  EXPECT_EQ(verdict_of(found, "deadlock"), Verdict::violated) << found.system;
}

TEST_F(Extract, AThreadMayWaitWhereACallbackMayNot) {
  const Extracted found =
      node(makes + "    thread_ = std::thread([this] { ask(); });\n",
           ends +
               "  std::thread thread_;\n  ~A() { thread_.join(); }\n  void tick() {}\n"
               "  void ask() { client_->wait_for_service();\n"
               "    client_->async_send_request(std::make_shared<Trigger::Request>()).get(); }\n");
  EXPECT_TRUE(found.is_whole()) << found.holes_file;
  EXPECT_TRUE(has(found, "run work at")) << found.system;
  EXPECT_EQ(verdict_of(found, "deadlock"), Verdict::holds) << found.system;
}

TEST_F(Extract, AConditionVariableThatNobodyNotifiesHangs) {
  const std::string members =
      "  std::condition_variable cv_; bool ready_ = false;\n"
      "  void tick() { std::unique_lock<std::mutex> l(lock_); cv_.wait(l, [this] { return ready_; "
      "}); }\n";
  const Extracted bad = node(makes, ends + members);
  EXPECT_TRUE(bad.is_whole()) << bad.holes_file;
  EXPECT_TRUE(has(bad, "cv.wait at")) << bad.system;
}

}  // namespace
}  // namespace maide::extract
