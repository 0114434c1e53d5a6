"""Puts a publish into sources in many ways that hide it, and looks whether `maide extract` loses it in silence.

    damages.py MAIDE

Each damage is code in a callback (`body`), in the class (`members`) or in front of it (`before`) that publishes on the
topic `hidden`. The result is right if the file has `hidden.write`, or if the exit status says that something is missing.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

HEAD = """#include <rclcpp/rclcpp.hpp>
using namespace std::chrono_literals;
using Int = std_msgs::msg::Int32; using Trigger = std_srvs::srv::Trigger;
"""

# Where the callback's body stands.
FRAMES = {
    "lambda": """struct A : rclcpp::Node { A() : Node("a") {
  hidden_ = create_publisher<Int>("hidden", 1); client_ = create_client<Trigger>("s");
  timer_ = create_wall_timer(1s, [this] { BODY }); }
  MEMBERS
  int n_ = 0; bool flag_ = false; std::mutex mutex_; std::vector<int> list_;
  rclcpp::Client<Trigger>::SharedPtr client_;
  rclcpp::Publisher<Int>::SharedPtr hidden_, other_; rclcpp::TimerBase::SharedPtr timer_; };
""",
    "method": """class A : public rclcpp::Node { public: A() : Node("a") {
  hidden_ = create_publisher<Int>("hidden", 1); client_ = create_client<Trigger>("s");
  timer_ = create_wall_timer(1s, std::bind(&A::tick, this)); }
  void tick() {
    RCLCPP_INFO(get_logger(), "tick");
    if (n_ > 3) { return; }
    BODY
  }
  MEMBERS
 private:
  int n_ = 0; bool flag_ = false; std::mutex mutex_; std::vector<int> list_;
  rclcpp::Client<Trigger>::SharedPtr client_;
  rclcpp::Publisher<Int>::SharedPtr hidden_, other_; rclcpp::TimerBase::SharedPtr timer_; };
int main(int c, char ** v) { rclcpp::init(c, v); rclcpp::spin(std::make_shared<A>()); rclcpp::shutdown(); }
""",
    "subscription": """class A : public rclcpp::Node { public: A() : Node("a") {
  hidden_ = create_publisher<Int>("hidden", 1); client_ = create_client<Trigger>("s");
  sub_ = create_subscription<Int>("x", 10, std::bind(&A::on, this, std::placeholders::_1)); }
  MEMBERS
 private:
  void on(const Int::SharedPtr m) { std::lock_guard<std::mutex> guard(mutex_); n_ = m->data; BODY }
  int n_ = 0; bool flag_ = false; std::mutex mutex_; std::vector<int> list_;
  rclcpp::Client<Trigger>::SharedPtr client_; rclcpp::TimerBase::SharedPtr timer_;
  rclcpp::Publisher<Int>::SharedPtr hidden_, other_; rclcpp::Subscription<Int>::SharedPtr sub_; };
""",
}

SEND = "hidden_->publish(Int());"

# name: (body, members, before)
DAMAGES = {
    "plain": (SEND, "", ""),
    "if": ("if (n_) " + SEND, "", ""),
    "else": ("if (n_) { } else " + SEND, "", ""),
    "else of a known flag": ("if (!flag_) { flag_ = true; } else { " + SEND + " }", "", ""),
    "while": ("while (n_) " + SEND, "", ""),
    "do": ("do { " + SEND + " } while (n_);", "", ""),
    "for": ("for (int i = 0; i < 3; ++i) " + SEND, "", ""),
    "for that steps": ("for (int i = 0; i < 3; ++i, hidden_->publish(Int())) { }", "", ""),
    "condition of for": ("for (; say(); ) { }", "bool say() { " + SEND + " return false; }", ""),
    "range": ("for (int i : list_) { n_ += i; " + SEND + " }", "", ""),
    "range over what communicates": ("for (int i : say()) { n_ += i; }",
                                     "std::vector<int> say() { " + SEND + " return {}; }", ""),
    "case": ("switch (n_) { case 1: n_ = 2; break; case 2: " + SEND + " }", "", ""),
    "default": ("switch (n_) { default: " + SEND + " }", "", ""),
    "switch over what communicates": ("switch (say()) { case 1: break; }", "int say() { " + SEND + " return 1; }", ""),
    "comma": ("n_ = (hidden_->publish(Int()), 3);", "", ""),
    "and": ("flag_ = flag_ && say();", "bool say() { " + SEND + " return true; }", ""),
    "or": ("flag_ = flag_ || say();", "bool say() { " + SEND + " return true; }", ""),
    "conditional": ("n_ > 1 ? hidden_->publish(Int()) : (void)0;", "", ""),
    "in an index": ("n_ = list_[say()];", "int say() { " + SEND + " return 0; }", ""),
    "in an argument": ("list_.push_back(say());", "int say() { " + SEND + " return 0; }", ""),
    "in a log": ("RCLCPP_DEBUG(get_logger(), \"%d\", say());", "int say() { " + SEND + " return 0; }", ""),
    "in a return": ("n_ = say();", "int say() { return tell(); } int tell() { " + SEND + " return 0; }", ""),
    "in sizeof's neighbour": ("n_ = static_cast<int>(sizeof(int)) + say();", "int say() { " + SEND + " return 0; }",
                              ""),
    "in a cast": ("n_ = static_cast<int>(say());", "double say() { " + SEND + " return 0; }", ""),
    "in an old cast": ("n_ = (int)say();", "double say() { " + SEND + " return 0; }", ""),
    "in a declaration": ("int k = say(); n_ = k;", "int say() { " + SEND + " return 0; }", ""),
    "in braces": ("int k{say()}; n_ = k;", "int say() { " + SEND + " return 0; }", ""),
    "in a static": ("static int k = say(); n_ = k;", "int say() { " + SEND + " return 0; }", ""),
    "in a default argument": ("take();", "int say() { " + SEND + " return 0; } void take(int k = 3); ", ""),
    "in a default argument of a lambda": ("auto f = [this](int k) { n_ = k; " + SEND + " }; f(1);", "", ""),
    "lambda at once": ("[this] { " + SEND + " }();", "", ""),
    "lambda with return at once": ("[&] { if (n_) return; " + SEND + " }();", "", ""),
    "lambda in a variable": ("auto f = [this] { " + SEND + " }; f();", "", ""),
    "lambda in a function object": ("std::function<void()> f = [this] { " + SEND + " }; f();", "", ""),
    "lambda in a container": ("std::vector<std::function<void()>> v; v.push_back([this] { " + SEND + " }); v[0]();",
                              "", ""),
    "lambda in a member": ("call_ = [this] { " + SEND + " }; call_();", "std::function<void()> call_;", ""),
    "lambda in an algorithm": ("std::for_each(list_.begin(), list_.end(), [this](int) { " + SEND + " });", "", ""),
    "lambda in a thread": ("std::thread([this] { " + SEND + " }).detach();", "", ""),
    "lambda in async": ("auto f = std::async([this] { " + SEND + " }); f.get();", "", ""),
    "lambda that captures a value": ("auto f = [p = hidden_] { p->publish(Int()); }; f();", "", ""),
    "method pointer": ("auto f = &A::say; (this->*f)();", "void say() { " + SEND + " }", ""),
    "bind": ("std::bind(&A::say, this)();", "void say() { " + SEND + " }", ""),
    "bind in bind": ("std::bind(&A::take, this, std::bind(&A::say, this))();",
                     "int say() { " + SEND + " return 1; } void take(int) {}", ""),
    "mem_fn": ("std::mem_fn(&A::say)(*this);", "void say() { " + SEND + " }", ""),
    "reference to the end": ("auto & p = hidden_; p->publish(Int());", "", ""),
    "copy of the end": ("auto p = hidden_; p->publish(Int());", "", ""),
    "pointer to the end": ("auto * p = hidden_.get(); p->publish(Int());", "", ""),
    "pointer to the pointer": ("auto * p = &hidden_; (*p)->publish(Int());", "", ""),
    "weak pointer": ("std::weak_ptr<rclcpp::Publisher<Int>> w = hidden_; if (auto p = w.lock()) p->publish(Int());",
                     "", ""),
    "the end in a pair": ("auto p = std::make_pair(1, hidden_); p.second->publish(Int());", "", ""),
    "the end in a map": ("ends_[\"x\"] = hidden_; ends_[\"x\"]->publish(Int());",
                         "std::map<std::string, rclcpp::Publisher<Int>::SharedPtr> ends_;", ""),
    "the end in a struct": ("Box b; b.p = hidden_; b.p->publish(Int());", "",
                            "struct Box { rclcpp::Publisher<Int>::SharedPtr p; };\n"),
    "the end in an aggregate": ("Box b{hidden_}; b.p->publish(Int());", "",
                                "struct Box { rclcpp::Publisher<Int>::SharedPtr p; };\n"),
    "the end swapped": ("std::swap(hidden_, other_); other_->publish(Int());", "", ""),
    "the end moved": ("other_ = std::move(hidden_); other_->publish(Int());", "", ""),
    "the end chosen": ("auto p = n_ ? hidden_ : other_; p->publish(Int());", "", ""),
    "the end as argument": ("say(hidden_);", "void say(rclcpp::Publisher<Int>::SharedPtr p) { p->publish(Int()); }", ""),
    "the end as reference": ("say(*hidden_);", "void say(rclcpp::Publisher<Int> & p) { p.publish(Int()); }", ""),
    "free function": ("say(*hidden_);", "", "static void say(rclcpp::Publisher<Int> & p) { p.publish(Int()); }\n"),
    "template": ("say(hidden_);", "", "template <typename T> void say(T p) { p->publish(Int()); }\n"),
    "template in a class": ("say(3);", "template <typename T> void say(T) { " + SEND + " }", ""),
    "variadic template": ("say(1, 2);", "template <typename... T> void say(T...) { " + SEND + " }", ""),
    "virtual": ("say();", "virtual void say() { " + SEND + " }", ""),
    "virtual in a base": ("other(); ", "void other() { s_->go(hidden_); } std::shared_ptr<Base> s_;",
                          "struct Base { virtual void go(rclcpp::Publisher<Int>::SharedPtr) {} };\nstruct More : Base "
                          "{ void go(rclcpp::Publisher<Int>::SharedPtr p) override { p->publish(Int()); } };\n"),
    "object of another class": ("Talker(hidden_).say();", "",
                                "struct Talker { rclcpp::Publisher<Int>::SharedPtr p; Talker(rclcpp::Publisher<Int>::"
                                "SharedPtr q) : p(q) {} void say() { p->publish(Int()); } };\n"),
    "constructor": ("Talker t(hidden_);", "",
                    "struct Talker { Talker(rclcpp::Publisher<Int>::SharedPtr q) { q->publish(Int()); } };\n"),
    "destructor": ("Talker t{hidden_};", "",
                   "struct Talker { rclcpp::Publisher<Int>::SharedPtr p; ~Talker() { p->publish(Int()); } };\n"),
    "member initialiser": ("Talker t(hidden_);", "",
                           "struct Talker { int k; Talker(rclcpp::Publisher<Int>::SharedPtr q) : k((q->publish(Int()), "
                           "1)) {} };\n"),
    "operator": ("Talker t{hidden_}; t << 3;", "",
                 "struct Talker { rclcpp::Publisher<Int>::SharedPtr p; void operator<<(int) { p->publish(Int()); } };\n"),
    "call operator": ("Talker t{hidden_}; t();", "",
                      "struct Talker { rclcpp::Publisher<Int>::SharedPtr p; void operator()() { p->publish(Int()); } };\n"),
    "conversion": ("Talker t{hidden_}; if (t) { n_ = 1; }", "",
                   "struct Talker { rclcpp::Publisher<Int>::SharedPtr p; operator bool() { p->publish(Int()); return "
                   "true; } };\n"),
    "static method": ("Talker::say(hidden_);", "",
                      "struct Talker { static void say(rclcpp::Publisher<Int>::SharedPtr p) { p->publish(Int()); } };\n"),
    "singleton": ("Talker::get().p = hidden_; Talker::get().p->publish(Int());", "",
                  "struct Talker { rclcpp::Publisher<Int>::SharedPtr p; static Talker & get() { static Talker t; return "
                  "t; } };\n"),
    "macro": ("SAY(hidden_);", "", "#define SAY(p) p->publish(Int())\n"),
    "pasted macro": ("SAY(hidden_, pub, lish);", "", "#define SAY(p, a, b) p->a##b(Int())\n"),
    "macro of an unread header": ("VENDOR_SAY(hidden_);", "", "#include <vendor/say.hpp>\n"),
    "macro of an unread header without an end": ("VENDOR_SAY(this);", "", "#include <vendor/say.hpp>\n"),
    "function of an unread header": ("vendor::say(this);", "", "#include <vendor/say.hpp>\n"),
    "method of an unread class": ("vendor::Talker t(this); t.say();", "", "#include <vendor/say.hpp>\n"),
    "condition of the preprocessor": ("\n#ifdef SAY\n" + SEND + "\n#endif\n", "", ""),
    "other side of the preprocessor": ("\n#if 1\n n_ = 1;\n#else\n" + SEND + "\n#endif\n", "", ""),
    "macro under a condition": ("TELL(hidden_);", "", "#ifdef SAY\n#define TELL(p) p->publish(Int())\n#else\n#define "
                                "TELL(p)\n#endif\n"),
    "macro without brackets under a condition": ("TELL;", "", "#ifdef SAY\n#define TELL hidden_->publish(Int())\n#else\n"
                                                 "#define TELL\n#endif\n"),
    "initialiser under a condition": ("n_ = 1;", "int k_ = TELL;", "#ifdef SAY\n#define TELL (hidden_->publish(Int()), 1)"
                                      "\n#else\n#define TELL 1\n#endif\n"),
    "goto": ("again: n_++; if (n_ < 3) goto again; " + SEND, "", ""),
    "behind a break": ("for (;;) { if (n_) break; " + SEND + " }", "", ""),
    "behind a continue": ("for (int i = 0; i < 3; ++i) { if (n_) continue; " + SEND + " }", "", ""),
    "behind a return in a lambda": ("auto f = [this] { return; }; f(); " + SEND, "", ""),
    "behind a throw": ("if (n_) throw 3; " + SEND, "", ""),
    "try": ("try { " + SEND + " } catch (...) { }", "", ""),
    "handler": ("try { n_ = std::stoi(\"3\"); } catch (...) { " + SEND + " }", "", ""),
    "behind a handler that returns": ("try { n_ = std::stoi(\"3\"); } catch (...) { return; } " + SEND, "", ""),
    "answer": ("client_->async_send_request(nullptr, [this](rclcpp::Client<Trigger>::SharedFuture) { " + SEND + " });",
               "", ""),
    "timer made later": ("timer2_ = create_wall_timer(1s, [this] { " + SEND + " });",
                         "rclcpp::TimerBase::SharedPtr timer2_;", ""),
    "one of two overloads": ("say(3);", "void say(int) { n_ = 1; } void say(double) { " + SEND + " }", ""),
    "overload elsewhere": ("say(3);", "void say(int); void say(double) { n_ = 1; }", ""),
    "recursion": ("say(3);", "void say(int k) { if (k) say(k - 1); else " + SEND + " }", ""),
    "mutual recursion": ("one(3);", "void one(int k) { if (k) two(k); } void two(int k) { one(k - 1); " + SEND + " }",
                         ""),
    "alias": ("Alias t{hidden_}; t.say();", "",
              "struct Talker { rclcpp::Publisher<Int>::SharedPtr p; void say() { p->publish(Int()); } };\nusing Alias = "
              "Talker;\n"),
    "nested class": ("Inner t{hidden_}; t.say();",
                     "struct Inner { rclcpp::Publisher<Int>::SharedPtr p; void say() { p->publish(Int()); } };", ""),
    "class in the function": ("struct In { rclcpp::Publisher<Int>::SharedPtr p; void say() { p->publish(Int()); } }; "
                              "In t{hidden_}; t.say();", "", ""),
    "namespace": ("deep::say(hidden_);", "",
                  "namespace deep { inline void say(rclcpp::Publisher<Int>::SharedPtr p) { p->publish(Int()); } }\n"),
    "using declaration": ("say(hidden_);", "",
                          "namespace deep { inline void say(rclcpp::Publisher<Int>::SharedPtr p) { p->publish(Int()); } "
                          "}\nusing deep::say;\n"),
    "argument's namespace": ("say(deep::Tag(), hidden_);", "",
                             "namespace deep { struct Tag {}; inline void say(Tag, rclcpp::Publisher<Int>::SharedPtr p) "
                             "{ p->publish(Int()); } }\n"),
    "structured binding": ("auto [p, k] = std::make_pair(hidden_, 1); p->publish(Int());", "", ""),
    "if with a declaration": ("if (auto p = hidden_; n_) p->publish(Int());", "", ""),
    "generic lambda": ("auto f = [](auto p) { p->publish(Int()); }; f(hidden_);", "", ""),
    "new": ("auto * t = new Talker(hidden_); t->say();", "",
            "struct Talker { rclcpp::Publisher<Int>::SharedPtr p; Talker(rclcpp::Publisher<Int>::SharedPtr q) : p(q) {} "
            "void say() { p->publish(Int()); } };\n"),
    "unique pointer": ("auto t = std::make_unique<Talker>(hidden_); t->say();", "",
                       "struct Talker { rclcpp::Publisher<Int>::SharedPtr p; Talker(rclcpp::Publisher<Int>::SharedPtr q) "
                       ": p(q) {} void say() { p->publish(Int()); } };\n"),
    "raw string before": ("const char * s = R\"x(\")x\"; n_ = s[0]; " + SEND, "", ""),
    "comment trick": ("n_ = 1; // \\\n n_ = 2;\n" + SEND, "", ""),
    "digraph": ("<% " + SEND + " %>", "", ""),
    "alternative tokens": ("if (flag_ and not n_) " + SEND, "", ""),
    "attribute": ("[[maybe_unused]] int k = 1; if (k) [[likely]] " + SEND, "", ""),
    "coroutine": ("co_await say();", "Task say() { " + SEND + " co_return; }", "#include <vendor/task.hpp>\n"),
    "atexit": ("std::atexit([] { });" + SEND, "", ""),
    "signal": ("signal(2, [](int) { });" + SEND, "", ""),
    "inline assembler": ("asm(\"nop\"); " + SEND, "", ""),
    "exchange": ("other_ = std::exchange(hidden_, nullptr); other_->publish(Int());", "", ""),
    "optional": ("std::optional<rclcpp::Publisher<Int>::SharedPtr> o = hidden_; (*o)->publish(Int());", "", ""),
    "variant": ("std::variant<int, rclcpp::Publisher<Int>::SharedPtr> o = hidden_; std::get<1>(o)->publish(Int());",
                "", ""),
    "tuple": ("auto o = std::make_tuple(hidden_, 1); std::get<0>(o)->publish(Int());", "", ""),
    "invoke": ("std::invoke(&A::say, this);", "void say() { " + SEND + " }", ""),
    "call_once": ("std::call_once(once_, [this] { " + SEND + " });", "std::once_flag once_;", ""),
    "scope guard": ("auto g = std::shared_ptr<int>(nullptr, [this](int *) { " + SEND + " });", "", ""),
    "loaned message": ("auto m = hidden_->borrow_loaned_message(); hidden_->publish(std::move(m));", "", ""),
    "by the graph": ("get_node_topics_interface()->add_publisher(hidden_, nullptr); " + SEND, "", ""),
}


def source_of(frame, damage):
    body, members, before = damage
    return HEAD + before + frame.replace("BODY", body).replace("MEMBERS", members)


def has_known_cppcheck():
    try:
        result = subprocess.run(["cppcheck", "--version"], capture_output=True, text=True)
    except FileNotFoundError:
        return False
    return "2.10" in result.stdout


def main(maide):
    if not has_known_cppcheck():
        print("skipped: cppcheck 2.10 is not there")
        return 77
    bad = 0
    counts = {}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "robot.cpp")
        for frame_name, frame in FRAMES.items():
            for name, damage in DAMAGES.items():
                path.write_text(source_of(frame, damage))
                result = subprocess.run([maide, "extract", str(path), "--assume", "ok,exceptions,read", "--executor", "single"],
                                        capture_output=True, text=True)
                has_write = "hidden.write" in result.stdout
                if result.returncode not in (0, 3) or (result.returncode == 0 and not has_write):
                    bad += 1
                    print(f"{frame_name}, {name}: exit {result.returncode} and no write {result.stderr.strip()}")
                    print(result.stdout)
                counts[result.returncode] = counts.get(result.returncode, 0) + 1
    print(f"{len(DAMAGES)} kinds in {len(FRAMES)} files: exit 0 {counts.get(0, 0)}, exit 3 {counts.get(3, 0)}, lost {bad}")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
