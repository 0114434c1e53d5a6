#include "maide/wire/thread_scan.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "maide/base/descriptor.hpp"
#include "maide/base/error.hpp"
#include "maide/wire/blocked_call.hpp"

namespace maide {
namespace {

pid_t this_thread_id() { return static_cast<pid_t>(::syscall(SYS_gettid)); }

// The process's set of threads that are not the system's.
struct ExcludedThreads {
  std::mutex mutex;
  std::vector<pid_t> threads;
  pid_t process = 0;  // whose threads these are
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
  const auto found = std::find(threads.begin(), threads.end(), thread_);
  if (found != threads.end()) threads.erase(found);
}

struct ThreadScan::Entry {
  Entry(pid_t id, const std::string& folder)
      : thread(id),
        schedstat(open_file(folder + "/schedstat")),
        syscall(open_file(folder + "/syscall")),
        stat(open_file(folder + "/stat")) {}
  pid_t thread;
  Descriptor schedstat, syscall, stat;
  std::int64_t runs = -1;
};

// The folder that lists its threads, kept open.
struct ThreadScan::Process {
  explicit Process(const std::string& folder) : directory(::opendir(folder.c_str())) {}
  ~Process() {
    if (directory != nullptr) ::closedir(directory);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  DIR* directory;
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
}

ThreadScan::~ThreadScan() = default;

void ThreadScan::watch_process(pid_t process) {
  processes_.push_back(std::make_unique<Process>("/proc/" + std::to_string(process) + "/task"));
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
    all_there = all_there && threads.size() > before;
  }
  std::erase(threads, this_thread_id());
  const std::scoped_lock lock(excluded().mutex);
  std::erase_if(threads, [](pid_t thread) {
    const auto& own = excluded().threads;
    return std::find(own.begin(), own.end(), thread) != own.end();
  });
  return all_there;
}

ThreadScan::Entry* ThreadScan::find(pid_t thread) {
  for (const auto& entry : entries_) {
    if (entry->thread == thread) return entry.get();
  }
  return entries_.emplace_back(std::make_unique<Entry>(thread, folder_of(thread))).get();
}

bool ThreadScan::begin(bool timed_sleep_is_rest) {
  if (!list_threads(threads_)) return false;
  std::erase_if(entries_, [this](const auto& entry) {
    return std::find(threads_.begin(), threads_.end(), entry->thread) == threads_.end();
  });
  Buffer buffer;
  for (const pid_t thread : threads_) {
    Entry* entry = find(thread);
    entry->runs = parse_run_count(read_text(entry->schedstat.get(), buffer));
    if (entry->runs < 0) {
      // The number may have been given to another thread; the old one's files stay empty.
      std::erase_if(entries_, [&](const auto& known) { return known.get() == entry; });
      return false;
    }
    if (!shows_syscall_) {
      if (parse_state(read_text(entry->stat.get(), buffer)) != 'S') return false;
      continue;
    }
    const BlockedCall call = parse_blocked_call(read_text(entry->syscall.get(), buffer), thread);
    if (call == BlockedCall::running) return false;
    if (call == BlockedCall::timed_sleep && !timed_sleep_is_rest) return false;
  }
  return true;
}

bool ThreadScan::end() {
  Buffer buffer;
  for (const pid_t thread : threads_) {
    Entry* entry = find(thread);
    if (parse_state(read_text(entry->stat.get(), buffer)) != 'S') return false;
    if (parse_run_count(read_text(entry->schedstat.get(), buffer)) != entry->runs) return false;
  }
  return list_threads(again_) && threads_ == again_;
}

}  // namespace maide
