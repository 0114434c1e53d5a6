#include "maide/sul/sul_pool.hpp"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
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

}  // namespace

// One call of run(): what the threads share. What they have to tell waits here for the thread that
// called, which alone speaks to the sink.
class SulPool::Batch {
 public:
  struct Answered {
    std::size_t index;
    SulAnswer answer;
  };

  Batch(std::span<const SulQuery> queries, std::span<const std::size_t> open,
        const RunControl& control, std::size_t workers)
      : queries_(queries),
        deadline_(control.deadline),
        forward_(control.stop, Forward{stop_}),
        queue_(open.begin(), open.end()),
        alive_(workers),
        running_(workers) {}

  // The work of one system's thread.
  void work(Sul& sul) {
    RunControl control;  // without progress, which is for the calling thread to report
    control.stop = stop_.get_token();
    control.deadline = deadline_;
    for (auto portion = take(control); !portion.empty(); portion = take(control)) {
      if (!run_portion(sul, portion, control)) break;
    }
    const std::scoped_lock lock(mutex_);
    MAIDE_CHECK(running_ > 0);
    --running_;
    changed_.notify_all();
  }

  // Waits for answers; none: all threads have ended, and all is handed on.
  std::vector<Answered> wait() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return running_ == 0 || !answered_.empty(); });
    return std::exchange(answered_, {});
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
    bool is_alive = true;
    std::exception_ptr failure;
    try {
      sul.run(queries, sink, control);
      if (std::find(is_answered.begin(), is_answered.end(), false) != is_answered.end()) {
        throw std::logic_error("a system left a query without an answer");
      }
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
  std::size_t alive_;          // systems that have not failed
  std::size_t running_;        // threads that have not ended
  std::size_t in_flight_ = 0;  // queries that a thread has taken
  std::exception_ptr error_;
  std::vector<std::pair<const Sul*, std::exception_ptr>> failed_;
};

SulPool::SulPool(std::vector<Member> members, Warn warn)
    : members_(std::move(members)), warn_(std::move(warn)) {
  if (members_.empty()) throw UsageError("a pool needs a system");
  info_ = members_.front().sul->info();
  for (const Member& member : members_) {
    const std::string difference = find_difference(info_, member.sul->info());
    if (difference.empty()) continue;
    throw UsageError("systems that are asked at once must be the same: " + difference + " (" +
                     members_.front().name + ", " + member.name + ")");
  }
}

void SulPool::add_purpose(const LearningPurpose& purpose) {
  std::vector<std::pair<const Sul*, std::exception_ptr>> failed;
  for (const Member& member : members_) {
    try {
      member.sul->add_purpose(purpose);
    } catch (const WrapperError&) {
      failed.emplace_back(member.sul.get(), std::current_exception());
    }
  }
  for (const auto& [sul, error] : failed) give_up(*sul, error);
  if (members_.empty()) std::rethrow_exception(last_error_);
}

SulIncidents SulPool::incidents() const {
  SulIncidents all = earlier_incidents_;
  for (const Member& member : members_) all.add(member.sul->incidents());
  return all;
}

void SulPool::give_up(const Sul& sul, const std::exception_ptr& error) {
  const auto member = std::find_if(members_.begin(), members_.end(),
                                   [&](const Member& one) { return one.sul.get() == &sul; });
  MAIDE_CHECK(member != members_.end());
  const std::string name = member->name;
  earlier_incidents_.add(sul.incidents());
  members_.erase(member);
  last_error_ = error;
  if (!warn_ || members_.empty()) return;
  try {
    std::rethrow_exception(error);
  } catch (const std::exception& reason) {
    warn_(name + " is given up, its words are asked elsewhere: " + reason.what());
  }
}

void SulPool::run(std::span<const SulQuery> batch, const SulAnswerSink& sink,
                  const RunControl& control) {
  std::vector<bool> is_answered(batch.size(), false);
  const SulAnswerSink checked_sink = [&](std::size_t index, SulAnswer answer) {
    MAIDE_CHECK(!is_answered[index]);  // none is handed on twice, whoever failed
    is_answered[index] = true;
    sink(index, std::move(answer));
  };
  // Again only if all systems that took part failed, and there are others.
  while (true) {
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if (!is_answered[i]) open.push_back(i);
    }
    if (open.empty()) return;
    if (members_.empty()) std::rethrow_exception(last_error_);
    run_once(batch, open, checked_sink, control);
  }
}

void SulPool::run_once(std::span<const SulQuery> batch, std::span<const std::size_t> open,
                       const SulAnswerSink& sink, const RunControl& control) {
  const std::size_t workers = std::min(members_.size(), open.size());
  MAIDE_CHECK(workers > 0);
  Batch shared(batch, open, control, workers);
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < workers; ++i) {
      threads.emplace_back([&shared, sul = members_[i].sul.get()] { shared.work(*sul); });
    }
    for (auto news = shared.wait(); !news.empty(); news = shared.wait()) {
      try {
        for (Batch::Answered& one : news) sink(one.index, std::move(one.answer));
      } catch (...) {
        shared.stop(std::current_exception());
      }
    }
  }
  for (const auto& [sul, error] : shared.failed()) give_up(*sul, error);
  if (shared.error()) std::rethrow_exception(shared.error());
  control.check("running words on the system");
}

}  // namespace maide
