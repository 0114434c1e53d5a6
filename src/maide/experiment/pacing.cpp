#include "maide/experiment/pacing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/numbers.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/learn/oracle/sul_oracle.hpp"
#include "maide/sul/ia_translator.hpp"
#include "maide/sul/learning_purpose.hpp"

namespace maide {

std::vector<MealyAnswer> PortioningOracle::ask(std::span<const Query> batch,
                                               const RunControl& control,
                                               const PartialSink& on_early_end) {
  std::vector<MealyAnswer> answers;
  answers.reserve(batch.size());
  try {
    while (answers.size() < batch.size()) {
      const std::uint64_t left = options_.max_queries - answered_;
      if (left == 0) {
        throw Interrupted(
            fmt::format("stopped at the limit of {} experiments", options_.max_queries));
      }
      const std::size_t start = answers.size();
      const std::size_t size = std::min<std::uint64_t>(
          {std::uint64_t{batch.size() - start}, std::uint64_t{options_.portion}, left});
      std::vector<MealyAnswer> portion = system_.ask(
          batch.subspan(start, size), control, [&](std::size_t index, const MealyAnswer& answer) {
            if (on_early_end) on_early_end(start + index, answer);
          });
      answered_ += portion.size();
      std::move(portion.begin(), portion.end(), std::back_inserter(answers));
      if (options_.after_portion) options_.after_portion();
    }
  } catch (...) {
    for (std::size_t i = 0; on_early_end && i < answers.size(); ++i) on_early_end(i, answers[i]);
    throw;
  }
  return answers;
}

namespace {

constexpr int longer_ms = 10;

class OwningOracle : public OutputOracle {
 public:
  OwningOracle(std::unique_ptr<Sul> sul, Translation translation)
      : sul_(std::move(sul)), translator_(*sul_, translation), oracle_(translator_) {}

  using OutputOracle::ask;
  const Alphabet& inputs() const override { return oracle_.inputs(); }
  const Alphabet& outputs() const override { return oracle_.outputs(); }
  Symbol intern_output(std::string_view name) override { return oracle_.intern_output(name); }
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl& control,
                               const PartialSink& on_early_end) override {
    return oracle_.ask(batch, control, on_early_end);
  }

 private:
  std::unique_ptr<Sul> sul_;
  IaTranslator translator_;
  SulOracle oracle_;
};

}  // namespace

std::map<std::string, std::string> longer_waits(const std::map<std::string, std::string>& options) {
  const auto quiescence = options.find("quiescence");
  const auto floor = options.find("floor");
  if (quiescence == options.end()) return {};
  if (const auto delay = parse_number<int>(quiescence->second)) {
    return {{"quiescence", std::to_string(std::min(4 * *delay + longer_ms, 60'000))}};
  }
  if (floor == options.end()) return {};
  return {{"floor", std::to_string(parse_number<int>(floor->second).value_or(0) + longer_ms)}};
}

std::optional<SlowerSystem> make_slower_system(const SystemSpec& spec, const SystemAccess& access,
                                               const Sul& sul, const std::filesystem::path& purpose,
                                               const RunControl& control) {
  const auto waits = longer_waits(sul.info().options);
  const bool is_ours = spec.kind == SystemSpec::Kind::wrapper && access.accept.empty();
  if (waits.empty() || !is_ours) return std::nullopt;
  SystemSpec slower = spec;
  SystemAccess alone = access;
  alone.jobs = 1;
  SlowerSystem result;
  for (const auto& [key, value] : waits) {
    slower.options[key] = value;
    result.waits += (result.waits.empty() ? "" : " ") + key + "=" + value;
  }
  result.open = [=]() -> std::unique_ptr<OutputOracle> {
    OpenedSystem opened = open_system(slower, alone, control);
    if (!purpose.empty()) {
      opened.sul->add_purpose(LearningPurpose(read_interface_automaton(purpose)));
    }
    return std::make_unique<OwningOracle>(std::move(opened.sul),
                                          alone.translation.value_or(Translation::eager));
  };
  return result;
}

}  // namespace maide
