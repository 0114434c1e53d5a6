#include "maide/sul/sul_pool.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <list>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <stdexcept>
#include <stop_token>
#include <thread>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"

namespace maide {
namespace {

// A system has more than one query before it, so that the way to it is not waited for. Not many
// more: another asks them again if it dies, and a stop has to wait for none.
constexpr std::size_t largest_portion = 16;

// The first entry in which two maps differ, in words; "" if they are equal.
std::string find_difference(const std::map<std::string, std::string>& left,
                            const std::map<std::string, std::string>& right,
                            const std::string& what) {
  std::map<std::string, std::string> keys = left;
  keys.insert(right.begin(), right.end());
  const auto value = [](const auto& map, const std::string& key) {
    const auto found = map.find(key);
    return found == map.end() ? std::string("nothing") : "'" + found->second + "'";
  };
  for (const auto& [key, _] : keys) {
    const std::string one = value(left, key), other = value(right, key);
    if (one != other) return what + key + " is " + one + " and " + other;
  }
  return "";
}

// The same for what systems say of themselves.
std::string find_difference(const SulInfo& left, const SulInfo& right) {
  if (left.name != right.name) return "they are '" + left.name + "' and '" + right.name + "'";
  std::string difference = find_difference(left.versions, right.versions, "the version of ");
  if (difference.empty()) {
    difference = find_difference(left.options, right.options, "option ");
  }
  if (!difference.empty()) return difference;
  const bool same_inputs = std::equal(
      left.inputs.begin(), left.inputs.end(), right.inputs.begin(), right.inputs.end(),
      [](const SulInput& one, const SulInput& other) {
        return one.name == other.name && one.actor == other.actor && one.returns == other.returns;
      });
  const bool same_outputs =
      std::equal(left.outputs.begin(), left.outputs.end(), right.outputs.begin(),
                 right.outputs.end(), [](const SulOutput& one, const SulOutput& other) {
                   return one.name == other.name && one.actor == other.actor;
                 });
  if (left.actors != right.actors || !same_inputs || !same_outputs) {
    return "they have other actors, inputs or outputs";
  }
  if (left.bound != right.bound || left.has_actors != right.has_actors ||
      left.speaks_trees != right.speaks_trees || left.speaks_av != right.speaks_av ||
      left.speaks_purposes != right.speaks_purposes) {
    return "they have other bounds, or understand other things";
  }
  return "";
}

std::string text_of(const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const std::exception& reason) {
    return reason.what();
  }
}

}  // namespace

// One call of run(): what the threads share. What they have to tell waits here for the thread that
// called, which alone speaks to the sink.
class SulPool::Batch {
 public:
  struct Answered {
    std::size_t index;
    SulAnswer answer;
  };
  struct News {
    std::vector<Answered> answers;
    bool has_newcomers = false;
    bool is_over = false;  // all threads have ended, and all is handed on
  };

  Batch(std::span<const SulQuery> queries, std::span<const std::size_t> open,
        const RunControl& control)
      : queries_(queries),
        deadline_(control.deadline),
        forward_(control.stop, Forward{stop_}),
        queue_(open.begin(), open.end()) {}

  // Before the thread of a system begins.
  void enter() {
    const std::scoped_lock lock(mutex_);
    ++alive_;
    ++running_;
  }

  // From the thread that admits them.
  void announce_newcomers() {
    const std::scoped_lock lock(mutex_);
    has_newcomers_ = true;
    changed_.notify_all();
  }

  // The work of one system's thread. `prepare` is called first, and may fail as the system does.
  template <typename Prepare>
  void work(Sul& sul, Prepare&& prepare) {
    RunControl control;  // without progress, which is for the calling thread to report
    control.stop = stop_.get_token();
    control.deadline = deadline_;
    if (attempt(sul, {}, {}, prepare)) {
      for (auto portion = take(control); !portion.empty(); portion = take(control)) {
        if (!run_portion(sul, portion, control)) break;
      }
    }
    const std::scoped_lock lock(mutex_);
    MAIDE_CHECK(running_ > 0);
    --running_;
    changed_.notify_all();
  }

  // Waits for answers, for newcomers, or for the end.
  News wait() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return running_ == 0 || !answered_.empty() || has_newcomers_; });
    News news{std::exchange(answered_, {}), std::exchange(has_newcomers_, false), running_ == 0};
    return news;
  }

  // Ends all work as if interrupted; the first error counts.
  void stop(std::exception_ptr error) {
    {
      const std::scoped_lock lock(mutex_);
      if (!error_) error_ = std::move(error);
    }
    stop_.request_stop();
  }

  // Once all threads have ended: why the batch was stopped (null: it was not), and the systems that
  // failed.
  const std::exception_ptr& error() const { return error_; }
  const std::vector<std::pair<const Sul*, std::exception_ptr>>& failed() const { return failed_; }

 private:
  struct Forward {
    std::stop_source& stop;
    void operator()() const { stop.request_stop(); }
  };
  using Portion = std::vector<std::size_t>;  // indices of queries

  // While others work, something may still be put back.
  Portion take(const RunControl& control) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, control.stop, [this] { return !queue_.empty() || in_flight_ == 0; });
    Portion portion;
    if (control.should_stop()) return portion;
    const std::size_t size = std::clamp<std::size_t>(
        queue_.size() / (2 * std::max<std::size_t>(alive_, 1)), 1, largest_portion);
    while (portion.size() < size && !queue_.empty()) {
      portion.push_back(queue_.front());
      queue_.pop_front();
    }
    in_flight_ += portion.size();
    MAIDE_CHECK(in_flight_ + queue_.size() <= queries_.size());
    return portion;
  }

  // False if the system is of no more use.
  bool run_portion(Sul& sul, const Portion& portion, const RunControl& control) {
    std::vector<SulQuery> queries;
    for (const std::size_t index : portion) queries.push_back(queries_[index]);
    std::vector<bool> is_answered(portion.size(), false);
    const auto sink = [&](std::size_t index, SulAnswer answer) {
      MAIDE_CHECK(index < portion.size() && !is_answered[index]);
      is_answered[index] = true;
      const std::scoped_lock lock(mutex_);
      answered_.push_back({portion[index], std::move(answer)});
      changed_.notify_all();
    };
    return attempt(sul, portion, is_answered, [&] {
      sul.run(queries, sink, control);
      if (std::ranges::find(is_answered, false) != is_answered.end()) {
        throw std::logic_error("a system left a query without an answer");
      }
    });
  }

  // The same for any work on the system; `portion` was taken for it.
  template <typename Work>
  bool attempt(Sul& sul, const Portion& portion, const std::vector<bool>& is_answered,
               Work&& work) {
    bool is_alive = true;
    std::exception_ptr failure;
    try {
      work();
    } catch (const WrapperError&) {
      is_alive = false;
      failure = std::current_exception();
    } catch (...) {
      is_alive = false;
      stop(std::current_exception());
    }
    const std::scoped_lock lock(mutex_);
    // At once: nobody may see a query both in flight and in the queue.
    in_flight_ -= portion.size();
    if (failure) put_back(sul, portion, is_answered, failure);
    changed_.notify_all();
    return is_alive;
  }

  // The mutex is held.
  void put_back(const Sul& sul, const Portion& portion, const std::vector<bool>& is_answered,
                const std::exception_ptr& error) {
    for (std::size_t i = portion.size(); i-- > 0;) {
      if (!is_answered[i]) queue_.push_front(portion[i]);
    }
    --alive_;
    failed_.emplace_back(&sul, error);
  }

  std::span<const SulQuery> queries_;
  std::optional<std::chrono::steady_clock::time_point> deadline_;
  std::stop_source stop_;
  std::stop_callback<Forward> forward_;

  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<std::size_t> queue_;
  std::vector<Answered> answered_;
  std::size_t alive_ = 0;    // systems that have not failed
  std::size_t running_ = 0;  // threads that have not ended
  bool has_newcomers_ = false;
  std::size_t in_flight_ = 0;  // queries that a thread has taken
  std::exception_ptr error_;
  std::vector<std::pair<const Sul*, std::exception_ptr>> failed_;
};

SulPool::SulPool(std::vector<Member> members, Warn warn, std::chrono::milliseconds patience)
    : warn_(std::move(warn)), patience_(patience) {
  if (members.empty()) throw UsageError("a pool needs a system");
  info_ = members.front().sul->info();
  const std::string first = members.front().name;
  for (Member& member : members) {
    const std::string difference = find_difference(info_, member.sul->info());
    if (!difference.empty()) {
      throw UsageError("systems that are asked at once must be the same: " + difference + " (" +
                       first + ", " + member.name + ")");
    }
    members_.push_back({std::move(member)});
  }
  most_ = members_.size();
}

SulPool::~SulPool() = default;

void SulPool::admit(Member&& member) {
  const std::string difference = find_difference(info_, member.sul->info());
  if (!difference.empty()) {
    throw UsageError("systems that are asked at once must be the same: " + difference);
  }
  const std::scoped_lock lock(mutex_);
  newcomers_.push_back({std::move(member)});
  if (running_ != nullptr) running_->announce_newcomers();
  changed_.notify_all();
}

std::vector<SulPool::Place*> SulPool::take_newcomers() {
  std::list<Place> taken;
  {
    const std::scoped_lock lock(mutex_);
    taken.swap(newcomers_);
  }
  std::vector<Place*> places;
  for (Place& place : taken) places.push_back(&place);
  members_.splice(members_.end(), taken);
  most_ = std::max(most_, members_.size());
  return places;
}

// Nobody is left.
void SulPool::await_newcomer(const RunControl& control) {
  const auto seconds = std::chrono::duration<double>(patience_).count();
  if (patience_.count() > 0 && warn_) {
    warn_(fmt::format("no system is left: {} s are waited for another", seconds));
  }
  auto until = std::chrono::steady_clock::now() + patience_;
  if (control.deadline) until = std::min(until, *control.deadline);
  {
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, control.stop, until, [this] { return !newcomers_.empty(); });
  }
  control.check("waiting for a system");
  if (!take_newcomers().empty()) return;
  if (patience_.count() == 0) std::rethrow_exception(last_error_);
  throw Error(ExitStatus::system_failed,
              fmt::format("all systems are gone, and none has come within {} s; the last one: {}",
                          seconds, text_of(last_error_)));
}

void SulPool::give_purposes(Place& place) const {
  for (; place.purposes < purposes_.size(); ++place.purposes) {
    place.member.sul->add_purpose(purposes_[place.purposes]);
  }
}

void SulPool::add_purpose(const LearningPurpose& purpose) {
  take_newcomers();
  purposes_.push_back(purpose);
  std::vector<std::pair<const Sul*, std::exception_ptr>> failed;
  for (Place& place : members_) {
    try {
      give_purposes(place);
    } catch (const WrapperError&) {
      failed.emplace_back(place.member.sul.get(), std::current_exception());
    } catch (...) {
      purposes_.pop_back();
      throw;
    }
  }
  for (const auto& [sul, error] : failed) give_up(*sul, error);
  if (members_.empty()) await_newcomer({});
}

SulIncidents SulPool::incidents() const {
  SulIncidents all = earlier_incidents_;
  for (const Place& place : members_) all.add(place.member.sul->incidents());
  return all;
}

void SulPool::give_up(const Sul& sul, const std::exception_ptr& error) {
  const auto member = std::ranges::find_if(
      members_, [&](const Place& one) { return one.member.sul.get() == &sul; });
  MAIDE_CHECK(member != members_.end());
  const std::string name = member->member.name;
  earlier_incidents_.add(sul.incidents());
  members_.erase(member);
  last_error_ = error;
  if (!warn_ || (members_.empty() && patience_.count() == 0)) return;
  warn_(name + " is given up, its words are asked elsewhere: " + text_of(error));
}

void SulPool::run(std::span<const SulQuery> batch, const SulAnswerSink& sink,
                  const RunControl& control) {
  std::vector<bool> is_answered(batch.size(), false);
  const SulAnswerSink checked_sink = [&](std::size_t index, SulAnswer answer) {
    MAIDE_CHECK(!is_answered[index]);  // none is handed on twice, whoever failed
    is_answered[index] = true;
    sink(index, std::move(answer));
  };
  // Again only if all systems that took part failed, and there are others, or will be.
  while (true) {
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if (!is_answered[i]) open.push_back(i);
    }
    take_newcomers();
    if (open.empty()) return;
    if (members_.empty()) await_newcomer(control);
    run_once(batch, open, checked_sink, control);
  }
}

// While it lives, newcomers are announced to the batch.
class SulPool::Listening {
 public:
  Listening(SulPool& pool, Batch& batch) : pool_(pool) {
    const std::scoped_lock lock(pool_.mutex_);
    pool_.running_ = &batch;
    if (!pool_.newcomers_.empty()) batch.announce_newcomers();
  }
  ~Listening() {
    const std::scoped_lock lock(pool_.mutex_);
    pool_.running_ = nullptr;
  }
  Listening(const Listening&) = delete;
  Listening& operator=(const Listening&) = delete;

 private:
  SulPool& pool_;
};

void SulPool::run_once(std::span<const SulQuery> batch, std::span<const std::size_t> open,
                       const SulAnswerSink& sink, const RunControl& control) {
  MAIDE_CHECK(!members_.empty() && !open.empty());
  Batch shared(batch, open, control);
  {
    std::list<std::jthread> threads;
    const auto start = [&](Place& place) {
      shared.enter();
      threads.emplace_back([this, &shared, &place] {
        shared.work(*place.member.sul, [&] { give_purposes(place); });
      });
    };
    for (auto place = members_.begin(); place != members_.end() && threads.size() < open.size();
         ++place) {
      start(*place);
    }
    const Listening listening(*this, shared);
    while (true) {
      Batch::News news = shared.wait();
      try {
        for (Batch::Answered& one : news.answers) sink(one.index, std::move(one.answer));
      } catch (...) {
        shared.stop(std::current_exception());
      }
      if (news.is_over) break;
      if (news.has_newcomers) {
        for (Place* place : take_newcomers()) start(*place);
      }
    }
  }
  for (const auto& [sul, error] : shared.failed()) give_up(*sul, error);
  if (shared.error()) std::rethrow_exception(shared.error());
  control.check("running words on the system");
}

}  // namespace maide
