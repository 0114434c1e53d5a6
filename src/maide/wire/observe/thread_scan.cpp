#include "maide/wire/observe/thread_scan.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <linux/futex.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/wire/observe/socket_scan.hpp"

namespace maide {
namespace {

// The call's arguments, "0x1a 0x0 ...", as far as they are there.
std::array<std::uint64_t, 4> parse_arguments(std::string_view text) {
  std::array<std::uint64_t, 4> arguments{};
  for (std::uint64_t& argument : arguments) {
    const std::size_t start = text.find("0x");
    if (start == std::string_view::npos) break;
    text.remove_prefix(start + 2);
    std::from_chars(text.data(), text.data() + text.size(), argument, 16);
  }
  return arguments;
}

// By which clock a futex operation's limit counts, if it is a point in time.
std::optional<clockid_t> clock_of(std::uint64_t operation) {
  const bool is_real = (operation & FUTEX_CLOCK_REALTIME) != 0;
  switch (operation & FUTEX_CMD_MASK) {
    case FUTEX_LOCK_PI: return CLOCK_REALTIME;
    case FUTEX_WAIT_BITSET:
    case FUTEX_WAIT_REQUEUE_PI:
    case FUTEX_LOCK_PI2: return is_real ? CLOCK_REALTIME : CLOCK_MONOTONIC;
    default: return std::nullopt;
  }
}

// The kernel reads it for us: the thread may be gone by now, and its stack with it.
std::optional<timespec> read_time(pid_t thread, std::uint64_t address) {
  timespec time{};
  const iovec here{&time, sizeof time};
  // NOLINTNEXTLINE(performance-no-int-to-ptr): the other process's address
  const iovec there{reinterpret_cast<void*>(address), sizeof time};
  const ssize_t size = ::process_vm_readv(thread, &here, 1, &there, 1, 0);
  if (size != static_cast<ssize_t>(sizeof time)) return std::nullopt;
  return time;
}

}  // namespace

// futex(address, operation, value, limit, ...)
std::optional<BlockedCall::Limit> BlockedCall::read_limit(std::string_view arguments,
                                                          pid_t thread) {
  const auto [address, operation, value, limit] = parse_arguments(arguments);
  const std::optional<clockid_t> clock = clock_of(operation);
  if (limit == 0 || !clock) return std::nullopt;
  const std::optional<timespec> time = read_time(thread, limit);
  if (!time) return std::nullopt;
  return Limit{*clock, *time};
}

BlockedCall BlockedCall::parse(std::string_view text, pid_t thread) {
  long number = -1;
  if (text.empty() || text.front() == 'r') return BlockedCall(Kind::running);
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (number == SYS_nanosleep || number == SYS_clock_nanosleep) {
    return BlockedCall(Kind::timed_sleep);
  }
  BlockedCall call(Kind::waiting);
  if (number == SYS_futex) {
    text.remove_prefix(static_cast<std::size_t>(rest - text.data()));
    call.limit_ = read_limit(text, thread);
  }
  return call;
}

bool BlockedCall::is_overdue() const {
  if (!limit_) return false;
  timespec now{};
  ::clock_gettime(limit_->clock, &now);
  const timespec& time = limit_->time;
  return std::pair(time.tv_sec, time.tv_nsec) <= std::pair(now.tv_sec, now.tv_nsec);
}

namespace {

pid_t this_thread_id() { return static_cast<pid_t>(::syscall(SYS_gettid)); }

// The process's set of threads that are not the system's.
struct ExcludedThreads {
  std::mutex mutex;
  std::vector<pid_t> threads;
  pid_t process = 0;             // whose threads these are
  std::uint64_t generation = 0;  // another one with each change
};

#if defined(__SANITIZE_THREAD__)
// The thread sanitizer has a thread of its own that polls; it starts with the first other thread.
std::vector<pid_t> find_runtime_threads() {
  std::thread([] {}).join();
  std::vector<pid_t> threads;
  DIR* directory = ::opendir("/proc/self/task");
  while (const dirent* entry = ::readdir(directory)) {
    const pid_t thread = std::atoi(entry->d_name);
    if (thread > 0 && thread != ::getpid()) threads.push_back(thread);
  }
  ::closedir(directory);
  return threads;
}
#else
std::vector<pid_t> find_runtime_threads() { return {}; }
#endif

// Lives until the process ends: threads may outlast static destructors.
ExcludedThreads& excluded() {
  static auto* set = new ExcludedThreads;
  return *set;
}

void add_excluded(pid_t thread) {
  ExcludedThreads& set = excluded();
  const std::scoped_lock lock(set.mutex);
  // The runtime's threads are found once in a process, before the system has any: first before
  // main, and after a fork with the SDK's first thread.
  if (set.process != ::getpid()) {
    set.threads = find_runtime_threads();
    set.process = ::getpid();
  }
  ++set.generation;
  if (thread > 0) set.threads.push_back(thread);
}

[[maybe_unused]] const bool initialised_early = (add_excluded(0), true);

using Buffer = std::array<char, 512>;

// The text of a file of /proc, read anew; empty if its thread is gone.
std::string_view read_text(int descriptor, Buffer& buffer) {
  const ssize_t size = ::pread(descriptor, buffer.data(), buffer.size(), 0);
  return size > 0 ? std::string_view(buffer.data(), static_cast<std::size_t>(size))
                  : std::string_view();
}

Descriptor open_file(const std::string& path) {
  return Descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
}

// Thread numbers are unique among all processes, and a thread's folder is there under its own.
std::string folder_of(pid_t thread) {
  const std::string number = std::to_string(thread);
  return "/proc/" + number + "/task/" + number;
}

// The last of the three numbers of schedstat: how often the thread was put on a CPU; -1 if gone.
std::int64_t parse_run_count(std::string_view text) {
  const std::size_t last = text.find_last_of(' ');
  std::int64_t count = -1;
  if (last == std::string_view::npos) return -1;
  std::from_chars(text.data() + last + 1, text.data() + text.size(), count);
  return count;
}

// The letter behind the command's name in parentheses (which may hold anything).
char parse_state(std::string_view text) {
  const std::size_t paren = text.rfind(')');
  return paren == std::string_view::npos || paren + 2 >= text.size() ? '?' : text[paren + 2];
}

}  // namespace

SdkThread::SdkThread() : thread_(this_thread_id()) { add_excluded(thread_); }

SdkThread::~SdkThread() {
  const std::scoped_lock lock(excluded().mutex);
  auto& threads = excluded().threads;
  const auto found = std::ranges::find(threads, thread_);
  if (found != threads.end()) threads.erase(found);
  ++excluded().generation;
}

// A thread of the system.
struct ThreadScan::Entry {
  Entry(pid_t id, const std::string& folder)
      : thread(id),
        schedstat(open_file(folder + "/schedstat")),
        syscall(open_file(folder + "/syscall")),
        stat(open_file(folder + "/stat")) {}
  pid_t thread;
  Descriptor schedstat, syscall, stat;
  SdkDescriptor own_schedstat{schedstat.get()}, own_syscall{syscall.get()}, own_stat{stat.get()};
  std::int64_t runs = -1;  // read before `call`; -1: nothing is known of it
  BlockedCall call;        // in which it slept when it had run so often
  int quiet_looks = 0;     // how many have found it so in a row
  bool is_gone = false;
};

// The folder that lists its threads, kept open.
struct ThreadScan::Process {
  explicit Process(const std::string& folder) : directory(::opendir(folder.c_str())) {
    if (directory != nullptr) own.emplace(::dirfd(directory));
  }
  ~Process() {
    own.reset();
    if (directory != nullptr) ::closedir(directory);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  // A folder of /proc has a link for itself, one for its entry, and one for each thread.
  bool has_threads(std::size_t count) const {
    struct stat status {};
    return directory != nullptr && ::fstat(::dirfd(directory), &status) == 0 &&
           status.st_nlink == count + 2;
  }

  DIR* directory;
  std::optional<SdkDescriptor> own;
  std::size_t listed = 0;  // threads, those that are left out too
};

ThreadScan::ThreadScan() {
  processes_.push_back(std::make_unique<Process>("/proc/self/task"));
  Buffer buffer;
  const Entry self(this_thread_id(), folder_of(this_thread_id()));
  shows_syscall_ = !read_text(self.syscall.get(), buffer).empty();
  if (processes_.front()->directory == nullptr ||
      parse_run_count(read_text(self.schedstat.get(), buffer)) < 0) {
    throw UsageError(
        "this kernel does not show when threads run (/proc/self/task/*/schedstat); "
        "give a fixed delay, quiescence=<ms>");
  }
  counts_threads_ = counts_threads();
}

ThreadScan::~ThreadScan() = default;

void ThreadScan::watch_process(pid_t process) {
  processes_.push_back(std::make_unique<Process>("/proc/" + std::to_string(process) + "/task"));
  is_list_known_ = false;
}

// Does this kernel tell by its links how many threads a folder lists? (Threads may come and go
// while it is asked.)
bool ThreadScan::counts_threads() {
  for (int attempt = 0; attempt < 20; ++attempt) {
    if (list_threads(threads_) && has_listed_threads()) return true;
  }
  return false;
}

// False if a process is gone.
bool ThreadScan::list_threads(std::vector<pid_t>& threads) {
  threads.clear();
  bool all_there = true;
  for (const auto& process : processes_) {
    if (process->directory == nullptr) return false;
    const std::size_t before = threads.size();
    ::rewinddir(process->directory);
    while (const dirent* entry = ::readdir(process->directory)) {
      const pid_t thread = std::atoi(entry->d_name);
      if (thread > 0) threads.push_back(thread);
    }
    process->listed = threads.size() - before;
    all_there = all_there && process->listed > 0;
  }
  scanning_thread_ = std::this_thread::get_id();
  std::erase(threads, this_thread_id());
  const std::scoped_lock lock(excluded().mutex);
  own_threads_ = excluded().generation;
  std::erase_if(threads, [](pid_t thread) {
    const auto& own = excluded().threads;
    return std::ranges::find(own, thread) != own.end();
  });
  return all_there;
}

// There are as many threads as were listed: those, if they are all alive afterwards.
bool ThreadScan::has_listed_threads() const {
  for (const auto& process : processes_) {
    if (!process->has_threads(process->listed)) return false;
  }
  // Asked last: an SDK thread that ended before they were counted is noticed here.
  const std::scoped_lock lock(excluded().mutex);
  return own_threads_ == excluded().generation;
}

// Has entries_ be those of all threads; false if a process is gone.
bool ThreadScan::know_threads() {
  if (counts_threads_ && is_list_known_ && scanning_thread_ == std::this_thread::get_id()) {
    return true;
  }
  is_list_known_ = list_threads(threads_);
  if (!is_list_known_) return false;
  std::erase_if(entries_, [this](const auto& entry) {
    return std::ranges::find(threads_, entry->thread) == threads_.end();
  });
  for (const pid_t thread : threads_) {
    const bool is_known = std::ranges::any_of(
        entries_, [thread](const auto& entry) { return entry->thread == thread; });
    if (!is_known) entries_.push_back(std::make_unique<Entry>(thread, folder_of(thread)));
  }
  return true;
}

// Does it sleep, as far as the first pass can tell? Of a thread that has long slept only what is
// remembered is asked: whether it has run since or is about to, the second pass sees.
bool ThreadScan::is_asleep(Entry& entry, bool timed_sleep_is_rest) const {
  constexpr int long_sleep = 16;
  Buffer buffer;
  const auto goes_on_by_itself = [&] {
    return entry.call.is_overdue() ||
           (entry.call.kind() == BlockedCall::Kind::timed_sleep && !timed_sleep_is_rest);
  };
  const bool is_remembered = shows_syscall_ && entry.runs >= 0;
  if (is_remembered && entry.quiet_looks >= long_sleep && !goes_on_by_itself()) return true;
  const std::int64_t runs = parse_run_count(read_text(entry.schedstat.get(), buffer));
  const bool is_known = runs >= 0 && runs == entry.runs;
  if (is_known || (runs >= 0 && !shows_syscall_)) {
    if (parse_state(read_text(entry.stat.get(), buffer)) != 'S') return false;
  }
  if (is_known) {
    ++entry.quiet_looks;
    return !goes_on_by_itself();
  }
  entry.runs = runs;
  entry.quiet_looks = 0;
  entry.is_gone = runs < 0;
  if (entry.is_gone) return false;
  if (!shows_syscall_) return true;
  entry.call = BlockedCall::parse(read_text(entry.syscall.get(), buffer), entry.thread);
  if (entry.call.kind() != BlockedCall::Kind::running) return !goes_on_by_itself();
  entry.runs = -1;
  return false;
}

bool ThreadScan::has_slept_on(Entry& entry) const {
  Buffer buffer;
  if (parse_state(read_text(entry.stat.get(), buffer)) == 'S' &&
      parse_run_count(read_text(entry.schedstat.get(), buffer)) == entry.runs) {
    return true;
  }
  entry.quiet_looks = 0;
  return false;
}

// A look in vain ends at the first thread that is awake, and the next one had best begin with it.
void ThreadScan::look_first_at(std::size_t place) {
  const auto found = entries_.begin() + static_cast<std::ptrdiff_t>(place);
  std::rotate(entries_.begin(), found, found + 1);
}

bool ThreadScan::begin(bool timed_sleep_is_rest) {
  if (!know_threads()) return false;
  for (std::size_t place = 0; place < entries_.size(); ++place) {
    Entry& entry = *entries_[place];
    if (is_asleep(entry, timed_sleep_is_rest)) continue;
    if (entry.is_gone) {
      // The number may have been given to another thread; the old one's files stay empty.
      entries_.erase(entries_.begin() + static_cast<std::ptrdiff_t>(place));
      is_list_known_ = false;
    } else {
      look_first_at(place);
    }
    return false;
  }
  if (counts_threads_ && !has_listed_threads()) is_list_known_ = false;
  return is_list_known_;
}

bool ThreadScan::end() {
  if (counts_threads_ && !has_listed_threads()) is_list_known_ = false;
  if (!is_list_known_) return false;
  for (std::size_t place = 0; place < entries_.size(); ++place) {
    if (has_slept_on(*entries_[place])) continue;
    look_first_at(place);
    return false;
  }
  return counts_threads_ || (list_threads(again_) && threads_ == again_);
}

}  // namespace maide
