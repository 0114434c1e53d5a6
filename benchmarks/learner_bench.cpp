#include "learner_bench.hpp"

#include <algorithm>
#include <atomic>
#include <ctime>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>
#include <utility>

#include "maide/automata/compare.hpp"
#include "maide/automata/minimize.hpp"
#include "maide/base/error.hpp"
#include "maide/base/thread_team.hpp"
#include "maide/conformance/method/known_words.hpp"
#include "maide/conformance/method/test_chain.hpp"
#include "maide/experiment/known_models.hpp"
#include "maide/experiment/pacing.hpp"
#include "maide/learn/cache/cache.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"
#include "maide/learn/oracle/observing_oracle.hpp"

namespace maide {
namespace {

namespace fs = std::filesystem;

bool is_model_file(const fs::path& path) {
  return path.extension() == ".dot" || path.extension() == ".gv" || path.extension() == ".aut";
}

Mealy read_minimal_machine(const fs::path& path) {
  const Mealy machine = read_machine(path, Translation::eager);
  if (machine.inputs().empty()) {
    throw UsageError("the model has no inputs (" + path.string() + ")");
  }
  return minimize(machine);
}

std::vector<fs::path> find_model_files(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code failure, ignored;
  for (fs::directory_iterator entry(folder, failure), end; !failure && entry != end;
       entry.increment(failure)) {
    if (is_model_file(entry->path()) && entry->is_regular_file(ignored)) {
      files.push_back(entry->path());
    }
  }
  if (failure) {
    throw UsageError("cannot read the folder: " + failure.message() + " (" + folder.string() + ")");
  }
  return files;
}

double thread_cpu_seconds() {
  std::timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

// Counts what is asked; the phases are those of the counter below the cache.
class Asked : public CountingOracle {
 public:
  Asked(OutputOracle& system, const CountingOracle& sent) : CountingOracle(system), sent_(sent) {}

  using OutputOracle::ask;
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl& control = {},
                               const PartialSink& on_early_end = {}) override {
    set_phase(sent_.phase());
    return CountingOracle::ask(batch, control, on_early_end);
  }

 private:
  const CountingOracle& sent_;
};

// One learner on one machine.
class Measurement {
 public:
  Measurement(const BenchModel& model, const LearnerEntry& algorithm, const TestChain& method,
              const BenchOptions& options, const RunControl& control)
      : machine_(model.machine),
        system_(machine_),
        sent_(system_),
        portioned_(sent_, pace(options)),
        cache_(portioned_),
        asked_(options.use_cache ? static_cast<OutputOracle&>(cache_) : portioned_, sent_),
        tests_(make_tests(model, algorithm, method, options, control)),
        teacher_(*tests_, sent_),
        learner_(make_learner(algorithm, asked_, old_version(model), control)) {}

  void run(BenchRun& result, const RunControl& control) {
    try {
      run_learner(*learner_, teacher_, control, [&result](const Mealy&, std::uint64_t round) {
        result.equivalence_queries = round;
      });
      result.cpu_seconds = thread_cpu_seconds() - start_;
      result.outcome = is_right() ? BenchOutcome::right : BenchOutcome::wrong;
    } catch (const Error& error) {
      result.error = error.what();
    } catch (const std::bad_alloc&) {
      result.error = "out of memory";
    }
    if (result.outcome == BenchOutcome::unfinished) {
      result.cpu_seconds = thread_cpu_seconds() - start_;
    }
    result.states = learner_->hypothesis().size();
    result.asked = asked_.statistics();
    result.sent = sent_.statistics();
    result.cache_edges = cache_.observation_count();
    result.cache_bytes = cache_.bytes();
  }

 private:
  static const Mealy* old_version(const BenchModel& model) {
    return model.old_version ? &*model.old_version : nullptr;
  }
  std::unique_ptr<EquivalenceOracle> make_tests(const BenchModel& model,
                                                const LearnerEntry& algorithm,
                                                const TestChain& method,
                                                const BenchOptions& options,
                                                const RunControl& control) {
    auto tests =
        method.make({asked_, options.use_cache ? &cache_ : nullptr, &machine_}, options.testing);
    auto words = first_words(algorithm, old_version(model), machine_.inputs(), control);
    if (words.empty()) return tests;
    std::vector<std::unique_ptr<EquivalenceOracle>> links;
    links.push_back(std::make_unique<KnownWords>(asked_, std::move(words)));
    links.push_back(std::move(tests));
    return std::make_unique<ChainOracle>(std::move(links));
  }
  static PaceOptions pace(const BenchOptions& options) {
    PaceOptions pace;
    if (options.max_experiments != 0) pace.max_queries = options.max_experiments;
    return pace;
  }
  bool is_right() const {
    return learner_->hypothesis().size() == machine_.size() &&
           !find_difference(learner_->hypothesis(), machine_);
  }

  const double start_ = thread_cpu_seconds();
  const Mealy& machine_;
  MealyOracle system_;
  CountingOracle sent_;
  PortioningOracle portioned_;
  Cache cache_;
  Asked asked_;
  std::unique_ptr<EquivalenceOracle> tests_;
  PhasedTeacher teacher_;
  std::unique_ptr<Learner> learner_;
};

// The runs, dealt to threads and handed over in their order.
class Bench {
 public:
  Bench(const std::vector<BenchModel>& models, const BenchOptions& options,
        const std::function<void(const BenchRun&)>& on_run, const RunControl& control)
      : models_(models),
        options_(options),
        on_run_(on_run),
        control_(control),
        method_(options.test_method),
        algorithms_(bench_learners(options)) {
    // What cannot work is found before threads are started.
    if (!models.empty()) {
      Measurement({"", models.front().machine}, *algorithms_.front(), method_, options, control);
    }
    runs_.resize(models.size() * algorithms_.size());
  }

  bool run() {
    const std::size_t wanted = options_.jobs != 0 ? options_.jobs : processor_count();
    {
      std::vector<std::jthread> threads;
      for (std::size_t job = 1; job < std::min(wanted, runs_.size()); ++job) {
        threads.emplace_back([this] { work(); });
      }
      work();
    }
    if (failure_) std::rethrow_exception(failure_);
    bool is_complete = true;
    for (; delivered_ < runs_.size(); ++delivered_) {
      is_complete = is_complete && runs_[delivered_];
      if (runs_[delivered_]) on_run_(*runs_[delivered_]);
    }
    return is_complete;
  }

 private:
  void work() {
    try {
      while (!control_.should_stop() && !is_failed_) {
        const std::size_t index = next_++;
        if (index >= runs_.size()) return;
        BenchRun run = measure(index);
        if (run.outcome == BenchOutcome::unfinished && control_.should_stop()) return;
        deliver(index, std::move(run));
      }
    } catch (...) {  // for example whoever listens cannot go on, because the disk is full
      const std::lock_guard lock(mutex_);
      failure_ = std::current_exception();
      is_failed_ = true;
    }
  }

  BenchRun measure(std::size_t index) const {
    BenchRun run;
    run.model = index / algorithms_.size();
    const LearnerEntry& algorithm = *algorithms_[index % algorithms_.size()];
    run.algorithm = algorithm.name;
    RunControl limited;
    limited.stop = control_.stop;
    if (options_.seconds) limited.deadline = deadline_in(*options_.seconds);
    try {
      Measurement(models_[run.model], algorithm, method_, options_, limited).run(run, limited);
    } catch (const Error& error) {  // a learner or a method that cannot begin on this machine
      run.outcome = BenchOutcome::unfinished;
      run.error = error.what();
    }
    return run;
  }

  void deliver(std::size_t index, BenchRun run) {
    const std::lock_guard lock(mutex_);
    runs_[index] = std::move(run);
    Progress progress;
    progress.phase = "measuring";
    progress.done = ++done_;
    progress.total = runs_.size();
    control_.report(progress);
    for (; delivered_ < runs_.size() && runs_[delivered_] && !is_failed_; ++delivered_) {
      on_run_(*runs_[delivered_]);
    }
  }

  const std::vector<BenchModel>& models_;
  const BenchOptions& options_;
  const std::function<void(const BenchRun&)>& on_run_;
  const RunControl& control_;
  TestChain method_;
  std::vector<const LearnerEntry*> algorithms_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> is_failed_{false};
  std::mutex mutex_;  // guards what follows
  std::vector<std::optional<BenchRun>> runs_;
  std::size_t done_ = 0, delivered_ = 0;
  std::exception_ptr failure_;
};

}  // namespace

std::string_view to_string(BenchOutcome outcome) {
  switch (outcome) {
    case BenchOutcome::right: return "right";
    case BenchOutcome::wrong: return "wrong";
    case BenchOutcome::unfinished: break;
  }
  return "unfinished";
}

BenchFolder read_bench_folder(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) {
    throw UsageError("there is no such folder (" + folder.string() + ")");
  }
  std::vector<fs::path> files = find_model_files(folder);
  if (files.empty()) throw UsageError("no model files are there (" + folder.string() + ")");
  std::sort(files.begin(), files.end(), [](const fs::path& left, const fs::path& right) {
    return std::pair(left.stem(), left) < std::pair(right.stem(), right);
  });
  std::map<fs::path, int> stems;
  for (const fs::path& file : files) ++stems[file.stem()];
  BenchFolder result;
  for (const fs::path& file : files) {
    const fs::path name = stems[file.stem()] == 1 ? file.stem() : file.filename();
    try {
      result.models.push_back({name.string(), read_minimal_machine(file)});
    } catch (const Error& error) {
      result.unreadable.emplace_back(error.what());
    }
  }
  return result;
}

void add_old_versions(BenchFolder& folder, const fs::path& old_versions) {
  BenchFolder old = read_bench_folder(old_versions);
  folder.unreadable.insert(folder.unreadable.end(), old.unreadable.begin(), old.unreadable.end());
  bool is_any = false;
  for (BenchModel& model : folder.models) {
    const auto version = std::find_if(old.models.begin(), old.models.end(),
                                      [&](const auto& other) { return other.name == model.name; });
    if (version == old.models.end()) continue;
    is_any = true;
    if (shares_inputs(version->machine, model.machine.inputs())) {
      model.old_version = std::move(version->machine);
    } else {
      folder.unreadable.push_back("the earlier version of " + model.name +
                                  " has none of its inputs (" + old_versions.string() + ")");
    }
  }
  if (!is_any) {
    throw UsageError("no model has the name of one to be learned (" + old_versions.string() + ")");
  }
}

std::vector<const LearnerEntry*> bench_learners(const BenchOptions& options) {
  std::vector<const LearnerEntry*> algorithms;
  for (const std::string& name : options.algorithms) {
    const LearnerEntry* const entry = &find_deterministic_learner(name);
    if (std::find(algorithms.begin(), algorithms.end(), entry) == algorithms.end()) {
      algorithms.push_back(entry);
    }
  }
  if (!options.algorithms.empty()) return algorithms;
  for (const LearnerEntry& entry : deterministic_learners()) algorithms.push_back(&entry);
  return algorithms;
}

bool run_bench(const std::vector<BenchModel>& models, const BenchOptions& options,
               const std::function<void(const BenchRun&)>& on_run, const RunControl& control) {
  return Bench(models, options, on_run, control).run();
}

}  // namespace maide
