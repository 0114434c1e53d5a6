#include "maide/check/search/checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/hash.hpp"
#include "maide/base/invariant.hpp"
#include "maide/base/json.hpp"
#include "maide/base/version.hpp"

namespace maide {
namespace {

UsageError damaged(const std::string& file) {
  return UsageError(
      fmt::format("the checkpoint is damaged; remove its folder to begin anew ({})", file));
}

}  // namespace

Checkpoint::Checkpoint(std::filesystem::path folder, std::uint64_t key, double interval)
    : folder_(std::move(folder)), key_(key), interval_(interval) {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) {
    throw UsageError(fmt::format("cannot make the folder for checkpoints: {} ({})", error.message(),
                                 folder_.string()));
  }
  check_can_write(manifest());
}

std::filesystem::path Checkpoint::manifest() const {
  return folder_ / fmt::format("{:016x}.json", key_);
}
std::filesystem::path Checkpoint::part_file(std::uint64_t number, unsigned part) const {
  return folder_ / fmt::format("{:016x}-{}-{}.states", key_, number, part);
}

std::optional<SearchProgress> Checkpoint::find() const {
  const std::string file = manifest().string();
  std::error_code error;
  if (!std::filesystem::exists(file, error) && !error) return std::nullopt;
  try {
    Json json = parse_json(read_file(file), file);
    const std::string writer = json.at("maide").get<std::string>();
    if (writer != version()) {
      throw UsageError(fmt::format("the checkpoint was written by maide {} ({})", writer, file));
    }
    const auto sum = json.at("sum").get<std::uint64_t>();
    json.erase("sum");
    if (sum != hash_text(to_json_line(json))) throw damaged(file);
    SearchProgress progress;
    progress.number = json.at("number").get<std::uint64_t>();
    progress.parts = json.at("parts").get<unsigned>();
    progress.depth = json.at("depth").get<std::uint64_t>();
    progress.states = json.at("states").get<std::uint64_t>();
    progress.next = json.at("next").get<std::uint64_t>();
    progress.transitions = json.at("transitions").get<std::uint64_t>();
    progress.has_cut = json.at("has_cut").get<bool>();
    progress.is_done = json.at("is_done").get<bool>();
    return progress;
  } catch (const Json::exception&) {
    throw damaged(file);
  } catch (const ParseError&) {
    throw damaged(file);
  }
}

void Checkpoint::remove_leftovers(const std::optional<SearchProgress>& last) const {
  const std::string own = fmt::format("{:016x}", key_);
  const std::string kept = last ? fmt::format("{}-{}-", own, last->number) : "";
  std::error_code error;
  for (auto entry = std::filesystem::directory_iterator(folder_, error);
       !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (!name.starts_with(own) || entry->path() == manifest()) continue;
    if (last && name.starts_with(kept) && name.ends_with(".states")) continue;
    std::error_code ignored;  // it costs room alone
    std::filesystem::remove(entry->path(), ignored);
  }
}

void Checkpoint::check_total(const SearchProgress& last, std::uint64_t states,
                             std::uint64_t next) const {
  if (states != last.states || next != last.next) throw damaged(manifest().string());
}

void Checkpoint::Writer::put(std::uint64_t value) {
  sum_ = hash_mix(sum_, value);
  out_.write(reinterpret_cast<const char*>(&value), sizeof value);
}

std::uint64_t Checkpoint::Reader::get() {
  std::uint64_t value = 0;
  if (!in_.read(reinterpret_cast<char*>(&value), sizeof value)) throw damaged(file_);
  sum_ = hash_mix(sum_, value);
  return value;
}

bool Checkpoint::is_due() const {
  if (interval_ == 0) return true;
  const std::chrono::duration<double> passed = Clock::now() - last_;
  return passed.count() >= std::max(interval_, 20 * took_);
}

void Checkpoint::start_interval() {
  last_ = Clock::now();
  took_ = began_ == Clock::time_point{} ? 0 : std::chrono::duration<double>(last_ - began_).count();
}

void Checkpoint::write_part(std::uint64_t number, unsigned part,
                            const std::function<void(Writer& writer)>& write) {
  began_ = Clock::now();
  write_file_atomically(part_file(number, part), [&](std::ostream& out) {
    Writer writer(out);
    write(writer);
    writer.put(writer.sum());
  });
}

void Checkpoint::write_manifest(const SearchProgress& progress) const {
  Json json{{"maide", version()},
            {"number", progress.number},
            {"parts", progress.parts},
            {"depth", progress.depth},
            {"states", progress.states},
            {"next", progress.next},
            {"transitions", progress.transitions},
            {"has_cut", progress.has_cut},
            {"is_done", progress.is_done}};
  json["sum"] = hash_text(to_json_line(json));
  write_file_atomically(manifest(), to_json_line(json) + "\n");
}

void Checkpoint::remove_part(std::uint64_t number, unsigned part) const {
  std::error_code error;  // what is left behind costs room alone
  std::filesystem::remove(part_file(number, part), error);
}

void Checkpoint::read_part(std::uint64_t number, unsigned part,
                           const std::function<void(Reader& reader)>& read) const {
  const std::string file = part_file(number, part).string();
  std::ifstream in(file, std::ios::binary);
  if (!in) throw damaged(file);
  // Nothing of it is used before all of it is known to be right.
  std::error_code error;
  const std::uint64_t size = std::filesystem::file_size(file, error);
  if (error || size < sizeof(std::uint64_t) || size % sizeof(std::uint64_t) != 0) {
    throw damaged(file);
  }
  Reader check(in, file);
  for (std::uint64_t left = size / sizeof(std::uint64_t) - 1; left > 0; --left) check.get();
  const std::uint64_t sum = check.sum();
  if (check.get() != sum) throw damaged(file);
  in.seekg(0);
  Reader reader(in, file);
  read(reader);
}

Ranks::Bytes encode(const std::optional<SearchProgress>& progress) {
  if (!progress) return {};
  Ranks::Bytes bytes(sizeof *progress);
  std::memcpy(bytes.data(), &*progress, sizeof *progress);
  return bytes;
}

std::optional<SearchProgress> decode_progress(const Ranks::Bytes& bytes) {
  if (bytes.empty()) return std::nullopt;
  SearchProgress progress;
  MAIDE_CHECK_ALWAYS(bytes.size() == sizeof progress);
  std::memcpy(&progress, bytes.data(), sizeof progress);
  return progress;
}

}  // namespace maide
