#include "maide/report/sarif.hpp"

#include <fmt/format.h>

#include <cctype>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "maide/base/version.hpp"
#include "maide/check/rules/model_words.hpp"
#include "maide/check/system/steps.hpp"
#include "maide/report/explanation.hpp"

namespace maide {
namespace {

// A path as a URI: absolute ones begin with `file://`; what may not stand in one is escaped.
std::string uri_of(const std::string& path) {
  static constexpr std::string_view plain = "-._~/";
  std::string uri = path.starts_with('/') ? "file://" : "";
  for (const char character : path) {
    const auto byte = static_cast<unsigned char>(character);
    const bool is_letter = byte < 0x80 && std::isalnum(byte) != 0;
    const bool is_plain = is_letter || plain.find(character) != std::string_view::npos;
    uri += is_plain ? std::string(1, character) : fmt::format("%{:02X}", byte);
  }
  return uri;
}

class SarifMaker {
 public:
  SarifMaker(const System& system, const CheckReport& report, const std::string& file)
      : system_(system), report_(report), file_(file) {}

  Json make(std::span<const SarifNote> notes) const {
    Json rules = Json::array(), results = Json::array();
    for (const PropertyResult& result : report_.properties) {
      rules.push_back({{"id", result.name}});
      if (result.verdict != Verdict::holds) results.push_back(result_of(result));
    }
    if (!notes.empty()) rules.push_back({{"id", "hole"}});
    for (const SarifNote& note : notes) {
      results.push_back(make_result("hole", "warning", note.text, note.place));
    }
    const Json driver{{"name", "Maide"}, {"version", version()}, {"rules", std::move(rules)}};
    const Json run{{"tool", {{"driver", driver}}}, {"results", std::move(results)}};
    return {{"$schema", "https://json.schemastore.org/sarif-2.1.0.json"},
            {"version", "2.1.0"},
            {"runs", Json::array({run})}};
  }

 private:
  // Where the step stands in a file that there is; line 0: nowhere.
  SourcePosition place_of_step(const System& part, const Step& step) const {
    if (const auto origin = origin_of(part, step)) return *origin;
    SourcePosition place = place_of(part, step);
    if (place.file == system_.file && file_ != system_.file) place.line = 0;
    return place;
  }

  static Json physical(const SourcePosition& place) {
    Json found{{"artifactLocation", {{"uri", uri_of(place.file)}}}};
    if (place.line > 0) found["region"] = {{"startLine", place.line}};
    return found;
  }

  static Json make_result(const std::string& rule, const char* level, const std::string& text,
                          const SourcePosition& place) {
    const Json location{{"physicalLocation", physical(place)}};
    return {{"ruleId", rule},
            {"level", level},
            {"message", {{"text", text}}},
            {"locations", Json::array({location})}};
  }

  Json result_of(const PropertyResult& result) const {
    const SourcePosition whole{file_, 0, 0};
    if (result.verdict == Verdict::inconclusive) {
      const std::string why = result.reason.empty() ? "" : ": " + result.reason;
      return make_result(result.name, "warning", "inconclusive" + why, whole);
    }
    if (!result.trace) {
      const std::string& text = result.is_possibility ? result.reason : "violated";
      return make_result(result.name, "error", text, whole);
    }
    const Shown shown = shown_part(system_, result);
    const System& part = shown.part.system();
    const PropertyResult* const same = find_same_run(report_, result);
    const std::string sentence = same != nullptr
                                     ? explain_again(part, shown.property, shown.trace, *same)
                                     : explain(part, shown.property, shown.trace);
    SourcePosition last = whole;
    Json steps = Json::array();
    for (const Step& step : shown.trace.steps) {
      const SourcePosition place = place_of_step(part, step);
      if (place.line > 0) last = place;
      steps.push_back(Json{{"location", location_of(part, step, place)}});
    }
    Json found = make_result(result.name, "error", sentence + ".", last);
    const Json flow{{"locations", std::move(steps)}};
    const Json flows{{"threadFlows", Json::array({flow})}};
    found["codeFlows"] = Json::array({flows});
    return found;
  }

  static Json location_of(const System& part, const Step& step, const SourcePosition& place) {
    const StepText text = describe_step(part, step);
    const std::string who = text.actor.empty() ? "" : text.actor + ": ";
    Json location{{"message", {{"text", who + describe_action(part, step)}}}};
    if (place.line > 0) location["physicalLocation"] = physical(place);
    return location;
  }

  const System& system_;
  const CheckReport& report_;
  const std::string& file_;
};

}  // namespace

Json make_sarif(const System& system, const CheckReport& report, const std::string& file,
                std::span<const SarifNote> notes) {
  return SarifMaker(system, report, file).make(notes);
}

}  // namespace maide
